#include "world/scenario/walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "controller/model/analytic_distance.h"

namespace moma {
namespace {

constexpr int kLegTries = 20;
constexpr double kLeastStay = 1e-3;  // shorter stops are left out [s]

/// Draws within the range, including the tails of the defaults.
double sample_within(const Range& range, const Distribution& value, Draws& draws) {
  return std::clamp(value.sample(draws), range.low, range.high);
}

Vector3 way_point(Draws& draws, const Way& way, double margin) {
  const double along = draws.uniform(-margin, way.length + margin);
  return way.from + along * way.forward + draws.uniform(-margin, margin) * way.left();
}

/// The point of a leg's line nearest to the circles, in the plane.
struct Passing {
  double gap = std::numeric_limits<double>::infinity();  ///< negative inside a circle
  double part = 0.0;                                     ///< share of the leg
};

Passing nearest_passing(const std::vector<Vector3>& circles, const Vector3& from, const Vector3& to) {
  const Vector2 a = from.head<2>();
  const Vector2 leg = (to - from).head<2>();
  Passing out;
  for (const Vector3& circle : circles) {
    const Vector2 center = circle.head<2>();
    const double part = std::clamp(leg.dot(center - a) / leg.squaredNorm(), 0.0, 1.0);
    const double gap = (a + part * leg - center).norm() - circle.z();
    if (gap < out.gap) out = {gap, part};
  }
  return out;
}

/// True if an upright solid on the floor keeps off upright boxes, except those above it, on the leg of its centre.
bool keeps_off(std::span<const WorldObject> boxes, double reach, const Vector3& from, const Vector3& to) {
  constexpr double kStep = 0.05;  // between two looks [m]
  const int parts = static_cast<int>(std::ceil((to - from).head<2>().norm() / kStep));
  for (const WorldObject& box : boxes) {
    if (box.X_WO.translation().z() - 0.5 * box.shape.size.z() > 2.0 * from.z()) continue;
    for (int k = 0; k <= parts; ++k) {
      Vector3 p = from + k / std::max(1.0, static_cast<double>(parts)) * (to - from);
      p.z() = box.X_WO.translation().z();
      if (point_gap(box.shape, box.X_WO.inverse() * p) < reach + kStep) return false;
    }
  }
  return true;
}

/// Returns an object's reach from its centre, in the plane.
double level_reach(const WorldObject& object, bool upright) {
  return upright ? object.shape.size.x() : bounding_radius(object.shape);
}

/// Returns the duration of the leg if it is clear of start and witness all the way, else a negative number. A leg that
/// passes `circles` at a distance needs no further check; most others fail at their nearest point.
double clear_leg(SceneBuilder& builder, const std::vector<Vector3>& circles, double reach, WorldObject object,
                 const Vector3& from, const Vector3& to, double speed) {
  const double time = (to - from).norm() / speed;
  const double clearance = builder.clearance() + speed * SceneBuilder::kTimeStep;
  const Passing passing = nearest_passing(circles, from, to);
  if (passing.gap - reach > clearance) return time;
  object.motion = StaticMotion{};
  set_pose(object, from + passing.part * (to - from), object.file_rotation);
  if (!builder.stands_clear(object, clearance)) return -1.0;
  set_pose(object, from, object.file_rotation);
  LinearMotion straight;
  straight.V_W.tail<3>() = (to - from) / time;
  object.motion = straight;
  return builder.clear_for(object, speed, time, clearance) ? time : -1.0;
}

}  // namespace

bool Walk::sample(SceneBuilder& builder, const Way& way, const ObjectMix& mix, double horizon, std::uint64_t item,
                  WorldObject& object, const Inside& inside) const {
  Draws draws = builder.draws(Stream::kMotion, item);
  const double pace = sample_within(kPace, speed, draws);
  const double r = sample_within(kSize, radius, draws);
  const double total = sample_within(kSize, height, draws);
  const Vector3 first = way_point(draws, way, margin);
  const bool people = walker == Walker::kPerson;
  if (people) {
    object.shape.kind = ShapeKind::kCapsule;
    object.shape.size = {r, std::max(total - 2.0 * r, 1e-3), 0.0};
    set_pose(object, {first.x(), first.y(), r + 0.5 * object.shape.size.y()}, Eigen::Quaterniond::Identity());
  } else {
    Draws solid = builder.draws(Stream::kObjects, item);
    mix.sample(solid, first.x(), first.y(), object);
  }

  const std::vector<Vector3> circles = builder.footprints();
  const double reach = level_reach(object, people);
  if (!keeps_off(inside.solids, reach, object.X_WO.translation(), object.X_WO.translation())) return false;
  PathMotion path;
  path.times = {0.0};
  path.positions = {object.X_WO.translation()};
  Vector3 before = path.positions.front();  // the waypoint before
  while (path.times.back() < horizon) {
    const Vector3 at = path.positions.back();
    Vector3 to = before;
    double time = -1.0;
    for (int k = 0; k < kLegTries && time < 0.0; ++k) {
      const bool door = !inside.doors.empty() && draws.uniform() < 0.5;
      to = door ? inside.doors[draws.choice(inside.doors.size())] : way_point(draws, way, margin);
      to.z() = at.z();
      if ((to - at).norm() >= kLeastLeg && keeps_off(inside.solids, reach, at, to))
        time = clear_leg(builder, circles, reach, object, at, to, pace);
    }
    if (time < 0.0) {  // blocked: back to the waypoint before
      if (path.times.size() == 1) return false;
      to = before;
      time = (to - at).norm() / pace;
    }
    const bool stops = draws.uniform() < pause;
    const double stays = pause_time.sample(draws);
    path.times.push_back(path.times.back() + time);
    path.positions.push_back(to);
    if (stops && stays >= kLeastStay) {
      path.times.push_back(path.times.back() + stays);
      path.positions.push_back(to);
    }
    before = at;
  }
  object.motion = std::move(path);
  object.yields = yields;
  return true;
}

}  // namespace moma
