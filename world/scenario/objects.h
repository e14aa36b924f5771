#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "world/scenario/distribution.h"
#include "world/scenario/scene_builder.h"
#include "world/world.h"

namespace moma {

/// Kinds of solids, each entry equally likely.
struct SolidKinds {
  std::vector<ShapeKind> kinds{ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCapsule};
  bool operator==(const SolidKinds&) const = default;
};

void read_value(const config::Node& node, const std::string& key, SolidKinds& value, const About& about);
Json write_value(const SolidKinds& value, const About& about);
std::string accepted(Of<SolidKinds>, const About& about);
std::string text_of(const SolidKinds& value);

/// The random solids of a family: shapes, sizes, standing on the floor or floating.
struct ObjectMix {
  using Uniform = Distribution::Uniform;
  SolidKinds shapes = {};
  double standing = 0.5;                             ///< [1]
  Distribution sphere_radius{Uniform{0.05, 0.2}};    ///< [m]
  Distribution box_edge{Uniform{0.1, 0.4}};          ///< [m]
  Distribution capsule_radius{Uniform{0.04, 0.12}};  ///< [m]
  Distribution capsule_length{Uniform{0.1, 0.5}};    ///< [m]
  Distribution standing_height{Uniform{0.4, 1.2}};   ///< [m]
  Distribution height{Uniform{0.1, 1.2}};            ///< [m]

  /// Draws a solid above the horizontal point (x, y), at rest. Floating solids (spheres, boxes, capsules) have any
  /// orientation, and are lifted if they would penetrate the floor.
  void sample(Draws& draws, double x, double y, WorldObject& object) const;
};

/// Things that stand on furniture.
inline ObjectMix small_things() {
  using Uniform = Distribution::Uniform;
  return {.standing = 1.0,
          .sphere_radius = Distribution(Uniform{0.03, 0.06}),
          .box_edge = Distribution(Uniform{0.05, 0.15}),
          .capsule_radius = Distribution(Uniform{0.02, 0.05}),
          .standing_height = Distribution(Uniform{0.08, 0.3})};
}

constexpr void describe(auto& v, Of<ObjectMix>) {
  using T = ObjectMix;
  constexpr Range kSize = Range::positive();
  v.member("shapes", &T::shapes, {.text = "kinds of solids, each entry equally likely"});
  v.member("standing", &T::standing, in_range({0.0, 1.0}, "1", "share of boxes and capsules that stand on the floor"));
  v.member("sphere_radius", &T::sphere_radius, in_range(kSize, "m", "radius of spheres"));
  v.member("box_edge", &T::box_edge, in_range(kSize, "m", "each edge of a floating box, x and y of a standing one"));
  v.member("capsule_radius", &T::capsule_radius, in_range(kSize, "m", "radius of capsules"));
  v.member("capsule_length", &T::capsule_length, in_range(kSize, "m", "length of a floating capsule without its caps"));
  v.member("standing_height", &T::standing_height, in_range(kSize, "m", "total height of a standing solid"));
  v.member("height", &T::height, quantity("m", "height of a floating solid's centre"));
}

struct Way {
  Vector3 from = Vector3::Zero();      ///< where it begins
  Vector3 forward = Vector3::UnitX();  ///< unit vector along the way, horizontal
  double length = 0.0;                 ///< [m]
  Vector3 left() const { return {-forward.y(), forward.x(), 0.0}; }
};

/// Returns the way from the base of a mobile robot, or from the tool of a fixed one, to the goal. After place_robot().
Way straight_way(const SceneBuilder& builder, const World& world);

struct ObjectTry {
  int number = 0;          ///< number of tries for this object before; what it keeps over them is drawn at 0
  std::uint64_t item = 1;  ///< the object's item for SceneBuilder::draws(); 0 is for draws that all objects share
};

struct ObjectPlacing {
  int count = 0;             ///< number of objects
  int tries = 1;             ///< number of tries for each
  std::string name;          ///< objects are called NAME1, NAME2 ... by default
  std::string drawn_again;   ///< reason counted if an object is drawn again
  std::string out_of_tries;  ///< reason counted if an object finds no place

  /// Adds the objects to the world one after another. `draw` draws one and returns whether it may stay; the next try
  /// starts with the object as `draw` left it. False if the try at the world is rejected.
  bool place(SceneBuilder& builder, World& world,
             const std::function<bool(const ObjectTry& at, WorldObject& object)>& draw) const;
};

/// Solids along the straight way from start to goal, clear of both.
struct SolidsAlong {
  using Uniform = Distribution::Uniform;
  Count objects{Uniform{5.0, 15.0}};
  Distribution along{Uniform{0.0, 1.0}};                 ///< [1]
  Distribution lateral{Distribution::Normal{0.0, 0.6}};  ///< [m]
  ObjectMix mix;

  /// Adds them to the world. After place_robot().
  bool place(SceneBuilder& builder, World& world) const;
};

constexpr void describe(auto& v, Of<SolidsAlong>) {
  using T = SolidsAlong;
  v.member("objects", &T::objects, in_range({0, 1000}, "", "number of solids"));
  v.member("along", &T::along,
           quantity("1", "position of a solid along the way, as a share of the way from start to goal"));
  v.member("lateral", &T::lateral, quantity("m", "position of a solid to the left of the way"));
  v.inlined(&T::mix);
}

}  // namespace moma
