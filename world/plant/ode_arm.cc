#include "world/plant/ode_arm.h"

#include <numbers>

namespace moma {
namespace {

// Deceleration of a joint near its limits [rad/s^2 or m/s^2].
constexpr double kLimitBraking = 20.0;
// ODE's stop is this far beyond the limit [rad or m].
constexpr double kStopBeyond = 0.01;

Isometry shift(const Vector3& p) {
  Isometry X = Isometry::Identity();
  X.translation() = p;
  return X;
}

/// Largest speed towards a limit at distance `room` that ends at the limit.
double speed_into(double room, double h) {
  if (room <= 0.0) return room / h;
  return std::min(room / h, std::sqrt(2.0 * kLimitBraking * room));
}

bool bounded(const ControlledJoint& joint) { return std::isfinite(joint.lower) && std::isfinite(joint.upper); }

}  // namespace

OdeArm::OdeArm(dWorldID world, std::shared_ptr<const RobotModel> model, const Vector3& base, const VectorX& q,
               double drop, double base_mass, const PlantConditions& conditions)
    : model_(std::move(model)), rigid_(rigid_bodies(*model_, base_mass, conditions.payload)), q_(q) {
  for (const RigidBody& body : rigid_.bodies) {
    const dBodyID id = dBodyCreate(world);
    dMass mass;
    dMassSetParameters(&mass, body.mass, 0.0, 0.0, 0.0, body.I_C(0, 0), body.I_C(1, 1), body.I_C(2, 2), body.I_C(0, 1),
                       body.I_C(0, 2), body.I_C(1, 2));
    dBodySetMass(id, &mass);
    // Exact rotation by the angular velocity of a step: ODE's default is off by (omega h)^2 / 12.
    dBodySetFiniteRotationMode(id, 1);
    bodies_.push_back(id);
    mass_ += body.mass;
  }
  // Joints are created at the middle of their ranges, where ODE's angle, which wraps at pi, is zero.
  joints_.resize(model_->joints.size());
  VectorX middle = q;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const ControlledJoint& joint = model_->joints[i];
    if (bounded(joint)) middle[static_cast<Eigen::Index>(i)] = 0.5 * (joint.lower + joint.upper);
    joints_[i].zero = middle[static_cast<Eigen::Index>(i)];
  }
  Kinematics kinematics(model_);
  kinematics.update(base, middle);
  place(kinematics, drop);
  for (const RigidBody& body : rigid_.bodies)
    if (body.joint >= 0) make_joint(world, body, kinematics);
  for (std::size_t i = 0; i < static_cast<std::size_t>(conditions.joint_friction.size()); ++i)
    add_friction(world, joints_[i], conditions.joint_friction[static_cast<Eigen::Index>(i)]);
  kinematics.update(base, q);
  place(kinematics, drop);
}

/// Dry friction: a second motor with target velocity zero and at most this torque or force. ODE's solver then decides
/// between sticking and sliding.
void OdeArm::add_friction(dWorldID world, const Joint& joint, double most) {
  if (!(most > 0.0)) return;
  dVector3 axis;
  const dBodyID child = dJointGetBody(joint.id, 0);
  const dBodyID parent = dJointGetBody(joint.id, 1);
  constexpr int kWithChild = 1;
  if (joint.slides) {
    dJointGetSliderAxis(joint.id, axis);
    const dJointID brake = dJointCreateLMotor(world, nullptr);
    dJointAttach(brake, child, parent);
    dJointSetLMotorNumAxes(brake, 1);
    dJointSetLMotorAxis(brake, 0, kWithChild, axis[0], axis[1], axis[2]);
    dJointSetLMotorParam(brake, dParamVel, 0.0);
    dJointSetLMotorParam(brake, dParamFMax, most);
    return;
  }
  dJointGetHingeAxis(joint.id, axis);
  const dJointID brake = dJointCreateAMotor(world, nullptr);
  dJointAttach(brake, child, parent);
  dJointSetAMotorMode(brake, dAMotorUser);
  dJointSetAMotorNumAxes(brake, 1);
  dJointSetAMotorAxis(brake, 0, kWithChild, axis[0], axis[1], axis[2]);
  dJointSetAMotorParam(brake, dParamVel, 0.0);
  dJointSetAMotorParam(brake, dParamFMax, most);
}

void OdeArm::place(const Kinematics& kinematics, double drop) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Isometry X = kinematics.X_WL(rigid_.bodies[i].link) * shift(rigid_.bodies[i].com_L);
    X.translation().z() -= drop;
    ode::set_pose(bodies_[i], X);
  }
}

void OdeArm::set_param(const Joint& joint, int parameter, double value) {
  if (joint.slides)
    dJointSetSliderParam(joint.id, parameter, value);
  else
    dJointSetHingeParam(joint.id, parameter, value);
}

