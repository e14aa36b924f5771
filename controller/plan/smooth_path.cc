#include "controller/plan/smooth_path.h"

#include <algorithm>
#include <cmath>

#include "controller/plan/steered_drive.h"

namespace moma {
namespace {

constexpr int kMostSimulated = 1000;
constexpr int kStepsOfACheck = 20;                      // are simulated in the time of a check
constexpr int kTriangles = Path::kMostMotions / 2 - 2;  // a plan's motions, without those at its ends
constexpr double kReached = 0.003;                      // distance of what is reached [m, rad]
constexpr double kNoSteering = 0.05;                    // distance from which on the base does not steer any more [m]
constexpr double kAligned = 0.02;                       // turned to the next corner, after a stop [rad]
constexpr double kSlowest = 0.02;                       // speed up to a stop [m/s]
constexpr double kRest = 0.03;                          // velocities of a robot that has stopped [m/s, rad/s]

// Speed with which a motion stops within `room`, and does not overrun it in a step.
double slowing(double room, double deceleration) noexcept {
  return std::min(stopping(room, deceleration), room / kDriveStep);
}

}  // namespace

SmoothPath::SmoothPath(const MotionLimits& limits, const PlanParams& params, FreeSpace& space, const WholeBodyIk& ik)
    : limits_(limits), params_(params), space_(space), ik_(ik) {
  const WholeConfiguration zero = WholeConfiguration::Zero(3 + limits.num_joints());
  for (Motion* motion : {&now_, &best_}) {
    motion->corners.reserve(kMostCorners);
    motion->legs.resize(kMostCorners);
    motion->moments.reserve(kMostSimulated + 1);
  }
  start_ = {zero, zero};
  arm_end_ = VectorX::Zero(limits.num_joints());
}

void SmoothPath::begin(std::span<const WholeConfiguration> corners, const Braking& braking, double within) noexcept {
  now_.corners.clear();
  best_.corners.clear();
  stage_ = corners.size() > kMostCorners ? Stage::kFailed : Stage::kTry;
  if (stage_ == Stage::kFailed) return;
  for (const WholeConfiguration& c : corners) now_.corners.push_back({c});
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
  stage_ = best_.corners.empty() || !(best_.path.duration < limit_) ? Stage::kFailed : Stage::kFound;
}

bool SmoothPath::work() noexcept {
  if (stage_ == Stage::kTry) {
    const bool first = best_.corners.empty();
    if (tries_++ >= (start_.moves() ? params_.smooth.tries_moving : params_.smooth.tries))
      finish();
    else if (const std::size_t leg = first ? 1 : vary(); leg > 0 && aim(leg))
      stage_ = Stage::kCheck;
    else if (first)
      stage_ = Stage::kFailed;
    return stage_ == Stage::kTry || stage_ == Stage::kCheck;
  }
  if (stage_ != Stage::kCheck) return false;
  constexpr int kAtOnce = 16;
  const double end = now_.path.duration, all = from_ + end;
  const auto moment = [&](WholeConfiguration& c) { now_.path.at(checked_ > end ? checked_ - end : checked_, c); };
  WholeConfiguration before, c;
  moment(before);
  for (int k = 0; k < kAtOnce;) {
    checked_ = std::min(checked_ + kDriveStep, checked_ < end ? end : all);
    moment(c);
    const bool last = checked_ == end || checked_ == all;
    if (limits_.travel(c - before) < params_.smooth.check * params_.check_step && !last) continue;
    ++k;
    before = c;
    if (!space_.free(c)) {
      stage_ = Stage::kTry;
      if (best_.corners.empty()) tighten(checked_);
      return stage_ == Stage::kTry;
    }
    if (checked_ < all) continue;
    stage_ = Stage::kTry;
    best_ = now_;
    within_ = end - params_.smooth.gain;
    return true;
  }
  return true;
}

// At time t the robot is between two corners. Lets it pass one of them later, by one step of Passing: the nearer one in
// time, or the other one if the nearer one cannot be passed later.
void SmoothPath::tighten(double t) noexcept {
  const int i = std::clamp(static_cast<int>(t / kDriveStep), 1, steps());
  const auto target = [&](int step) { return now_.moments[static_cast<std::size_t>(step)].target; };
  const int next = target(i);
  int first = i, last = i;
  while (first > 1 && target(first - 1) == next) --first;
  while (last < steps() && target(last + 1) == next) ++last;
  Corner& before = now_.corners[static_cast<std::size_t>(next - 1)];
  Corner& after = now_.corners[static_cast<std::size_t>(next)];
  const int most = &after == &now_.corners.back() ? kLate : kStop;
  if ((i - first < last - i || after.passing >= most) && before.passing < kStop)
    ++before.passing;
  else if (after.passing < most)
    ++after.passing;
  else
    stage_ = Stage::kFailed;
}

// Makes now_ of the best motion: leaves out one of its corners, moves it, or passes it sooner. Returns the first leg
// that differs, or 0 if none does.
std::size_t SmoothPath::vary() noexcept {
  now_.corners = best_.corners;
  std::vector<Corner>& corners = now_.corners;
  const std::size_t n = corners.size(), k = draws_.choice(n);
  const bool inner = k > 0 && k + 1 < n;
  if (k > 0 && draws_.uniform() < params_.smooth.moves) {
    move(k);
  } else if (inner && (corners[k].passing == kEarly || draws_.uniform() < params_.smooth.leave_out)) {
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(k));
    if (draws_.uniform() < 0.5) corners[k - 1].passing = kEarly;
    return std::max<std::size_t>(k - 1, 1);
  } else if (corners[k].passing > kEarly) {
    --corners[k].passing;
  } else {
    return 0;
  }
  return std::max<std::size_t>(k, 1);
}

