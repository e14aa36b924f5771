#pragma once

#include <algorithm>
#include <vector>

#include "controller/model/convex_distance.h"
#include "world/world.h"

namespace moma {

/// A solid as the distance library wants it.
struct Solid {
  Shape shape;
  ConvexGeometry geometry;
  double radius;  ///< of the ball about the shape's origin that encloses it [m]

  explicit Solid(const Shape& of) : shape(of), geometry(of), radius(bounding_radius(of)) {}
};

/// Of the robot's shapes, in their order.
inline std::vector<Solid> solids_of(const RobotModel& model) {
  std::vector<Solid> out;
  for (const CollisionShape& shape : model.shapes) out.emplace_back(shape.shape);
  return out;
}

/// Of the world's objects, in their order.
inline std::vector<Solid> solids_of(const World& world) {
  std::vector<Solid> out;
  for (const WorldObject& object : world.objects) out.emplace_back(object.shape);
  return out;
}

/// Of the largest hull among them.
inline int most_vertices(const std::vector<Solid>& solids) {
  std::size_t most = 0;
  for (const Solid& solid : solids)
    if (solid.shape.hull) most = std::max(most, solid.shape.hull->vertices.size());
  return static_cast<int>(most);
}

}  // namespace moma
