#include "controller/plan/smooth_path.h"

#include <algorithm>
#include <cmath>

#include "controller/plan/steered_drive.h"

namespace moma {
namespace {

constexpr int kMostSimulated = 1000;
constexpr int kStepsOfACheck = 20;                      // are simulated in the time of a check
constexpr int kTriangles = Path::kMostMotions / 2 - 2;  // a plan's motions, without those at its ends
constexpr double kThere = 0.003;                        // distance of what is reached [m, rad]
constexpr double kNoSteering = 0.05;                    // distance from which on the base does not steer any more [m]
constexpr double kAligned = 0.02;                       // turned to the next corner, after a stop [rad]
constexpr double kSlowest = 0.02;                       // speed up to a stop [m/s]
constexpr double kRest = 0.05;                          // velocities of a robot that has stopped [m/s, rad/s]

// Speed with which a motion stops within `room`, and does not overrun it in a step.
double slowing(double room, double deceleration) noexcept {
  return std::min(stopping(room, deceleration), room / kDriveStep);
}

}  // namespace

SmoothPath::SmoothPath(const MotionLimits& limits, const PlanParams& params, FreeSpace& space, const WholeBodyIk& ik)
    : limits_(limits), params_(params), space_(space), ik_(ik) {
  corners_.reserve(kMostCorners);
  best_.reserve(kMostCorners);
  const WholeConfiguration zero = WholeConfiguration::Zero(3 + limits.num_joints());
  moments_.reserve(kMostSimulated + 1);
  start_ = {zero, zero};
  arm_end_ = VectorX::Zero(limits.num_joints());
}

void SmoothPath::begin(std::span<const WholeConfiguration> corners, const Braking& braking, double within) noexcept {
  corners_.clear();
  best_.clear();
  stage_ = corners.size() > kMostCorners ? Stage::kFailed : Stage::kTry;
  if (stage_ == Stage::kFailed) return;
  for (const WholeConfiguration& c : corners) corners_.push_back({c});
  X_WE_ = space_.place(corners.back()).X_WE();
  braking_ = braking;
  start_.c = braking.time > 0.0 ? braking.from : corners.front();
  start_.v.setZero();
  if (braking.time > 0.0) start_.v = 2.0 / braking.time * (corners.front() - braking.from);
  within_ = limit_ = within;
  tries_ = 0;
  draws_ = {};
}

void SmoothPath::finish() noexcept {
  stage_ = best_.empty() || !(best_path_.duration < limit_) ? Stage::kFailed : Stage::kFound;
}

bool SmoothPath::work() noexcept {
  if (stage_ == Stage::kTry) {
    checked_ = 0.0;
    if (tries_++ >= params_.smooth.tries)
      finish();
    else if (!best_.empty())
      vary();
    else
      stage_ = aim() ? Stage::kCheck : Stage::kFailed;
    return stage_ == Stage::kTry || stage_ == Stage::kCheck;
  }
  if (stage_ != Stage::kCheck) return false;
  constexpr int kAtOnce = 16;
  WholeConfiguration before, c;
  path_.at(checked_, before);
  for (int k = 0; k < kAtOnce;) {
    checked_ = std::min(checked_ + kDriveStep, path_.duration);
    path_.at(checked_, c);
    if (limits_.travel(c - before) < params_.smooth.check * params_.check_step && checked_ < path_.duration) continue;
    ++k;
    before = c;
    if (!space_.free(c)) {
      stage_ = Stage::kTry;
      if (best_.empty()) tighten(checked_);
      return stage_ == Stage::kTry;
    }
    if (checked_ < path_.duration) continue;
    stage_ = Stage::kTry;
    best_ = corners_;
    best_path_ = path_;
    within_ = path_.duration - params_.smooth.gain;
    return true;
  }
  return true;
}

// Lets the robot pass one of the two corners that it is between later: the nearer one in time, if that is possible.
void SmoothPath::tighten(double t) noexcept {
  const int i = std::clamp(static_cast<int>(t / kDriveStep), 1, steps());
  const auto target = [&](int step) { return moments_[static_cast<std::size_t>(step)].target; };
  const int next = target(i);
  int first = i, last = i;
  while (first > 1 && target(first - 1) == next) --first;
  while (last < steps() && target(last + 1) == next) ++last;
  Corner& before = corners_[static_cast<std::size_t>(next - 1)];
  Corner& after = corners_[static_cast<std::size_t>(next)];
  const int most = &after == &corners_.back() ? kLate : kStop;
  if ((i - first < last - i || after.passing >= most) && before.passing < kStop)
    ++before.passing;
  else if (after.passing < most)
    ++after.passing;
  else
    stage_ = Stage::kFailed;
}

// Leaves out a corner of the best path, or passes it sooner.
void SmoothPath::vary() noexcept {
  corners_ = best_;
  const std::size_t n = corners_.size(), k = draws_.choice(n);
  const bool inner = k > 0 && k + 1 < n;
  if (inner && (corners_[k].passing == kEarly || draws_.uniform() < params_.smooth.leave_out)) {
    corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(k));
    if (draws_.uniform() < 0.5) corners_[k - 1].passing = kEarly;
  } else if (corners_[k].passing > kEarly) {
    --corners_[k].passing;
  } else {
    return;
  }
  if (aim()) stage_ = Stage::kCheck;
}

