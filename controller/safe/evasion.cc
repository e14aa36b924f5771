#include "controller/safe/evasion.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "controller/model/base_kind.h"
#include "controller/params.h"

namespace moma {
namespace {

// Limits the velocity by the wheels' speeds.
Vector3 driven(const RobotModel& model, Vector3 velocity) noexcept {
  if (!model.base.wheels) return velocity;
  Eigen::Vector4d speeds = Eigen::Vector4d::Zero();  // two of them stay 0 with two wheels
  wheel_speeds(model.base, velocity.head(model.base_dof()), speeds);
  const double fastest = speeds.cwiseAbs().maxCoeff();
  return fastest > model.base.wheels->max_speed ? velocity * (model.base.wheels->max_speed / fastest) : velocity;
}

std::vector<Vector3> base_velocities(const RobotModel& model, double v) {
  std::vector<Vector3> out;
  const int dof = model.base_dof();
  if (dof == 0) return out;
  const double w = model.base.max_angular;
  if (kind_of(model.base.type).lateral()) {
    constexpr int kDirections = 8;
    for (const double part : {1.0, 0.5})
      for (int k = 0; k < kDirections; ++k) {
        const Vector2 along = Eigen::Rotation2Dd(2.0 * std::numbers::pi * k / kDirections) * Vector2::UnitX();
        out.push_back(driven(model, {part * v * along.x(), part * v * along.y(), 0.0}));
      }
    for (const double turn : {0.5, -0.5}) out.push_back(driven(model, {0.0, 0.0, turn * w}));
    return out;
  }
  for (const double part : {1.0, -1.0, 0.5, -0.5, 0.0})
    for (const double turn : {0.0, 0.4, -0.4, 1.0, -1.0})
      if (part != 0.0 || turn != 0.0) out.push_back(driven(model, {part * v, turn * w, 0.0}));
  return out;
}

}  // namespace

Evasion::Evasion(std::shared_ptr<const RobotModel> model, const EvasionParams& params, const VectorX& acceleration,
                 double share, double max_linear, double control_period)
    : model_(std::move(model)),
      params_(params),
      acceleration_(acceleration),
      dt_(control_period),
      ramp_(*model_),
      share_(share > 0.0 ? share : 1.0),
      velocities_(base_velocities(*model_, max_linear)),
      kinematics_(model_),
      proximity_(model_),
      range_(std::max(params.margin + params.reaction * max_linear, params.at_rest)),
      num_linear_(kind_of(model_->base.type).num_linear()),
      q_(VectorX::Zero(model_->num_joints())),
      qdot_(q_),
      mean_(VectorX::Zero(model_->num_velocities())) {}

void Evasion::set_objects(std::span<const ObjectShape> objects) {
  proximity_.set_objects(objects);
  states_.assign(objects.size(), ObjectState{});
  gaps_.assign(objects.size(), kInfinity);
  need_.assign(objects.size(), 0.0);
  radii_.clear();
  for (const ObjectShape& object : objects) radii_.push_back(bounding_radius(object.shape));
}

// Largest distance of the robot's solids from the base's origin until the arm has stopped.
double Evasion::reach(const Observation& o, const VectorX& command) noexcept {
  kinematics_.place(o.base, o.q);
  const Vector3 origin = kinematics_.X_WB().translation();
  double reach = 0.0, moved = 0.0, turned = 0.0;
  for (const CollisionShape& shape : model_->present_shapes())
    reach = std::max(reach, (kinematics_.X_WS(shape).translation() - origin).norm() + bounding_radius(shape.shape));
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const Eigen::Index k = ramp_.dof() + i;
    const double speed = std::max(std::abs(o.qdot[k]), std::abs(command[k]));
    const double way = speed * dt_ + 0.5 * speed * speed / acceleration_[k];
    (model_->joint(i).type == JointType::kPrismatic ? moved : turned) += way;
  }
  return reach + moved + 2.0 * reach * turned;
}

// Measures the objects' distances at base_, q_ and states_, infinite beyond `range`, and returns the least. Skips the
// query if all spheres about objects are outside.
double Evasion::look(double range) noexcept {
  std::fill(gaps_.begin(), gaps_.end(), kInfinity);
  bool near = false;
  for (std::size_t i = 0; i < states_.size() && !near; ++i) {
    if (!states_[i].visible) continue;
    const Vector3 away = states_[i].X_WO.translation() - Vector3(base_.x(), base_.y(), 0.0);
    near = !(away.norm() > range + reach_ + radii_[i]);
  }
  if (!near) return kInfinity;
  kinematics_.place(base_, q_);
  double least = kInfinity;
  for (const ProximityPair& pair : proximity_.query(kinematics_, states_, {range, -1.0, -1.0})) {
    double& gap = gaps_[static_cast<std::size_t>(pair.second)];
    gap = std::min(gap, pair.distance.d);
    least = std::min(least, gap);
  }
  return least;
}

