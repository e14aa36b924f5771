#include <cmath>
#include <memory>
#include <vector>

#include "world/plant/ode_base.h"

namespace moma {
namespace {

constexpr double kFootStiffness = 1e11;  // [N/m]

/// Four mecanum wheels as one planar velocity drive, without rollers. The wheels are frictionless supports. Motors
/// between base and floor give the base its commanded velocity, up to the friction under the whole weight: force mu m g
/// in each direction, moment mu m g times the lever of the wheels.
class OmnidirectionalBase final : public OdeBase {
 public:
  OmnidirectionalBase(dWorldID world, const RobotModel& model, OdeArm& arm, double friction)
      : model_(model),
        arm_(arm),
        base_(arm.body_of_link(0)),
        support_(arm, feet(model), foot_radius(model), kFootStiffness) {
    force_ = friction * arm.mass() * 9.81;
    moment_ = force_ * lever(model);
    linear_ = dJointCreateLMotor(world, nullptr);
    dJointAttach(linear_, base_, nullptr);
    dJointSetLMotorNumAxes(linear_, 2);
    dJointSetLMotorAxis(linear_, 0, 0, 1.0, 0.0, 0.0);
    dJointSetLMotorAxis(linear_, 1, 0, 0.0, 1.0, 0.0);
    dJointSetLMotorParam(linear_, dParamFMax, force_);
    dJointSetLMotorParam(linear_, dParamFMax2, force_);
    dJointSetFeedback(linear_, &linear_feedback_);
    angular_ = dJointCreateAMotor(world, nullptr);
    dJointAttach(angular_, base_, nullptr);
    dJointSetAMotorMode(angular_, dAMotorUser);
    dJointSetAMotorNumAxes(angular_, 1);
    dJointSetAMotorAxis(angular_, 0, 0, 0.0, 0.0, 1.0);
    dJointSetAMotorParam(angular_, dParamFMax, moment_);
    dJointSetFeedback(angular_, &angular_feedback_);
  }

  void command(const Eigen::Ref<const VectorX>& speeds, double h) override {
    // The body's position is that of its centre of mass: the target for it after exactly this motion of B.
    const Isometry X_BC = arm_.in_body(0, Isometry::Identity()).inverse();
    const Isometry X_WB = ode::pose(base_) * X_BC.inverse();
    const double heading = std::atan2(X_WB.linear()(1, 0), X_WB.linear()(0, 0));
    Vector3 base(X_WB.translation().x(), X_WB.translation().y(), heading);
    const Vector3 before = base_pose(base) * X_BC.translation();
    VectorX q(model_.num_joints());
    VectorX velocity = VectorX::Zero(model_.num_velocities());
    q.setZero();
    velocity.head<3>() = speeds;
    integrate(model_, base, q, velocity, h);
    wanted_ = (base_pose(base) * X_BC.translation() - before) / h;
    dJointSetLMotorParam(linear_, dParamVel, wanted_.x());
    dJointSetLMotorParam(linear_, dParamVel2, wanted_.y());
    dJointSetAMotorParam(angular_, dParamVel, speeds[2]);
  }

  void add_floor_contacts(dWorldID world, dJointGroupID group, double h) override {
    support_.add_contacts(world, group, h);
  }

  double slip() const override {
    const Vector3 v = ode::from_vector(dBodyGetLinearVel(base_)) - wanted_;
    return std::hypot(v.x(), v.y());
  }

  double power() const override {
    const Vector3 v = ode::from_vector(dBodyGetLinearVel(base_));
    const dReal* force = linear_feedback_.f1;
    return std::abs(force[0] * v.x()) + std::abs(force[1] * v.y()) +
           std::abs(angular_feedback_.t1[2] * dBodyGetAngularVel(base_)[2]);
  }

  void set_bounded(bool bounded) override {
    dJointSetLMotorParam(linear_, dParamFMax, bounded ? force_ : dInfinity);
    dJointSetLMotorParam(linear_, dParamFMax2, bounded ? force_ : dInfinity);
    dJointSetAMotorParam(angular_, dParamFMax, bounded ? moment_ : dInfinity);
  }

  double load() const override {
    const dReal* force = linear_feedback_.f1;
    const double linear = larger_load(larger_load(0.0, force[0], force_), force[1], force_);
    return larger_load(linear, angular_feedback_.t1[2], moment_);
  }

  void list_bodies(ode::BodyStates&) const override {}  // no own bodies

 private:
  static double foot_radius(const RobotModel& model) { return model.base.wheels ? model.base.wheels->radius : 0.05; }

  static std::vector<Vector2> feet(const RobotModel& model) {
    if (!model.base.wheels || !(model.base.wheels->wheelbase > 0.0))
      return OdeSupport::corners(model, foot_radius(model), false);
    std::vector<Vector2> points;
    for (const double x : {0.5, -0.5})
      for (const double y : {0.5, -0.5})
        points.emplace_back(x * model.base.wheels->wheelbase, y * model.base.wheels->separation);
    return points;
  }

  /// Mean lever of the wheels' forces about the centre.
  static double lever(const RobotModel& model) {
    double sum = 0.0;
    const std::vector<Vector2> points = feet(model);
    for (const Vector2& p : points) sum += p.norm();
    return sum / static_cast<double>(points.size());
  }

  const RobotModel& model_;
  OdeArm& arm_;
  dBodyID base_;
  OdeSupport support_;
  double force_ = 0.0, moment_ = 0.0;  // limits of the drive [N, Nm]
  dJointID linear_ = nullptr, angular_ = nullptr;
  dJointFeedback linear_feedback_{}, angular_feedback_{};
  Vector3 wanted_ = Vector3::Zero();
};

std::unique_ptr<OdeBase> make_omnidirectional(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3&,
                                              double friction) {
  return std::make_unique<OmnidirectionalBase>(world, model, arm, friction);
}

}  // namespace

OdeBaseKind omnidirectional_base() { return {.make = make_omnidirectional}; }

}  // namespace moma