// Simulates the motion, and makes the path of it that ends with E at the goal. If the arm does not reach the goal from
// where the base stops, the base comes nearer to the end's own configuration.
bool SmoothPath::aim() noexcept {
  Corner& last = corners_.back();
  Corner& before = corners_[corners_.size() - 2];
  const Eigen::Index joints = limits_.num_joints();
  const double most = best_.empty() ? params_.smooth.slower * within_ : within_;
  while (true) {
    arm_end_ = last.c.tail(joints);
    bool reached = true;
    for (const double aside : {params_.smooth.aside, params_.smooth.aside_last}) {
      if (!simulate() || !(steps() * kDriveStep < most)) return false;
      WholeConfiguration c = at_;
      c.tail(joints) = arm_end_;
      reached = ik_.solve(space_, X_WE_, c, false);
      if (!reached) break;
      space_.unwind(c);
      reached = (c.tail(joints) - arm_end_).lpNorm<Eigen::Infinity>() < aside;
      if (!reached) break;
      arm_end_ = c.tail(joints);
    }
    if (reached) {
      lay();
      return true;
    }
    if (last.passing == kEarly && limits_.base->nonholonomic())
      last.passing = kLate;
    else if (before.passing < kStop)
      before.passing = kStop;
    else
      return false;
  }
}

bool SmoothPath::simulate() noexcept {
  moments_.clear();
  at_ = start_.c;
  target_ = 0;
  log();
  u_ = start_.v;
  if (limits_.base->nonholonomic()) {
    const Vector2 v = driving_speeds(start_);
    u_.head<3>() << v[0], 0.0, v[1];
  }
  turned_ = corners_.front().passing < kStop;
  bool goes = turned_ || brake();
  for (std::size_t next = 1; goes && next < corners_.size(); ++next) {
    const Corner& to = corners_[next];
    const bool last = next + 1 == corners_.size(), stops = last || to.passing == kStop;
    const bool turns = stops && to.passing > kEarly;
    const double lead = to.passing == kEarly ? params_.smooth.early : params_.smooth.late;
    WholeConfiguration c = to.c;
    if (last) c.tail(limits_.num_joints()) = arm_end_;
    target_ = static_cast<int>(next);
    direction_ = 0.0;
    base_there_ = false;
    if (turns && !turned_) {
      goes = follow_edge(c);
    } else {
      while (goes) {
        const ToGo rest = to_go(c);
        if (stops ? arrived(rest, turns) : std::max(rest.base, rest.arm) <= lead) break;
        pursue(rest, c, stops, turns);
        goes = log();
      }
    }
    turned_ = !stops;
    if (stops) u_.setZero();
  }
  space_.charge(1 + steps() / kStepsOfACheck);
  return goes && steps() > 0;
}

// Adds the robot's place to the motion. False if it cannot hold more.
bool SmoothPath::log() noexcept {
  if (steps() == kMostSimulated) return false;
  moments_.push_back({at_, target_});
  return true;
}

// Adds a motion of `time` seconds in even steps; `place` sets at_ to where it is at a time.
template <class Place>
bool SmoothPath::play(double time, const Place& place) noexcept {
  const int steps = static_cast<int>(std::ceil(time / kDriveStep));
  for (int i = 1; i <= steps; ++i) {
    place(time * i / steps);
    if (!log()) return false;
  }
  return true;
}

bool SmoothPath::brake() noexcept {
  const Trapezoid fall{braking_.time, 0.0, braking_.time};
  target_ = 1;
  u_.setZero();
  return play(braking_.time, [&](double t) { at_ = start_.c + fall.part(t) * (corners_.front().c - start_.c); });
}

bool SmoothPath::follow_edge(const WholeConfiguration& end) noexcept {
  make_edge(limits_, at_, end, edge_);
  return play(edge_.time, [&](double t) { edge_at(limits_, edge_, t, at_); });
}

SmoothPath::ToGo SmoothPath::to_go(const WholeConfiguration& c) noexcept {
  ToGo rest;
  rest.way = (c - at_).head<2>();
  rest.distance = rest.way.norm();
  rest.off = wrapped(c[2] - at_[2]);
  for (int i = 0; i < limits_.num_joints(); ++i) {
    const double e = std::abs(c[3 + i] - at_[3 + i]);
    rest.farthest = std::max(rest.farthest, e);
    rest.arm = std::max(rest.arm, e / limits_.joint_speed[i]);
  }
  if (!limits_.base->nonholonomic()) {
    rest.base = std::max(rest.distance / limits_.linear, std::abs(rest.off) / limits_.angular);
    base_there_ = rest.distance < kThere && std::abs(rest.off) < kThere;
    return rest;
  }
  const double cs = std::cos(at_[2]), sn = std::sin(at_[2]);
  const double forwards = cs * rest.way.x() + sn * rest.way.y();
  if (direction_ == 0.0) direction_ = limits_.drives_backwards(forwards, rest.distance) ? -1.0 : 1.0;
  const double along = direction_ * forwards;
  const bool beside = along <= 0.5 * rest.distance;
  base_there_ =
      base_there_ || rest.distance < kThere ||
      (beside && (rest.distance < kNoSteering ||
                  (rest.distance < params_.smooth.past && std::abs(u_[2]) > params_.smooth.turning * limits_.angular)));
  if (base_there_) return rest;
  rest.off = std::atan2(direction_ * (cs * rest.way.y() - sn * rest.way.x()), along);
  rest.base = rest.distance / limits_.linear;
  return rest;
}