// Moves the base towards its target, the arm by qdot_, and objects by their twists.
void Evasion::drive(const Vector3& target, double dt) noexcept {
  ramp_.set_base(ramp_.follow(target, dt, velocity_), mean_);
  integrate(*model_, base_, q_, mean_, dt);
  for (ObjectState& object : states_)
    if (object.visible && in_motion(object)) object.X_WO.translation() += dt * object.V_WO_W.tail<3>();
}

void Evasion::begin(const Observation& o) noexcept {
  base_ = o.base;
  q_ = o.q;
  velocity_ = ramp_.base_of(o.qdot);
  qdot_ = o.qdot.tail(q_.size());
  std::copy(o.objects.begin(), o.objects.end(), states_.begin());
}

// Advances a way out: the base towards its target, the arm braking.
void Evasion::go_on(const Vector3& target, double dt) noexcept {
  const int dof = ramp_.dof();
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const double lost = dt * acceleration_[dof + i], speed = std::abs(qdot_[i]);
    const double left = std::max(0.0, speed - lost);
    const double mean = left > 0.0 ? 0.5 * (speed + left) : (speed > 0.0 ? 0.5 * speed * speed / lost : 0.0);
    mean_[dof + i] = std::copysign(mean, qdot_[i]);
    qdot_[i] = std::copysign(left, qdot_[i]);
  }
  drive(target, dt);
}

// True if the way out towards `target` is clear after one period of `command`.
bool Evasion::is_clear(const Observation& o, const VectorX& command, const Vector3& target) noexcept {
  ++tried_;
  begin(o);
  qdot_ = command.tail(q_.size());
  mean_.tail(q_.size()) = qdot_;
  drive(ramp_.base_of(command), dt_);
  double step = params_.first;
  for (double t = dt_; t < params_.horizon; step = params_.step) {
    go_on(target, step);
    t += step;
    const double least = look(range_);
    const double margin = params_.margin + params_.reaction * velocity_.head(num_linear_).norm();
    for (std::size_t i = 0; i < gaps_.size(); ++i)
      if (gaps_[i] < (in_motion(states_[i]) ? std::min(margin, need_[i]) : need_[i])) return false;
    if (least < params_.touch) return true;  // at least the present distance
  }
  return true;
}

// Value of the way out towards `target` that begins now: the time of the first contact [s]. Without contact the
// horizon and three terms: the least distance [m], up to `range` again for the part of the margin that it keeps, and up
// to `range` for the part of another horizon in which the robot may stand at its end. So a way out with little room
// ranks low, and so does one that drives on in front of a moving object.
double Evasion::worth(const Observation& o, const Vector3& target) noexcept {
  ++tried_;
  begin(o);
  const double range = params_.ranked * params_.margin;
  double worst = range;
  for (double t = 0.0; t < params_.horizon;) {
    go_on(target, params_.step);
    t += params_.step;
    const double least = look(range);
    if (least < params_.touch) return t;
    worst = std::min(worst, least);
  }
  mean_.tail(q_.size()).setZero();
  double stood = 0.0;
  for (; stood < params_.horizon; stood += params_.step) {
    drive(Vector3::Zero(), params_.step);
    if (look(range) < params_.touch) break;
  }
  return params_.horizon + worst + params_.ranked * std::min(worst, params_.margin) +
         range * std::min(1.0, stood / params_.horizon);
}

bool Evasion::passes(const Observation& o, const VectorX& command, VectorX& base) noexcept {
  tried_ = 0;
  if (velocities_.empty()) return true;
  if (!std::any_of(o.objects.begin(), o.objects.end(),
                   [](const ObjectState& object) { return object.visible && in_motion(object); }))
    return true;
  reach_ = reach(o, command);
  begin(o);
  look(range_);
  for (std::size_t i = 0; i < need_.size(); ++i)
    need_[i] = std::min(in_motion(states_[i]) ? range_ : params_.at_rest, gaps_[i]);

  const Vector3 stop = Vector3::Zero(), held = ramp_.base_of(command);
  if (is_clear(o, command, held) || is_clear(o, command, stop)) return true;
  for (std::size_t i = 0; i < velocities_.size(); ++i, clear_ = (clear_ + 1) % velocities_.size())
    if (is_clear(o, command, velocities_[clear_])) return true;
  double best = worth(o, stop);
  Vector3 chosen = stop;
  for (const Vector3& target : velocities_) {
    const double value = worth(o, target);
    if (!(value > best)) continue;
    best = value;
    chosen = target;
  }
  ramp_.set_base(ramp_.limited(chosen, ramp_.base_of(o.qdot), share_, dt_), base);
  return false;
}

}  // namespace moma
