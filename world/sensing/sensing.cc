#include "world/sensing/sensing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moma {
namespace {

Vector3 normal3(Draws draws, double sigma) {
  Vector3 v;
  for (double& x : v) x = draws.normal(0.0, sigma);
  return v;
}

/// Turns a pose by a rotation vector in world axes, about its own origin.
void turn(Isometry& X_W, const Vector3& rotation_W) {
  const double angle = rotation_W.norm();
  if (angle > 0.0) X_W.linear() = Eigen::AngleAxisd(angle, rotation_W / angle) * X_W.linear();
}

/// Moves a pose that is fixed to a base at `from` along to a base at `to`; (x, y, phi) each.
void carry(const Vector3& from, const Vector3& to, Isometry& X_W, Vector6& V_W) {
  const Matrix3 R = Eigen::AngleAxisd(to.z() - from.z(), Vector3::UnitZ()).toRotationMatrix();
  const Vector3 p_from(from.x(), from.y(), 0.0), p_to(to.x(), to.y(), 0.0);
  X_W.translation() = R * (X_W.translation() - p_from) + p_to;
  X_W.linear() = R * X_W.linear();
  V_W.head<3>() = R * V_W.head<3>();
  V_W.tail<3>() = R * V_W.tail<3>();
}

// Rounds to multiples of `step`; no effect if that is 0.
double rounded(double value, double step) { return step > 0.0 ? std::round(value / step) * step : value; }

// Does not own the model, which must live as long.
std::shared_ptr<const RobotModel> borrowed(const RobotModel& model) { return {std::shared_ptr<void>(), &model}; }

}  // namespace

using enum DisturbanceSource;

const Sensing::PoseSources Sensing::kObject{kObjectPosition, kObjectRotation,     kObjectLinear,
                                            kObjectAngular,  kObjectBiasPosition, kObjectBiasRotation};
const Sensing::PoseSources Sensing::kGoal{kGoalPosition, kGoalRotation,     kGoalLinear,
                                          kGoalAngular,  kGoalBiasPosition, kGoalBiasRotation};

Sensing::Sensing(const Disturbances& disturbances, const RobotModel& model, const World& world, double control_period)
    : config_(disturbances),
      streams_(world, disturbances.seed),
      base_dof_(model.base_dof()),
      odometry_(disturbances.base.odometry, streams_),
      detection_(disturbances.detection, world, streams_, control_period, borrowed(model)),
      phantoms_(disturbances.detection.phantoms, streams_, control_period),
      joint_bias_(VectorX::Zero(model.num_joints())),
      joints_{VectorX::Zero(model.num_joints()), VectorX::Zero(model.num_joints())},
      late_joints_(config_.joints.delay, config_.joints.irregularity, control_period, joints_, BeforeFirst::kHoldFirst),
      late_base_(config_.base.delay, config_.base.irregularity, control_period, base_, BeforeFirst::kHoldFirst),
      late_objects_(config_.objects.delay, config_.objects.irregularity, control_period,
                    std::vector<ObjectState>(world.objects.size() + phantoms_.count()), BeforeFirst::kHoldFirst),
      late_goal_(config_.goal.delay, config_.goal.irregularity, control_period, {}, BeforeFirst::kHoldFirst) {
  Draws joint_bias = streams_.sensing(kJointBias, 0);
  for (double& bias : joint_bias_) bias = joint_bias.normal(0.0, config_.joints.bias);
  if (base_dof_ > 0) {
    base_bias_ = normal3(streams_.sensing(kBaseBiasPosition, 0), config_.base.bias.position);
    base_bias_.z() = streams_.sensing(kBaseBiasRotation, 0).normal(0.0, config_.base.bias.rotation);
  }
  for (std::size_t i = 0; i < world.objects.size(); ++i) object_bias_.push_back(draw_bias(config_.objects, kObject, i));
  goal_bias_ = draw_bias(config_.goal, kGoal, 0);
  if (disturbances.detection.seen_by != SeenBy::kDepth) return;
  std::vector<Shape> shapes;
  for (const WorldObject& object : world.objects) shapes.push_back(object.shape);
  depth_.emplace(disturbances, model, shapes, streams_, control_period);
}

Sensing::PoseBias Sensing::draw_bias(const PoseSensing& config, const PoseSources& sources, std::size_t object) const {
  return {normal3(streams_.sensing(sources.bias_position, 0, object), config.bias.position),
          normal3(streams_.sensing(sources.bias_rotation, 0, object), config.bias.rotation)};
}

