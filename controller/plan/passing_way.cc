#include "controller/plan/passing_way.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace moma {
namespace {

constexpr double kHalf = 0.01;  // half the time over which a velocity of the base is taken [s]
constexpr double kPassDamping = 1e-4;
constexpr int kTimings = 4;                          // times and places of passing that a try has
constexpr std::array kScales{0.15, 0.4, 1.0, 0.05};  // of the draws around a configuration
constexpr double kLeastReach = 0.05;                 // [m]

}  // namespace

PassingWay::PassingWay(const MotionLimits& limits, const PlanParams& params, FreeSpace& space, const WholeBodyIk& ik)
    : limits_(limits), params_(params), space_(space), ik_(ik) {}

void PassingWay::begin(const MotionState& start, const Isometry& X_WG, const Isometry& X_WN,
                       const WholeConfiguration& pass) noexcept {
  start_ = start;
  X_WG_ = X_WG;
  X_WN_ = X_WN;
  near_ = pass;
  kept_.reset();
}

void PassingWay::keep() noexcept {
  near_ = pass_.c;
  if (limits_.base->nonholonomic()) near_.head<2>() = via_;
  kept_ = passing_;
}

double PassingWay::make(int index, CountedDraws& draws) noexcept {
  seed(index, draws);
  if (!ik_.solve(space_, X_WG_, pass_.c) || !(limits_.base->nonholonomic() ? make_steered() : make_free()))
    return kInfinity;
  return arm_.time;
}

// Draws joints and a place around the given configuration, and pulls the place towards the way to the next goal.
void PassingWay::seed(int index, CountedDraws& draws) noexcept {
  const DirectWayParams& p = params_.direct_way;
  const double scale = kScales[static_cast<std::size_t>(index) % kScales.size()];
  WholeConfiguration& c = pass_.c;
  c = near_;
  pass_.v.setZero(c.size());
  space_.vary_joints(scale * p.joints, draws, c);
  if (!limits_.mobile()) return;
  const Vector2 start = start_.c.head<2>(), way = X_WN_.translation().head<2>() - start;
  const double along = std::clamp((c.head<2>() - start).dot(way) / std::max(way.squaredNorm(), 1e-9), 0.0, 1.0);
  const Vector2 aside(draws.uniform(-p.far, p.far), draws.uniform(-p.far, p.far));
  c.head<2>() += scale * (0.5 * aside + draws.uniform() * (start + along * way - c.head<2>()));
  head_along(limits_, start_.c, SteeredDrive::kReached, c);
  passing_.reach = draws.uniform(kLeastReach, p.pass_reach);
  passing_.speed = limits_.linear * std::min(1.0, draws.uniform(0.1, 1.5));
  if (!kept_) return;
  passing_.reach = std::lerp(kept_->reach, passing_.reach, scale);
  passing_.speed = std::lerp(kept_->speed, passing_.speed, scale);
}

// The base drives; the arm reaches the goal from where it then is.
bool PassingWay::make_steered() noexcept {
  via_ = pass_.c.head<2>();
  WholeConfiguration c;
  for (int timing = 0; timing < kTimings; ++timing) {
    if (!drive()) return false;
    path_.begin(start_.c);
    drive_.add_to(path_);
    const double at = drive_.time();
    path_.at(at, c);
    path_.velocity(at - kHalf, kHalf, pass_.v);
    pass_.c.head<3>() = c.head<3>();
    WholeConfiguration near = pass_.c;
    if (!ik_.solve(space_, X_WG_, pass_.c, false)) {
      // The base has to come by a place from which the arm reaches the goal with that heading.
      if (!ik_.solve(space_, X_WG_, near)) return false;
      via_ += (near - c).head<2>();
      pass_.c = near;
      continue;
    }
    space_.unwind(pass_.c);
    if (!hold_hand()) return false;
    arm_ = quick_glide(limits_, Moves::kArm, start_, pass_, at);
    if (arm_.time <= at) return true;
    if (!(arm_.time < kInfinity)) return false;
    passing_.speed *= at / arm_.time;  // the base comes as late as the arm
  }
  return false;
}

// An omnidirectional base has a velocity at its place; a fixed arm has one.
bool PassingWay::make_free() noexcept {
  space_.unwind(pass_.c);
  pass_.c[2] = start_.c[2] + wrapped(pass_.c[2] - start_.c[2]);
  if (limits_.mobile()) {
    const Vector2 to = (pass_.c - start_.c).head<2>(), on = X_WN_.translation().head<2>() - pass_.c.head<2>();
    pass_.v.head<2>() = 0.5 * passing_.speed * (to.normalized() + on.normalized());
  }
  if (!hold_hand()) return false;
  arm_ = quick_glide(limits_, Moves::kArm, start_, pass_, 0.0);
  if (limits_.mobile()) {
    base_ = quick_glide(limits_, Moves::kBase, start_, pass_, arm_.time);
    if (!(base_.time < kInfinity)) return false;
    arm_ = quick_glide(limits_, Moves::kArm, start_, pass_, base_.time);
    if (arm_.time != base_.time) return false;
  }
  return arm_.time < kInfinity;
}

// Gives the arm a part of the velocity at which the hand would stand while the base moves on (damped least squares): as
// little as makes the hand slow enough. A fixed arm moves on at what its hand may have. False if the hand is too quick.
bool PassingWay::hold_hand() noexcept {
  const DirectWayParams& p = params_.direct_way;
  const int joints = limits_.num_joints();
  WholeJacobian J(6, 3 + joints);
  free_jacobian(space_.place(pass_.c), J);
  space_.charge(1);
  const auto arm = J.rightCols(joints);
  const auto factor = [&](const Vector6& V) {
    return std::max(V.head<3>().norm() / p.pass_angular, V.tail<3>().norm() / p.pass_linear);
  };
  const Vector6 V = J.leftCols<3>() * pass_.v.head<3>();
  auto v = pass_.v.tail(joints);
  double most = 1.0;
  if (limits_.mobile()) {
    Eigen::Matrix<double, 6, 6> M = arm * arm.transpose();
    M.diagonal().array() += kPassDamping;
    v = -arm.transpose() * M.ldlt().solve(V);
  } else {
    v = 4.0 * (pass_.c - start_.c).tail(joints);
    most = std::max(most, factor(arm * v));
  }
  for (int i = 0; i < joints; ++i) most = std::max(most, std::abs(v[i]) / (p.pass_joints * limits_.joint_speed[i]));
  v /= most;
  if (!limits_.mobile()) return true;
  const Vector6 held = arm * v;
  for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    if (factor(V + part * held) > 1.0) continue;
    v *= part;
    return true;
  }
  return false;
}

bool PassingWay::drive() noexcept {
  const bool reached = drive_.plan(limits_, start_.c.head<3>(), driving_speeds(start_), via_, &passing_);
  space_.charge(drive_.checks());
  return reached;
}

void PassingWay::lay(Path& path, double& longest) noexcept {
  path.begin(start_.c);
  path.clearance = space_.clearances().object;
  path.X_WG = X_WG_;
  WholeConfiguration way = pass_.c - start_.c;
  add_glide(Moves::kArm, arm_, start_, pass_, path);
  if (limits_.base->nonholonomic()) {
    drive_.add_to(path);
    way.head<3>() << drive_.way(), 0.0, drive_.turned();  // as long as the drive
  } else if (limits_.mobile()) {
    add_glide(Moves::kBase, base_, start_, pass_, path);
  }
  longest = limits_.travel(way);
}

}  // namespace moma