// Moves the base's place at a corner. The arm at it takes on some of what it has at a corner beside it.
void SmoothPath::move(std::size_t corner) noexcept {
  Corner& moved = now_.corners[corner];
  const double most = params_.smooth.farthest * draws_.uniform();
  for (int i = 0; i < 2; ++i) moved.c[i] += draws_.uniform(-most, most);
  if (corner + 1 == now_.corners.size()) return;
  const Eigen::Index joints = limits_.num_joints();
  const double part = draws_.uniform(0.0, params_.smooth.takes_on);
  const Corner& other = now_.corners[draws_.uniform() < 0.5 ? corner - 1 : corner + 1];
  moved.c.tail(joints) += part * (other.c - moved.c).tail(joints);
  if (draws_.uniform() < 0.5 && moved.passing > kEarly) --moved.passing;
}

// Simulates the motion from a leg on, and makes the path of it that ends with E at the goal. If the arm does not reach
// the goal from where the base stops, the base comes nearer to the end's own configuration.
bool SmoothPath::aim(std::size_t leg) noexcept {
  Corner& last = now_.corners.back();
  Corner& before = now_.corners[now_.corners.size() - 2];
  const Eigen::Index joints = limits_.num_joints();
  const double most = best_.corners.empty() ? params_.smooth.slower * within_ : within_;
  resume(leg);
  while (true) {
    arm_end_ = last.c.tail(joints);
    bool reached = true;
    for (const double aside : {params_.smooth.aside, params_.smooth.aside_last}) {
      if (!simulate(leg) || !(steps() * kDriveStep < most)) return false;
      WholeConfiguration c = robot_.at;
      c.tail(joints) = arm_end_;
      reached = ik_.solve(space_, X_WE_, c, false);
      if (!reached) break;
      space_.unwind(c);
      reached = (c.tail(joints) - arm_end_).lpNorm<Eigen::Infinity>() < aside;
      if (!reached) break;
      arm_end_ = c.tail(joints);
      leg = now_.corners.size() - 1;
    }
    if (reached) {
      lay();
      return true;
    }
    if (last.passing == kEarly && limits_.base->nonholonomic()) {
      last.passing = kLate;
      leg = now_.corners.size() - 1;
    } else if (before.passing < kStop) {
      before.passing = kStop;
      leg = std::max<std::size_t>(now_.corners.size() - 2, 1);
    } else {
      return false;
    }
  }
}

// Goes on from the best motion, as far as that is the same.
void SmoothPath::resume(std::size_t leg) noexcept {
  checked_ = from_ = 0.0;
  if (leg < 2) return;
  const int steps = best_.legs[leg].steps;
  checked_ = from_ = steps * kDriveStep;
  std::copy_n(best_.legs.begin(), leg + 1, now_.legs.begin());
  now_.moments.assign(best_.moments.begin(), best_.moments.begin() + steps + 1);
}