void OdeArm::make_joint(dWorldID world, const RigidBody& body, const Kinematics& kinematics) {
  const auto index = static_cast<std::size_t>(body.joint);
  const ControlledJoint& limits = model_->joints[index];
  Joint& joint = joints_[index];
  joint.slides = limits.type == JointType::kPrismatic;
  joint.effort = limits.effort;

  const Isometry& X_WL = kinematics.X_WL(body.link);
  const Vector3 axis = X_WL.linear() * model_->link(body.link).axis;
  const dBodyID child = bodies_[static_cast<std::size_t>(rigid_.of_link[static_cast<std::size_t>(body.link)])];
  const dBodyID parent = body.parent < 0 ? nullptr : bodies_[static_cast<std::size_t>(body.parent)];
  const double half = 0.5 * (limits.upper - limits.lower);
  if (joint.slides) {
    joint.id = dJointCreateSlider(world, nullptr);
    dJointAttach(joint.id, child, parent);
    dJointSetSliderAxis(joint.id, axis.x(), axis.y(), axis.z());
  } else {
    // The drop moves every body alike, so the anchor is on the child's axis line wherever the bodies are.
    const Vector3 drop = X_WL * body.com_L - ode::from_vector(dBodyGetPosition(child));
    const Vector3 anchor = X_WL.translation() - drop;
    joint.id = dJointCreateHinge(world, nullptr);
    dJointAttach(joint.id, child, parent);
    dJointSetHingeAnchor(joint.id, anchor.x(), anchor.y(), anchor.z());
    dJointSetHingeAxis(joint.id, axis.x(), axis.y(), axis.z());
  }
  set_param(joint, dParamFMax, limits.effort);
  // A hinge's range that does not fit into ODE's (-pi, pi) would put the stop on the wrong turn; the clamp remains.
  if (bounded(limits) && (joint.slides || half + kStopBeyond < std::numbers::pi - 0.05)) {
    set_param(joint, dParamLoStop, -half - kStopBeyond);
    set_param(joint, dParamHiStop, half + kStopBeyond);
  }
  dJointSetFeedback(joint.id, &joint.feedback);
}

dBodyID OdeArm::body_of_link(int link) const {
  const int index = rigid_.of_link[static_cast<std::size_t>(link)];
  return index < 0 ? nullptr : bodies_[static_cast<std::size_t>(index)];
}

Isometry OdeArm::in_body(int link, const Isometry& X_L) const {
  const auto index = static_cast<std::size_t>(rigid_.of_link[static_cast<std::size_t>(link)]);
  return shift(-rigid_.bodies[index].com_L) * rigid_.X_ML[static_cast<std::size_t>(link)] * X_L;
}

void OdeArm::command(const Eigen::Ref<const VectorX>& speeds, double h) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const ControlledJoint& limits = model_->joints[i];
    const auto k = static_cast<Eigen::Index>(i);
    double speed = std::clamp(speeds[k], -limits.velocity, limits.velocity);
    if (std::isfinite(limits.upper)) speed = std::min(speed, speed_into(limits.upper - q_[k], h));
    if (std::isfinite(limits.lower)) speed = std::max(speed, -speed_into(q_[k] - limits.lower, h));
    // From beyond a limit the joint returns at most at its velocity limit.
    speed = std::clamp(speed, -limits.velocity, limits.velocity);
    set_param(joints_[i], dParamVel, speed);
  }
}

void OdeArm::read(VectorX& q, Eigen::Ref<VectorX> qdot) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = joints_[i];
    const auto k = static_cast<Eigen::Index>(i);
    if (joint.slides) {
      q_[k] = joint.zero + dJointGetSliderPosition(joint.id);
      qdot[k] = dJointGetSliderPositionRate(joint.id);
    } else {
      const double wrapped = joint.zero + dJointGetHingeAngle(joint.id);
      q_[k] = wrapped + kTurn * std::round((q_[k] - wrapped) / kTurn);
      qdot[k] = dJointGetHingeAngleRate(joint.id);
    }
  }
  q = q_;
}

void OdeArm::set_bounded(bool bounded) {
  if (bounded == bounded_) return;
  bounded_ = bounded;
  for (const Joint& joint : joints_) set_param(joint, dParamFMax, bounded ? joint.effort : dInfinity);
}

bool OdeArm::clear_of_stops() const {
  constexpr double kClear = 0.9 * kStopBeyond;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const ControlledJoint& limits = model_->joints[i];
    const double q = q_[static_cast<Eigen::Index>(i)];
    if (!(q > limits.lower - kClear && q < limits.upper + kClear)) return false;
  }
  return true;
}

void OdeArm::before_step() {
  for (Joint& joint : joints_) {
    dVector3 axis;
    if (joint.slides) {
      dJointGetSliderAxis(joint.id, axis);
    } else {
      dVector3 anchor;
      dJointGetHingeAxis(joint.id, axis);
      dJointGetHingeAnchor(joint.id, anchor);
      joint.lever = ode::from_vector(anchor) - ode::from_vector(dBodyGetPosition(dJointGetBody(joint.id, 0)));
    }
    joint.axis = ode::from_vector(axis);
  }
}

void OdeArm::after_step() {
  for (Joint& joint : joints_) {
    const Vector3 force = ode::from_vector(joint.feedback.f1);
    // The feedback's torque is about the body's centre; the joint's own torque is about its anchor.
    const Vector3 wrench = joint.slides ? force : ode::from_vector(joint.feedback.t1) - joint.lever.cross(force);
    joint.torque = wrench.dot(joint.axis);
  }
}

double OdeArm::load() const {
  double most = 0.0;
  for (const Joint& joint : joints_) most = larger_load(most, joint.torque, joint.effort);
  return most;
}

double OdeArm::power() const {
  double sum = 0.0;
  for (const Joint& joint : joints_)
    sum += std::abs(joint.torque *
                    (joint.slides ? dJointGetSliderPositionRate(joint.id) : dJointGetHingeAngleRate(joint.id)));
  return sum;
}

}  // namespace moma
