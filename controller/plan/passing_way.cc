#include "controller/plan/passing_way.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace moma {
namespace {

constexpr double kHalf = 0.01;           // half the time over which a velocity of the base is taken [s]
constexpr double kMostJointSpeed = 0.9;  // share of the joints' speeds at the passing
constexpr double kPassDamping = 1e-4;
constexpr int kTimings = 4;                          // times and places of passing that a try has
constexpr std::array kScales{0.15, 0.4, 1.0, 0.05};  // of the draws around a configuration
constexpr double kLeastReach = 0.05;                 // [m]
constexpr double kStand = 0.6;                       // distance from the next goal up to which the base drives [m]

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 3 + kMaxJoints>;

}  // namespace

PassingWay::PassingWay(const MotionLimits& limits, const PlanParams& params, FreeSpace& space, const WholeBodyIk& ik)
    : limits_(limits), params_(params), space_(space), ik_(ik) {
  found_.reserve(static_cast<std::size_t>(params.direct_way.pass_tries));
}

void PassingWay::begin(const MotionState& start, const Isometry& X_WG, const Isometry& X_WN,
                       const WholeConfiguration& pass) noexcept {
  start_ = start;
  X_WG_ = X_WG;
  X_WN_ = X_WN;
  near_ = pass;
  found_.clear();
  draws_ = {};
  tries_ = 0;
}

void PassingWay::work() noexcept {
  Try a;
  ++tries_;
  seed(a);
  if (!make(a)) return;
  found_.insert(
      std::upper_bound(found_.begin(), found_.end(), a, [](const Try& x, const Try& y) { return x.cost < y.cost; }), a);
}

// Draws joints and a place around the given configuration, and pulls the place towards the way to the next goal.
void PassingWay::seed(Try& a) noexcept {
  const DirectWayParams& p = params_.direct_way;
  const double scale = kScales[static_cast<std::size_t>(tries_) % kScales.size()];
  a.pass = start_;
  WholeConfiguration& c = a.pass.c;
  c = near_;
  for (int i = 0; i < limits_.num_joints(); ++i)
    c[3 + i] = std::clamp(c[3 + i] + scale * limits_.part[i] * draws_.uniform(-p.joints, p.joints), space_.lower()[i],
                          space_.upper()[i]);
  if (!limits_.mobile()) return;
  const Vector2 start = start_.c.head<2>(), way = X_WN_.translation().head<2>() - start;
  const double along = std::clamp((c.head<2>() - start).dot(way) / std::max(way.squaredNorm(), 1e-9), 0.0, 1.0);
  const Vector2 aside(draws_.uniform(-p.far, p.far), draws_.uniform(-p.far, p.far));
  c.head<2>() += scale * (0.5 * aside + draws_.uniform() * (start + along * way - c.head<2>()));
  head_along(limits_, start_.c, SteeredDrive::kReached, c);
  a.drive.reach = draws_.uniform(kLeastReach, p.pass_reach);
  a.drive.speed = limits_.linear * std::min(1.0, draws_.uniform(0.1, 1.5));
}

bool PassingWay::make(Try& a) noexcept {
  a.pass.v.setZero();
  if (!ik_.solve(space_, X_WG_, a.pass.c)) return false;
  if (!(limits_.base->nonholonomic() ? make_steered(a) : make_free(a))) return false;
  a.cost = a.arm.time + time_on(a.pass);
  return true;
}

// The base drives; the arm reaches the goal from where it then is.
bool PassingWay::make_steered(Try& a) noexcept {
  a.via = a.pass.c.head<2>();
  WholeConfiguration c;
  for (int timing = 0; timing < kTimings; ++timing) {
    if (!drive(a)) return false;
    path_.origin = start_.c;
    path_.count = 0;
    path_.duration = 0.0;
    drive_.add_to(path_);
    const double at = drive_.time();
    path_.at(at, c);
    path_.velocity(at - kHalf, kHalf, a.pass.v);
    a.pass.c.head<3>() = c.head<3>();
    WholeConfiguration near = a.pass.c;
    if (!ik_.solve(space_, X_WG_, a.pass.c, false)) {
      // The base has to come by a place from which the arm reaches the goal with that heading.
      if (!ik_.solve(space_, X_WG_, near)) return false;
      a.via += (near - c).head<2>();
      a.pass.c = near;
      continue;
    }
    space_.unwind(a.pass.c);
    if (!hold_hand(a.pass)) return false;
    a.arm = quick_glide(limits_, Moves::kArm, start_, a.pass, at);
    if (a.arm.time <= at) return true;
    if (!(a.arm.time < kInfinity)) return false;
    a.drive.speed *= at / a.arm.time;  // the base comes as late as the arm
  }
  return false;
}