bool SmoothPath::simulate(std::size_t leg) noexcept {
  bool goes = true;
  if (leg < 2) {
    now_.moments.clear();
    robot_ = {start_.c, start_.v, now_.corners.front().passing < kStop};
    if (limits_.base->nonholonomic()) {
      const Vector2 v = driving_speeds(start_);
      robot_.u.head<3>() << v[0], 0.0, v[1];
    }
    target_ = 0;
    log();
    goes = robot_.turned || brake();
  } else {
    robot_ = now_.legs[leg];
    now_.moments.resize(static_cast<std::size_t>(robot_.steps) + 1);
  }
  const int before = steps();
  for (std::size_t next = leg; goes && next < now_.corners.size(); ++next) {
    robot_.steps = steps();
    now_.legs[next] = robot_;
    const Corner& to = now_.corners[next];
    const bool last = next + 1 == now_.corners.size(), stops = last || to.passing == kStop;
    const bool turns = stops && to.passing > kEarly;
    const double lead = to.passing == kEarly ? params_.smooth.early : params_.smooth.late;
    WholeConfiguration c = to.c;
    if (last) c.tail(limits_.num_joints()) = arm_end_;
    target_ = static_cast<int>(next);
    direction_ = 0.0;
    base_there_ = false;
    if (turns && !robot_.turned) {
      goes = follow_edge(c);
    } else {
      while (goes) {
        const ToGo rest = to_go(c);
        if (stops ? arrived(rest, turns) : std::max(rest.base, rest.arm) <= lead) break;
        pursue(rest, c, stops, turns);
        goes = log();
      }
    }
    robot_.turned = !stops;
    if (stops) robot_.u.setZero();
  }
  space_.charge(1 + (steps() - before) / kStepsOfACheck);
  return goes && steps() > 0;
}

// Adds the robot's place to the motion. False if it cannot hold more.
bool SmoothPath::log() noexcept {
  if (steps() == kMostSimulated) return false;
  now_.moments.push_back({robot_.at, target_});
  return true;
}

// Adds a motion of `time` seconds in even steps; `place` sets its place to where it is at a time.
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
  robot_.u.setZero();
  return play(braking_.time,
              [&](double t) { robot_.at = start_.c + fall.part(t) * (now_.corners.front().c - start_.c); });
}

bool SmoothPath::follow_edge(const WholeConfiguration& end) noexcept {
  make_edge(limits_, robot_.at, end, edge_);
  return play(edge_.time, [&](double t) { edge_at(limits_, edge_, t, robot_.at); });
}

SmoothPath::ToGo SmoothPath::to_go(const WholeConfiguration& c) noexcept {
  ToGo rest;
  rest.way = (c - robot_.at).head<2>();
  rest.distance = rest.way.norm();
  rest.off = wrapped(c[2] - robot_.at[2]);
  for (int i = 0; i < limits_.num_joints(); ++i) {
    const double e = std::abs(c[3 + i] - robot_.at[3 + i]);
    rest.farthest = std::max(rest.farthest, e);
    rest.arm = std::max(rest.arm, e / limits_.joint_speed[i]);
  }
  if (!limits_.base->nonholonomic()) {
    rest.base = std::max(rest.distance / limits_.linear, std::abs(rest.off) / limits_.angular);
    base_there_ = rest.distance < kReached && std::abs(rest.off) < kReached;
    return rest;
  }
  const double cs = std::cos(robot_.at[2]), sn = std::sin(robot_.at[2]);
  const double forwards = cs * rest.way.x() + sn * rest.way.y();
  if (direction_ == 0.0) direction_ = limits_.drives_backwards(forwards, rest.distance) ? -1.0 : 1.0;
  const double along = direction_ * forwards;
  const bool beside = along <= 0.5 * rest.distance;
  base_there_ =
      base_there_ || rest.distance < kReached ||
      (beside && (rest.distance < kNoSteering || (rest.distance < params_.smooth.past &&
                                                  std::abs(robot_.u[2]) > params_.smooth.turning * limits_.angular)));
  if (base_there_) return rest;
  rest.off = std::atan2(direction_ * (cs * rest.way.y() - sn * rest.way.x()), along);
  rest.ahead = along / rest.distance;
  rest.base = rest.distance / limits_.linear;
  return rest;
}

bool SmoothPath::arrived(const ToGo& rest, bool turns) const noexcept {
  return base_there_ && rest.farthest < kReached && robot_.u.lpNorm<Eigen::Infinity>() < kRest &&
         (!turns || std::abs(rest.off) < kReached);
}

