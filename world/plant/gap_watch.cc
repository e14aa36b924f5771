#include "world/plant/gap_watch.h"

#include <algorithm>
#include <cmath>

#include "controller/model/robot_model.h"

namespace moma {
namespace {

// Smaller gaps count as possible contacts: the detectors differ by that much, and a path between two states deviates
// that far from a straight line [m].
constexpr double kUncertain = 1e-4;
// A path may be longer than the distance of its ends: an arc of half a radian by 1 %.
constexpr double kBend = 1.01;
// Bounding spheres this far apart need no distance of their contents [m].
constexpr double kFar = 0.1;

/// Number of vertices of the largest hull.
int most_vertices(const std::vector<Solid>& solids) {
  std::size_t most = 0;
  for (const Solid& solid : solids)
    if (solid.shape.hull) most = std::max(most, solid.shape.hull->vertices.size());
  return static_cast<int>(most);
}

double way(const Isometry& from, const Isometry& to, double radius) { return kBend * moved(from, to, radius); }

double way_in_height(const Isometry& from, const Isometry& to, double radius) {
  return kBend * (std::abs(to.translation().z() - from.translation().z()) +
                  radius * (to.linear().row(2) - from.linear().row(2)).norm());
}

}  // namespace

GapWatch::GapWatch(const RobotModel& model, const World& world, const std::vector<bool>& meets_floor)
    : shapes_(solids_of(model)),
      objects_(solids_of(world)),
      coal_(std::max(most_vertices(shapes_), most_vertices(objects_))),
      way_(3 * shapes_.size() + objects_.size() + 1),
      step_(way_.size()),
      last_X_BS_(shapes_.size()),
      last_X_WO_(objects_.size()) {
  const std::size_t n = shapes_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int shape = static_cast<int>(i);
    for (std::size_t k = 0; k < objects_.size(); ++k)
      if (!model.carried || model.carried->object != static_cast<int>(k))
        pairs_.push_back({PairKind::kObject, shape, static_cast<int>(k), i, 3 * n + k, 0.0});
    if (meets_floor[i]) pairs_.push_back({PairKind::kFloor, shape, -1, n + i, way_.size() - 1, 0.0});
  }
  for (const SelfPair& pair : model.self_pairs) {
    const auto first = static_cast<std::size_t>(pair.first), second = static_cast<std::size_t>(pair.second);
    pairs_.push_back({PairKind::kSelf, pair.first, pair.second, 2 * n + first, 2 * n + second, 0.0});
  }
  found_.reserve(pairs_.size());
}

double GapWatch::gap(const Pair& pair, const SolidPoses& poses, const std::vector<ObjectState>& objects) {
  const auto i = static_cast<std::size_t>(pair.first);
  if (pair.kind == PairKind::kFloor) return lowest_point(shapes_[i].shape, poses.X_WS[i]);
  const auto k = static_cast<std::size_t>(pair.second);
  const bool self = pair.kind == PairKind::kSelf;
  const Solid& a = shapes_[i];
  const Solid& b = self ? shapes_[k] : objects_[k];
  const Isometry& X_WA = poses.X_WS[i];
  const Isometry& X_WB = self ? poses.X_WS[k] : objects[k].X_WO;
  const double balls = (X_WA.translation() - X_WB.translation()).norm() - a.radius - b.radius;
  return balls > kFar ? balls : coal_.distance(a.geometry, X_WA, b.geometry, X_WB).d;
}

void GapWatch::note(const SolidPoses& poses, const std::vector<ObjectState>& objects) {
  last_ = poses;
  const Isometry X_BW = poses.X_WB.inverse();
  for (std::size_t i = 0; i < shapes_.size(); ++i) last_X_BS_[i] = X_BW * poses.X_WS[i];
  for (std::size_t k = 0; k < objects_.size(); ++k) last_X_WO_[k] = objects[k].X_WO;
}

void GapWatch::start(const SolidPoses& poses, const std::vector<ObjectState>& objects) {
  note(poses, objects);
  std::fill(way_.begin(), way_.end(), 0.0);
  std::fill(step_.begin(), step_.end(), 0.0);
  for (Pair& pair : pairs_) pair.room = gap(pair, poses, objects) - kUncertain;
}

void GapWatch::measure_steps(const SolidPoses& poses, const std::vector<ObjectState>& objects, double bend) {
  const std::size_t n = shapes_.size();
  const Isometry X_BW = poses.X_WB.inverse();
  for (std::size_t i = 0; i < n; ++i) {
    const double r = shapes_[i].radius;
    step_[i] = way(last_.X_WS[i], poses.X_WS[i], r) + 2.0 * bend;
    step_[n + i] = way_in_height(last_.X_WS[i], poses.X_WS[i], r) + 2.0 * bend;
    step_[2 * n + i] = way(last_X_BS_[i], X_BW * poses.X_WS[i], r) + 2.0 * bend;
  }
  for (std::size_t k = 0; k < objects_.size(); ++k)
    step_[3 * n + k] = way(last_X_WO_[k], objects[k].X_WO, objects_[k].radius);
}

bool GapWatch::moves_clear(const SolidPoses& poses, const std::vector<ObjectState>& objects, double bend) {
  measure_steps(poses, objects, bend);
  found_.clear();
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const Pair& pair = pairs_[p];
    const double before = way_[pair.way_first] + way_[pair.way_second];
    const double step = step_[pair.way_first] + step_[pair.way_second];
    if (before + step < pair.room) continue;
    // At each moment of the step the gap is at least the first gap minus the travel so far, and at least the second gap
    // minus the travel to come. It stays open if the two gaps together exceed the whole travel.
    const double now = gap(pair, poses, objects) - kUncertain;
    if (!(now > 0.0) || !(pair.room - before + now > step)) return false;
    found_.push_back({p, now + before + step});
  }
  for (const Room& room : found_) pairs_[room.pair].room = room.room;
  for (std::size_t i = 0; i < way_.size(); ++i) way_[i] += step_[i];
  note(poses, objects);
  return true;
}

}  // namespace moma
