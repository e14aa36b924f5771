#pragma once

#include <algorithm>
#include <vector>

#include "controller/model/solid.h"
#include "world/world.h"

namespace moma {

inline std::vector<Solid> solids_of(const RobotModel& model) {
  std::vector<Solid> out;
  for (const CollisionShape& shape : model.shapes) out.emplace_back(shape.shape);
  return out;
}

inline std::vector<Solid> solids_of(const World& world) {
  std::vector<Solid> out;
  for (const WorldObject& object : world.objects) out.emplace_back(object.shape);
  return out;
}

/// Number of vertices of the largest hull.
inline int most_vertices(const std::vector<Solid>& solids) {
  std::size_t most = 0;
  for (const Solid& solid : solids)
    if (solid.shape.hull) most = std::max(most, solid.shape.hull->vertices.size());
  return static_cast<int>(most);
}

}  // namespace moma
