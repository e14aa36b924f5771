#include "controller/plan/path.h"

#include <cmath>

namespace moma {
namespace {

enum class Kind { kTurn, kDrive, kArm };

// Motions of one plan; a path has room for the way on from its goal beside them.
constexpr int kMostPlanned = Path::kMostMotions / 2;

// Returns true if the accelerations of one motion's end and of the next one's beginning together stay within the
// limits.
bool may_overlap(const MotionLimits& limits, const PathPart& last, const Trapezoid& motion,
                 const WholeConfiguration& change) noexcept {
  if (last.motion.fall <= 0.0 || motion.rise <= 0.0) return false;
  constexpr double kRounding = 1.0 + 1e-9;
  const double falls = last.motion.peak() / last.motion.fall;
  const double rises = motion.peak() / motion.rise;
  const double x = rises * change[0] - falls * last.change[0], y = rises * change[1] - falls * last.change[1];
  if (std::hypot(x, y) > kRounding * limits.linear_acceleration) return false;
  if (std::abs(rises * change[2] - falls * last.change[2]) > kRounding * limits.angular_acceleration) return false;
  for (int i = 0; i < limits.num_joints(); ++i)
    if (std::abs(rises * change[3 + i] - falls * last.change[3 + i]) > kRounding * limits.joint_acceleration[i])
      return false;
  return true;
}

// Motions one after another.
class Layout {
 public:
  Layout(const MotionLimits& limits, double overlap, Path& path) : limits_(&limits), overlap_(overlap), path_(&path) {}

  double end() const noexcept { return end_; }
  bool full() const noexcept { return full_; }
  // The soonest for a motion of this kind, whatever others do. The last one's fall and this one's rise may overlap.
  double free_from(Kind kind, const Trapezoid& motion, const WholeConfiguration& change) const noexcept {
    const int last = last_[static_cast<std::size_t>(kind)];
    if (last < 0) return 0.0;
    const PathPart& before = path_->motions[static_cast<std::size_t>(last)];
    const double early = std::min({overlap_, before.motion.fall, motion.rise});
    return before.end() - (may_overlap(*limits_, before, motion, change) ? early : 0.0);
  }
  // When it begins as the successor of what ends last.
  double begin(Kind kind, const Trapezoid& motion, const WholeConfiguration& change) const noexcept {
    const double early = std::min(overlap_, 0.5 * std::min(end_time_, motion.time));
    return std::max({end_ - early, free_from(kind, motion, change), 0.0});
  }
  void put(Kind kind, double start, const Trapezoid& motion, const WholeConfiguration& change) noexcept {
    if (path_->count == kMostPlanned || !path_->add({start, motion, change})) {
      full_ = true;
      return;
    }
    last_[static_cast<std::size_t>(kind)] = path_->count - 1;
    if (start + motion.time < end_) return;
    end_ = start + motion.time;
    end_time_ = motion.time;
  }

  // The first motion, of all kinds, without a rise.
  void brake(double time, const WholeConfiguration& change) noexcept {
    path_->add({0.0, {time, 0.0, time}, change});
    last_.fill(0);
    end_ = time;
    end_time_ = 2.0 * time;  // all of it may overlap
  }

 private:
  const MotionLimits* limits_;
  double overlap_;
  Path* path_;
  double end_ = 0.0;       // of all so far
  double end_time_ = 0.0;  // how long the motion takes that ends there
  std::array<int, 3> last_{-1, -1, -1};
  bool full_ = false;
};

}  // namespace

void Path::at(double t, WholeConfiguration& c) const noexcept {
  c = origin;
  for (const PathPart& motion : parts()) {
    const double part = motion.motion.part(t - motion.start);
    if (part > 0.0) c += part * motion.change;
  }
}

void Path::velocity(double t, double h, WholeConfiguration& v) const noexcept {
  WholeConfiguration before;
  at(t - h, before);
  at(t + h, v);
  v = (v - before) / (2.0 * h);
}

void Path::begin(const WholeConfiguration& from) noexcept {
  origin = from;
  count = 0;
  duration = 0.0;
  pass = kInfinity;
}

bool Path::add(const PathPart& part) noexcept {
  if (count == kMostMotions) return false;
  motions[static_cast<std::size_t>(count++)] = part;
  return true;
}

bool Path::append(double t, const Path& on, const Isometry& X_WN_then) noexcept {
  const auto over = [t](const PathPart& part) { return part.end() <= t; };
  if (count - std::ranges::count_if(parts(), over) + on.count > kMostMotions) return false;
  for (const PathPart& part : parts())
    if (over(part)) origin += part.change;
  count -= static_cast<int>(std::ranges::remove_if(parts(), over).size());
  for (PathPart part : on.parts()) {
    part.start += duration;
    add(part);
  }
  pass = duration;
  X_WN = X_WN_then;
  duration += on.duration;
  clearance = std::min(clearance, on.clearance);
  return true;
}

void Path::begin_earlier(double time) noexcept {
  for (PathPart& part : parts()) {
    Trapezoid& motion = part.motion;
    if (part.start > 0.0 || motion.rise > 0.0 || motion.fall <= 0.0) {
      part.start += time;
      continue;
    }
    const WholeConfiguration before = time * motion.peak() * part.change;
    motion.time += time;
    part.change += before;
    origin -= before;
  }
  duration += time;
  pass += time;
}

bool lay_path(const MotionLimits& limits, std::span<const Edge> edges, double overlap, const Braking& braking,
              Path& path) noexcept {
  if (edges.empty()) return false;
  path.begin(braking.time > 0.0 ? braking.from : edges.front().a);
  const Eigen::Index joints = limits.num_joints();
  WholeConfiguration change = WholeConfiguration::Zero(3 + joints);
  Layout layout(limits, overlap, path);
  if (braking.time > 0.0) layout.brake(braking.time, edges.front().a - braking.from);
  for (const Edge& edge : edges) {
    // The slower of base and arm sets the speed.
    const double slower = edge.base_time() > 0.0 ? edge.time / edge.base_time() : 1.0;
    double first = -1.0;
    const auto base = [&](Kind kind, const Trapezoid& motion, const Vector3& by) {
      if (motion.time <= 0.0) return;
      const Trapezoid slow = motion.stretched(slower);
      change.setZero();
      change.head<3>() = by;
      const double start = layout.begin(kind, slow, change);
      layout.put(kind, start, slow, change);
      if (first < 0.0) first = start;
    };
    const Vector2 way = (edge.b - edge.a).head<2>();
    if (limits.base->nonholonomic()) {
      base(Kind::kTurn, edge.first, {0.0, 0.0, edge.turn1});
      base(Kind::kDrive, edge.middle, {way.x(), way.y(), 0.0});
      base(Kind::kTurn, edge.last, {0.0, 0.0, edge.turn2});
    } else if (limits.base->lateral()) {
      base(Kind::kDrive, edge.middle, {way.x(), way.y(), edge.turn1});
    }
    if (edge.arm.time <= 0.0) continue;
    change.setZero();
    change.tail(joints) = (edge.b - edge.a).tail(joints);
    const double start = first < 0.0 ? layout.begin(Kind::kArm, edge.arm, change)
                                     : std::max(first, layout.free_from(Kind::kArm, edge.arm, change));
    const double time = std::max(edge.arm.time, layout.end() - start);
    layout.put(Kind::kArm, start, edge.arm.stretched(time / edge.arm.time), change);
  }
  path.duration = layout.end();
  return !layout.full();
}

}  // namespace moma