void Sensing::sense(long k, Observation& seen) {
  true_base_ = seen.base;
  if (depth_) {
    depth_->sense(k, true_base_, seen.q, seen.objects);
    seen.objects.clear();
  }
  if (detection_.on() && !depth_)
    detection_.update(k, true_base_, seen.q, seen.objects);
  else if (config_.objects.noise_growth > 0.0 || config_.goal.noise_growth > 0.0)
    detection_.place(true_base_, seen.q);
  if (base_dof_ > 0) measure_base(k, seen);
  seen_base_ = seen.base;
  measure_joints(k, seen);
  for (std::size_t i = 0; i < seen.objects.size(); ++i) {
    ObjectState& object = seen.objects[i];
    if (object.visible) {
      measure_pose(config_.objects, kObject, object_bias_[i], k, i, object.X_WO, object.V_WO_W);
    } else {
      object.X_WO.setIdentity();
      object.V_WO_W.setZero();
    }
  }
  measure_pose(config_.goal, kGoal, goal_bias_, k, 0, seen.goal.X_WG, seen.goal.V_WG_W);
  if (seen.next) measure_pose(config_.goal, kGoal, goal_bias_, k, 1, seen.next->X_WG, seen.next->V_WG_W);
  if (phantoms_.count() > 0 && !depth_) phantoms_.append(k, true_base_, seen.objects);
  late(k, seen);
}

void Sensing::measure_base(long k, Observation& seen) {
  const BaseSensing& config = config_.base;
  if (odometry_.on()) seen.base = odometry_.update(k, seen.base);
  seen.base += base_bias_;
  if (config.noise.position > 0.0) {
    Draws draws = streams_.sensing(kBasePosition, k);
    seen.base.x() += draws.normal(0.0, config.noise.position);
    seen.base.y() += draws.normal(0.0, config.noise.position);
  }
  if (config.noise.rotation > 0.0)
    seen.base.z() += streams_.sensing(kBaseRotation, k).normal(0.0, config.noise.rotation);
  // Linear coordinates come first, the turn last.
  if (config.velocity_noise.linear > 0.0) {
    Draws draws = streams_.sensing(kBaseLinear, k);
    for (int i = 0; i + 1 < base_dof_; ++i) seen.qdot[i] += draws.normal(0.0, config.velocity_noise.linear);
  }
  if (config.velocity_noise.angular > 0.0)
    seen.qdot[base_dof_ - 1] += streams_.sensing(kBaseAngular, k).normal(0.0, config.velocity_noise.angular);
  const TwistSpread& step = config.velocity_resolution;
  for (int i = 0; i < base_dof_; ++i)
    seen.qdot[i] = rounded(seen.qdot[i], i + 1 < base_dof_ ? step.linear : step.angular);
}

void Sensing::measure_joints(long k, Observation& seen) const {
  const JointSensing& config = config_.joints;
  seen.q += joint_bias_;
  if (config.noise > 0.0) {
    Draws draws = streams_.sensing(kJointNoise, k);
    for (double& q : seen.q) q += draws.normal(0.0, config.noise);
  }
  if (config.velocity_noise > 0.0) {
    Draws draws = streams_.sensing(kJointVelocity, k);
    for (Eigen::Index i = base_dof_; i < seen.qdot.size(); ++i)
      seen.qdot[i] += draws.normal(0.0, config.velocity_noise);
  }
  for (double& q : seen.q) q = rounded(q, config.resolution);
  for (Eigen::Index i = base_dof_; i < seen.qdot.size(); ++i)
    seen.qdot[i] = rounded(seen.qdot[i], config.velocity_resolution);
}

void Sensing::measure_pose(const PoseSensing& config, const PoseSources& sources, const PoseBias& bias, long k,
                           std::size_t object, Isometry& X_W, Vector6& V_W) const {
  const double factor = noise_factor(config, X_W.translation());
  if (config.frame == SensingFrame::kBase && seen_base_ != true_base_) carry(true_base_, seen_base_, X_W, V_W);
  Vector3 rotation = bias.rotation;
  X_W.translation() += bias.position;
  if (config.noise.position > 0.0)
    X_W.translation() += normal3(streams_.sensing(sources.position, k, object), factor * config.noise.position);
  if (config.noise.rotation > 0.0)
    rotation += normal3(streams_.sensing(sources.rotation, k, object), factor * config.noise.rotation);
  turn(X_W, rotation);
  if (config.resting_is_known && V_W.isZero(0.0)) return;
  if (config.velocity_noise.angular > 0.0)
    V_W.head<3>() += normal3(streams_.sensing(sources.angular, k, object), config.velocity_noise.angular);
  if (config.velocity_noise.linear > 0.0)
    V_W.tail<3>() += normal3(streams_.sensing(sources.linear, k, object), config.velocity_noise.linear);
}