bool SmoothPath::arrived(const ToGo& rest, bool turns) const noexcept {
  return base_there_ && rest.farthest < kThere && u_.lpNorm<Eigen::Infinity>() < kRest &&
         (!turns || std::abs(rest.off) < kThere);
}

// Moves the robot for a step.
void SmoothPath::pursue(const ToGo& rest, const WholeConfiguration& c, bool stops, bool turns) noexcept {
  const int joints = limits_.num_joints();
  const double off = std::abs(rest.off);
  const WholeConfiguration before = u_;
  double time = std::max(kDriveStep, rest.arm), v = 0.0, omega = 0.0;
  if (!limits_.base->nonholonomic()) {
    time = std::max(time, rest.base);
    double rate = 1.0 / time;
    if (stops && rest.distance > 0.0)
      rate = std::min(rate, slowing(rest.distance, limits_.linear_acceleration) / rest.distance);
    if (stops && off > 0.0) rate = std::min(rate, slowing(off, limits_.angular_acceleration) / off);
    Vector2 by = rate * rest.way - u_.head<2>();
    by *= std::min(1.0, limits_.linear_acceleration * kDriveStep / std::max(by.norm(), 1e-12));
    u_.head<2>() += by;
    u_[2] = ramped(u_[2], rate * rest.off, limits_.angular_acceleration);
  } else {
    if (!base_there_) {
      turned_ = turned_ || off < kAligned;
      if (turned_)
        v = std::max(0.0, std::cos(off)) * std::min(limits_.linear, rest.distance / std::max(time, rest.base));
      if (stops) v = std::min(v, std::max(kSlowest, slowing(rest.distance, limits_.linear_acceleration)));
      time = std::max(time, rest.base + off / limits_.angular);
    } else if (turns) {
      time = std::max(time, off / limits_.angular);
    }
    if (base_there_ ? turns : rest.distance > kNoSteering)
      omega = std::copysign(std::min(limits_.angular, slowing(off, limits_.angular_acceleration)), rest.off);
    u_[2] = ramped(u_[2], omega, limits_.angular_acceleration);
    v = std::min(v, std::max(0.0, limits_.rim_speed - limits_.half_track * std::abs(u_[2])));
    u_[0] = ramped(u_[0], direction_ * v, limits_.linear_acceleration);
  }
  double rate = 1.0 / time;
  for (int i = 0; stops && i < joints; ++i) {
    const double e = std::abs(c[3 + i] - at_[3 + i]);
    if (e > 0.0) rate = std::min(rate, slowing(e, limits_.joint_acceleration[i]) / e);
  }
  for (int i = 0; i < joints; ++i)
    u_[3 + i] = ramped(u_[3 + i], rate * (c[3 + i] - at_[3 + i]), limits_.joint_acceleration[i]);
  WholeConfiguration way = 0.5 * kDriveStep * (before + u_);
  if (limits_.base->nonholonomic()) {
    const double middle = at_[2] + 0.5 * way[2];
    way.head<2>() = way[0] * Vector2(std::cos(middle), std::sin(middle));
  }
  at_ += way;
}

// Makes triangles of the motion between even times: each leads on as far as the motion does in the middle half of its
// time, so that no error adds up and none exceeds an acceleration. What the ends leave is spread over the whole time.
void SmoothPath::lay() noexcept {
  const double time = steps() * kDriveStep, spacing = time / (kTriangles + 1);
  const auto place = [&](double t) -> WholeConfiguration {
    const double step = t / kDriveStep;
    const auto k = std::min(static_cast<std::size_t>(step), moments_.size() - 2);
    return moments_[k].c + (step - static_cast<double>(k)) * (moments_[k + 1].c - moments_[k].c);
  };
  WholeConfiguration left = moments_.back().c - start_.c, before = place(0.5 * spacing), next;
  left.tail(limits_.num_joints()) = arm_end_ - start_.c.tail(limits_.num_joints());
  path_.begin(start_.c);
  path_.duration = time;
  const auto add = [&](const PathPart& part) {
    path_.add(part);
    left -= part.change;
  };
  if (start_.moves()) add({0.0, {spacing, 0.0, spacing}, 0.5 * spacing * start_.v});
  for (int i = 1; i <= kTriangles; ++i) {
    next = place((i + 0.5) * spacing);
    add({(i - 1) * spacing, {2.0 * spacing, spacing, spacing}, next - before});
    before = next;
  }
  path_.add({0.0, {time, 0.5 * time, 0.5 * time}, left});
}

}  // namespace moma
