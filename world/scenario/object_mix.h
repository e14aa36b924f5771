#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "world/scenario/distribution.h"
#include "world/world.h"

namespace moma {

/// The random solids of a family: which shapes, how large, standing on the floor or floating.
struct ObjectMix {
  using Uniform = Distribution::Uniform;
  std::vector<ShapeKind> shapes{ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCapsule};  ///< equally likely
  double standing = 0.5;                             ///< part of boxes and capsules that stand on the floor
  Distribution sphere_radius{Uniform{0.05, 0.2}};    ///< [m]
  Distribution box_edge{Uniform{0.1, 0.4}};          ///< each edge of a floating box, x and y of a standing one [m]
  Distribution capsule_radius{Uniform{0.04, 0.12}};  ///< [m]
  Distribution capsule_length{Uniform{0.1, 0.5}};    ///< of a floating one, without caps [m]
  Distribution standing_height{Uniform{0.4, 1.2}};   ///< total height of what stands [m]
  Distribution height{Uniform{0.1, 1.2}};            ///< of the centre of what floats [m]

  void read(config::MapReader& in);
  void write(nlohmann::ordered_json& out) const;

  /// A solid above the horizontal point (x, y), at rest. Floating ones have any orientation (spheres, boxes,
  /// capsules alike) and are lifted where they would reach through the floor.
  void sample(Draws& draws, double x, double y, WorldObject& object) const;
};

}  // namespace moma