// An omnidirectional base has a velocity at its place; a fixed arm has one.
bool PassingWay::make_free(Try& a) noexcept {
  space_.unwind(a.pass.c);
  a.pass.c[2] = start_.c[2] + wrapped(a.pass.c[2] - start_.c[2]);
  if (limits_.mobile()) {
    const Vector2 to = (a.pass.c - start_.c).head<2>(), on = X_WN_.translation().head<2>() - a.pass.c.head<2>();
    a.pass.v.head<2>() = 0.5 * a.drive.speed * (to.normalized() + on.normalized());
  }
  if (!hold_hand(a.pass)) return false;
  a.arm = quick_glide(limits_, Moves::kArm, start_, a.pass, 0.0);
  if (limits_.mobile()) {
    a.base = quick_glide(limits_, Moves::kBase, start_, a.pass, a.arm.time);
    if (!(a.base.time < kInfinity)) return false;
    a.arm = quick_glide(limits_, Moves::kArm, start_, a.pass, a.base.time);
    if (a.arm.time != a.base.time) return false;
  }
  return a.arm.time < kInfinity;
}

// Gives the arm a part of the velocity at which the hand would stand while the base moves on (damped least squares): as
// little as makes the hand slow enough. A fixed arm moves on at what its hand may have. False if the hand is too quick.
bool PassingWay::hold_hand(MotionState& pass) noexcept {
  const DirectWayParams& p = params_.direct_way;
  const int joints = limits_.num_joints();
  Jacobian J(6, 3 + joints);
  free_jacobian(space_.place(pass.c), J);
  space_.charge(1);
  const auto arm = J.rightCols(joints);
  const auto factor = [&](const Vector6& V) {
    return std::max(V.head<3>().norm() / p.pass_angular, V.tail<3>().norm() / p.pass_linear);
  };
  auto v = pass.v.tail(joints);
  double most = 1.0;
  if (!limits_.mobile()) {
    v = 4.0 * (pass.c - start_.c).tail(joints);
    most = std::max(most, factor(arm * v));
  }
  const Vector6 V = J.leftCols<3>() * pass.v.head<3>();
  if (limits_.mobile()) {
    Eigen::Matrix<double, 6, 6> M = arm * arm.transpose();
    M.diagonal().array() += kPassDamping;
    v = -arm.transpose() * M.ldlt().solve(V);
  }
  for (int i = 0; i < joints; ++i) most = std::max(most, std::abs(v[i]) / (kMostJointSpeed * limits_.joint_speed[i]));
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

bool PassingWay::drive(const Try& a) noexcept {
  const bool reached = drive_.plan(limits_, start_.c.head<3>(), driving_speeds(start_), a.via, &a.drive);
  space_.charge(static_cast<long>(drive_.time() / SteeredDrive::kOfACheck));
  return reached;
}

// Estimates the base's time from there to the next goal.
double PassingWay::time_on(const MotionState& pass) noexcept {
  if (!limits_.mobile()) return 0.0;
  const Vector2 way = X_WN_.translation().head<2>() - pass.c.head<2>();
  const double length = std::max(0.0, way.norm() - kStand);
  if (limits_.base->lateral()) return length / limits_.linear;
  drive_.plan(limits_, pass.c.head<3>(), driving_speeds(pass), pass.c.head<2>() + length * way.normalized());
  space_.charge(static_cast<long>(drive_.time() / SteeredDrive::kOfACheck));
  return drive_.time();
}

const MotionState& PassingWay::lay(std::size_t index, Path& path, double& longest) noexcept {
  const Try& a = found_[index];
  path.origin = start_.c;
  path.count = 0;
  path.duration = 0.0;
  path.pass = kInfinity;
  path.clearance = space_.clearances().object;
  path.X_WG = X_WG_;
  longest = (a.pass.c - start_.c).cwiseAbs().tail(limits_.num_joints()).dot(limits_.lever);
  add_glide(Moves::kArm, a.arm, start_, a.pass, path);
  if (limits_.base->nonholonomic()) {
    drive(a);
    drive_.add_to(path);
    longest += drive_.way() + limits_.base_lever * drive_.turned();
  } else if (limits_.mobile()) {
    add_glide(Moves::kBase, a.base, start_, a.pass, path);
    const WholeConfiguration way = a.pass.c - start_.c;
    longest += way.head<2>().norm() + limits_.base_lever * std::abs(way[2]);
  }
  return a.pass;
}

}  // namespace moma