// Moves the robot for a step.
void SmoothPath::pursue(const ToGo& rest, const WholeConfiguration& c, bool stops, bool turns) noexcept {
  const int joints = limits_.num_joints();
  const double off = std::abs(rest.off);
  const WholeConfiguration before = robot_.u;
  double time = std::max(kDriveStep, rest.arm), v = 0.0, omega = 0.0;
  if (!limits_.base->nonholonomic()) {
    time = std::max(time, rest.base);
    double rate = 1.0 / time;
    if (stops && rest.distance > 0.0)
      rate = std::min(rate, slowing(rest.distance, limits_.linear_acceleration) / rest.distance);
    if (stops && off > 0.0) rate = std::min(rate, slowing(off, limits_.angular_acceleration) / off);
    Vector2 by = rate * rest.way - robot_.u.head<2>();
    by *= std::min(1.0, limits_.linear_acceleration * kDriveStep / std::max(by.norm(), 1e-12));
    robot_.u.head<2>() += by;
    robot_.u[2] = ramped(robot_.u[2], rate * rest.off, limits_.angular_acceleration);
  } else {
    if (!base_there_) {
      robot_.turned = robot_.turned || off < kAligned;
      if (robot_.turned)
        v = std::max(0.0, rest.ahead) * std::min(limits_.linear, rest.distance / std::max(time, rest.base));
      if (stops) v = std::min(v, std::max(kSlowest, slowing(rest.distance, limits_.linear_acceleration)));
      time = std::max(time, rest.base + off / limits_.angular);
    } else if (turns) {
      time = std::max(time, off / limits_.angular);
    }
    if (base_there_ ? turns : rest.distance > kNoSteering)
      omega = std::copysign(std::min(limits_.angular, slowing(off, limits_.angular_acceleration)), rest.off);
    robot_.u[2] = ramped(robot_.u[2], omega, limits_.angular_acceleration);
    v = std::min(v, std::max(0.0, limits_.rim_speed - limits_.half_track * std::abs(robot_.u[2])));
    robot_.u[0] = ramped(robot_.u[0], direction_ * v, limits_.linear_acceleration);
  }
  double rate = 1.0 / time;
  for (int i = 0; stops && i < joints; ++i) {
    const double e = std::abs(c[3 + i] - robot_.at[3 + i]);
    if (e > 0.0) rate = std::min(rate, slowing(e, limits_.joint_acceleration[i]) / e);
  }
  for (int i = 0; i < joints; ++i)
    robot_.u[3 + i] = ramped(robot_.u[3 + i], rate * (c[3 + i] - robot_.at[3 + i]), limits_.joint_acceleration[i]);
  WholeConfiguration way = 0.5 * kDriveStep * (before + robot_.u);
  if (limits_.base->nonholonomic()) {
    const double middle = robot_.at[2] + 0.5 * way[2];
    way.head<2>() = way[0] * Vector2(std::cos(middle), std::sin(middle));
  }
  robot_.at += way;
}

// Approximates the motion by overlapping triangles of velocity at even times. Each triangle covers the motion's change
// in the middle half of its time, so that errors do not add up and no acceleration is exceeded. One triangle over the
// whole time takes up what remains at the ends. Triangles closer than two steps would have the steps' own changes.
void SmoothPath::lay() noexcept {
  const int triangles = std::clamp(steps() / 2 - 1, 1, kTriangles);
  const double time = steps() * kDriveStep, spacing = time / (triangles + 1);
  const auto place = [&](double t) -> WholeConfiguration {
    const double step = t / kDriveStep;
    const auto k = std::min(static_cast<std::size_t>(step), now_.moments.size() - 2);
    return now_.moments[k].c + (step - static_cast<double>(k)) * (now_.moments[k + 1].c - now_.moments[k].c);
  };
  WholeConfiguration left = now_.moments.back().c - start_.c, before = place(0.5 * spacing), next;
  left.tail(limits_.num_joints()) = arm_end_ - start_.c.tail(limits_.num_joints());
  now_.path.begin(start_.c);
  now_.path.duration = time;
  const auto add = [&](const PathPart& part) {
    now_.path.add(part);
    left -= part.change;
  };
  if (start_.moves()) add({0.0, {spacing, 0.0, spacing}, 0.5 * spacing * start_.v});
  for (int i = 1; i <= triangles; ++i) {
    next = place((i + 0.5) * spacing);
    add({(i - 1) * spacing, {2.0 * spacing, spacing, spacing}, next - before});
    before = next;
  }
  now_.path.add({0.0, {time, 0.5 * time, 0.5 * time}, left});
}

}  // namespace moma