// Factor on the noise for a true position; 1 if noise does not grow.
double Sensing::noise_factor(const PoseSensing& config, const Vector3& p_W) const {
  return config.noise_growth > 0.0 ? 1.0 + config.noise_growth * (p_W - detection_.sensor_W(p_W)).squaredNorm() : 1.0;
}

void Sensing::late(long k, Observation& seen) {
  const auto draws = [&](DisturbanceSource source) {
    return [this, source, k] { return streams_.sensing(source, k); };
  };
  joints_.q = seen.q;
  joints_.qdot = seen.qdot.tail(seen.q.size());
  late_joints_.pass(k, joints_, draws(kJointArrival));
  base_.pose = seen.base;
  base_.velocity.head(base_dof_) = seen.qdot.head(base_dof_);
  late_base_.pass(k, base_, draws(kBaseArrival));
  seen.q = joints_.q;
  seen.qdot.tail(seen.q.size()) = joints_.qdot;
  seen.base = base_.pose;
  seen.qdot.head(base_dof_) = base_.velocity.head(base_dof_);
  if (!depth_) late_objects_.pass(k, seen.objects, draws(kObjectArrival));
  GoalReading goals{seen.goal, seen.next};
  late_goal_.pass(k, goals, draws(kGoalArrival));
  seen.goal = goals.goal;
  seen.next = goals.next;
}

Phantoms::Phantoms(const FalseDetections& rule, const DisturbanceStreams& streams, double control_period)
    : rule_(rule),
      streams_(streams),
      span_(std::max(1L, delay_steps(rule.duration, control_period))),
      states_(static_cast<std::size_t>(rule.count)) {}

std::vector<ObjectShape> Phantoms::shapes(const World& world) const {
  std::vector<ObjectShape> out;
  for (std::size_t i = 0; i < count(); ++i) {
    ObjectShape& shape = out.emplace_back();
    shape.name = "phantom" + std::to_string(i);
    while (std::ranges::any_of(world.objects, [&](const WorldObject& object) { return object.name == shape.name; }))
      shape.name += "'";
    shape.shape.kind = ShapeKind::kSphere;
    shape.shape.size = Vector3(rule_.radius, 0.0, 0.0);
  }
  return out;
}

void Phantoms::append(long k, const Vector3& base, std::vector<ObjectState>& objects) {
  if (k % span_ == 0) {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      Draws draws = streams_.sensing(DisturbanceSource::kPhantom, k / span_, i);
      ObjectState& state = states_[i];
      state = {};
      state.visible = draws.uniform() < rule_.probability;
      if (!state.visible) continue;
      const double low = std::min(rule_.nearest, rule_.furthest), high = std::max(rule_.nearest, rule_.furthest);
      const double distance = draws.uniform(low, high), angle = draws.uniform(-std::numbers::pi, std::numbers::pi);
      state.X_WO.translation() = Vector3(base.x() + distance * std::cos(angle), base.y() + distance * std::sin(angle),
                                         draws.uniform(0.0, rule_.height));
    }
  }
  objects.insert(objects.end(), states_.begin(), states_.end());
}

PlantConditions plant_conditions(const Disturbances& disturbances, const RobotModel& model, const World& world) {
  PlantConditions out;
  if (!moves_with_errors(disturbances)) return out;
  using enum DisturbanceSource;
  const DisturbanceStreams streams(world, disturbances.seed);
  const auto draw = [](Draws& draws, double mean, double spread) { return std::max(0.0, draws.normal(mean, spread)); };

  const UnknownPayload& payload = disturbances.payload;
  Draws mass = streams.acting(kPayloadMass);
  out.payload.mass = draw(mass, payload.mass, payload.spread);
  out.payload.p_EP_E = {payload.position[0], payload.position[1], payload.position[2]};
  Draws floor = streams.acting(kFloorFriction);
  out.floor_friction = draw(floor, disturbances.floor.friction, disturbances.floor.spread);
  const JointFriction& of_joints = disturbances.actuators.joints.friction;
  if (is_off(of_joints)) return out;
  Draws friction = streams.acting(kJointFriction);
  out.joint_friction.resize(model.num_joints());
  for (int i = 0; i < model.num_joints(); ++i) {
    // A joint that its own motor cannot move at all is broken, not disturbed.
    constexpr double kMost = 0.95;
    const double fraction = std::min(kMost, draw(friction, of_joints.effort, of_joints.spread));
    out.joint_friction[i] = fraction * model.joint(i).effort;
  }
  return out;
}

}  // namespace moma
