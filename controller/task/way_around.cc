#include "controller/task/way_around.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/shape.h"

namespace moma {
namespace {

constexpr std::size_t kMost = 32;  // largest number of obstacles
constexpr double kEdge = 0.01;     // distance of corners outside their octagon [m]
constexpr double kCrossed = 1e-9;  // share of a line inside an octagon that counts as a crossing
constexpr int kAttempts = 3;       // number of margins
constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kDiagonal = 0.5 * std::numbers::sqrt2;
constexpr int kDirections = 8;
constexpr double kX[kDirections] = {1.0, kDiagonal, 0.0, -kDiagonal, -1.0, -kDiagonal, 0.0, kDiagonal};
constexpr double kY[kDirections] = {0.0, kDiagonal, 1.0, kDiagonal, 0.0, -kDiagonal, -1.0, -kDiagonal};

}  // namespace

WayAround::WayAround(const RobotModel& model, const AroundParams& params) : params_(params) {
  if (!params.enabled) return;
  constexpr int kRays = 64;
  Kinematics kinematics(std::make_shared<const RobotModel>(model));
  kinematics.update(Vector3::Zero(), model.ready);
  for (const CollisionShape& shape : model.shapes) {
    const Isometry X_WS = kinematics.X_WS(shape);
    top_ = std::max(top_, extent_along(shape.shape, X_WS, Vector3::UnitZ()));
    if (!shape.rigid_with_base) continue;
    for (int k = 0; k < kRays; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kRays;
      radius_ = std::max(radius_, extent_along(shape.shape, X_WS, {std::cos(angle), std::sin(angle), 0.0}));
    }
  }
}

void WayAround::allocate(int num_objects) {
  const auto count = std::min(static_cast<std::size_t>(num_objects), kMost);
  shadows_.reserve(static_cast<std::size_t>(num_objects));
  octagons_.reserve(count);
  nodes_.reserve(1 + kDirections * count);
}

Way WayAround::find(const Proximity& proximity, std::span<const ObjectState> objects, const Vector2& from,
                    const Vector2& to) noexcept {
  take_shadows(proximity, objects, from);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Way way = search(radius_ + (1 - attempt) * params_.clearance, from, to);
    if (way.found) return way;
  }
  return {};
}

void WayAround::take_shadows(const Proximity& proximity, std::span<const ObjectState> objects,
                             const Vector2& from) noexcept {
  shadows_.clear();
  for (std::size_t j = 0; j < objects.size() && shadows_.size() < shadows_.capacity(); ++j) {
    const ObjectState& object = objects[j];
    if (!object.visible || !is_pose(object.X_WO) || in_motion(object)) continue;
    const Shape& shape = proximity.object_shape(static_cast<int>(j));
    if (lowest_point(shape, object.X_WO) > top_) continue;
    Shadow shadow{(object.X_WO.translation().head<2>() - from).norm(), static_cast<int>(j), {}};
    for (int k = 0; k < kDirections; ++k)
      shadow.extent[static_cast<std::size_t>(k)] = extent_along(shape, object.X_WO, {kX[k], kY[k], 0.0});
    shadows_.push_back(shadow);
  }
  std::sort(shadows_.begin(), shadows_.end(), [](const Shadow& a, const Shadow& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.object < b.object;
  });
  if (shadows_.size() > kMost) shadows_.resize(kMost);
}

void WayAround::grow(double margin, const Vector2& from) noexcept {
  const Octagon start = coordinates(from);
  octagons_.clear();
  for (const Shadow& shadow : shadows_) {
    Octagon octagon = shadow.extent;
    double depth = kFar;
    for (std::size_t k = 0; k < kDirections; ++k) {
      octagon[k] += margin;
      depth = std::min(depth, octagon[k] - start[k]);
    }
    if (depth > -kEdge) {
      for (double& side : octagon) side -= depth + kEdge;
    }
    octagons_.push_back(octagon);
  }
}

WayAround::Octagon WayAround::coordinates(const Vector2& p) noexcept {
  Octagon along;
  for (std::size_t k = 0; k < kDirections; ++k) along[k] = kX[k] * p.x() + kY[k] * p.y();
  return along;
}

void WayAround::add_node(const Vector2& p) noexcept {
  const Octagon along = coordinates(p);
  for (const Octagon& octagon : octagons_) {
    bool inside = true;
    for (std::size_t k = 0; k < kDirections && inside; ++k) inside = along[k] < octagon[k];
    if (inside) return;
  }
  nodes_.push_back({p, along, kFar, -1, false});
}

// Clips a line by the eight half-planes of each octagon in turn (Cyrus & Beck, 1978).
bool WayAround::free(const Octagon& a, const Octagon& b) const noexcept {
  for (const Octagon& octagon : octagons_) {
    double enter = 0.0, leave = 1.0;
    bool apart = false;
    for (std::size_t k = 0; k < kDirections && !apart; ++k) {
      const double at_a = a[k] - octagon[k], at_b = b[k] - octagon[k];
      if (at_a >= 0.0 && at_b >= 0.0) {
        apart = true;
      } else if (at_a > 0.0) {
        enter = std::max(enter, at_a / (at_a - at_b));
      } else if (at_b > 0.0) {
        leave = std::min(leave, at_a / (at_a - at_b));
      }
      apart = apart || leave - enter < kCrossed;
    }
    if (!apart) return false;
  }
  return true;
}

bool WayAround::reaches(const Node& node, const Vector2& to) const noexcept {
  const Vector2 way = to - node.p;
  const double length = way.norm();
  if (length <= params_.reach) return true;
  return free(node.along, coordinates(node.p + way * ((length - params_.reach) / length)));
}

Way WayAround::search(double margin, const Vector2& from, const Vector2& to) noexcept {
  grow(margin, from);
  nodes_.clear();
  nodes_.push_back({from, coordinates(from), 0.0, -1, false});
  for (const Octagon& octagon : octagons_) {
    for (std::size_t k = 0; k < kDirections; ++k) {
      const std::size_t next = (k + 1) % kDirections;
      const double a = octagon[k] + kEdge, b = octagon[next] + kEdge;
      add_node(Vector2(a * kY[next] - b * kY[k], b * kX[k] - a * kX[next]) / kDiagonal);
    }
  }
  while (true) {
    int nearest = -1;
    double least = kFar;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const double estimate = nodes_[i].cost + (to - nodes_[i].p).norm();
      if (nodes_[i].done || !(estimate < least)) continue;
      nearest = static_cast<int>(i);
      least = estimate;
    }
    if (nearest < 0) return {};
    Node& node = nodes_[static_cast<std::size_t>(nearest)];
    node.done = true;
    if (reaches(node, to)) {
      if (nearest == 0) return {true, true, to};
      int turn = nearest;
      while (nodes_[static_cast<std::size_t>(turn)].parent > 0) turn = nodes_[static_cast<std::size_t>(turn)].parent;
      return {true, false, nodes_[static_cast<std::size_t>(turn)].p};
    }
    for (Node& other : nodes_) {
      const double cost = node.cost + (other.p - node.p).norm();
      if (other.done || !(cost < other.cost) || !free(node.along, other.along)) continue;
      other.cost = cost;
      other.parent = nearest;
    }
  }
}

}  // namespace moma
