#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/world/probe/probe.h"
#include "world/plant/ode_arm.h"

namespace moma::probe {
namespace {

using nlohmann::json;

VectorX vector_of(const json& values) {
  VectorX out(static_cast<Eigen::Index>(values.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = values[static_cast<std::size_t>(i)].get<double>();
  return out;
}

std::vector<double> list_of(const VectorX& v) { return {v.data(), v.data() + v.size()}; }

/// The plant's own bodies, joints and settings, bolted to the world, without the plant's interface, which hands out
/// neither torques nor bodies.
class HeldArm {
 public:
  HeldArm(std::shared_ptr<const RobotModel> model, const VectorX& q)
      : model_(std::move(model)), arm_(world_.id(), model_, Vector3::Zero(), q, 0.0, 0.0, {}), q_(q) {
    if (model_->mobile()) throw std::invalid_argument("needs \"held\": true");
    dWorldSetGravity(world_.id(), 0.0, 0.0, -9.81);
    dWorldSetCFM(world_.id(), 1e-9);
    dWorldSetERP(world_.id(), 0.2);
    qdot_ = VectorX::Zero(q.size());
    joint_.assign(static_cast<std::size_t>(q.size()), nullptr);
    for (int b = 0; b < arm_.num_bodies(); ++b) {
      const dBodyID body = arm_.body(b);
      for (int j = 0; j < dBodyGetNumJoints(body); ++j) {
        const dJointID joint = dBodyGetJoint(body, j);
        if (dJointGetBody(joint, 0) == body) joint_[index(b)] = joint;
      }
    }
  }

  void hold(double h) {
    arm_.command(VectorX::Zero(q_.size()), h);
    step(h);
  }

  void push(const VectorX& torques, double h) {
    for (int b = 0; b < arm_.num_bodies(); ++b) {
      const double value = torques[static_cast<Eigen::Index>(index(b))];
      if (slides(b))
        dJointAddSliderForce(joint_[index(b)], value);
      else
        dJointAddHingeTorque(joint_[index(b)], value);
    }
    step(h);
  }

  /// What each joint passed on along its axis over the last step.
  VectorX efforts() const {
    VectorX out(q_.size());
    for (int b = 0; b < arm_.num_bodies(); ++b) {
      const dJointID joint = joint_[index(b)];
      const dJointFeedback& feedback = *dJointGetFeedback(joint);
      dVector3 axis, anchor;
      const Vector3 force = ode::from_vector(feedback.f1);
      double& effort = out[static_cast<Eigen::Index>(index(b))];
      if (slides(b)) {
        dJointGetSliderAxis(joint, axis);
        effort = force.dot(ode::from_vector(axis));
        continue;
      }
      dJointGetHingeAxis(joint, axis);
      dJointGetHingeAnchor(joint, anchor);
      const Vector3 lever = ode::from_vector(anchor) - ode::from_vector(dBodyGetPosition(arm_.body(b)));
      effort = (ode::from_vector(feedback.t1) - lever.cross(force)).dot(ode::from_vector(axis));
    }
    return out;
  }

  const VectorX& q() const { return q_; }

 private:
  std::size_t index(int body) const {
    return static_cast<std::size_t>(arm_.rigid().bodies[static_cast<std::size_t>(body)].joint);
  }
  bool slides(int body) const { return model_->joints[index(body)].type == JointType::kPrismatic; }
  void step(double h) {
    if (dWorldStep(world_.id(), h) == 0) throw std::runtime_error("ODE's step gave up");
    arm_.read(q_, qdot_);
  }

  std::shared_ptr<const RobotModel> model_;
  ode::World world_;
  OdeArm arm_;
  VectorX q_, qdot_;
  std::vector<dJointID> joint_;  // by controlled joint
};

}  // namespace

json gravity(const json& request) {
  const auto model = robot_of(request);
  json out = {{"q", json::array()}, {"torques", json::array()}};
  for (const json& configuration : request.at("configurations")) {
    HeldArm arm(model, vector_of(configuration));
    // The joints give by their softness (CFM 1e-9) and settle by a factor of 0.8 a step (ERP 0.2).
    for (int i = 0; i < 80; ++i) arm.hold(0.002);
    out["q"].push_back(list_of(arm.q()));
    out["torques"].push_back(list_of(arm.efforts()));
  }
  return out;
}

json torque(const json& request) {
  auto model = std::make_shared<RobotModel>(*robot_of(request));
  for (ControlledJoint& joint : model->joints) joint.effort = 1e-12;  // the motors are out of the way
  HeldArm arm(model, vector_of(request.at("q")));
  const double h = request.at("step").get<double>();
  json out = {{"q", json::array()}};
  for (const json& torques : request.at("torques")) {
    arm.push(vector_of(torques), h);
    out["q"].push_back(list_of(arm.q()));
  }
  return out;
}

}  // namespace moma::probe
