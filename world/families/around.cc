#include "world/scenario/family.h"

namespace moma {
namespace {

/// Goals around the robot for a grasp from above: the tool points down, at the heights of tables and shelves. No
/// obstacles.
struct Around {
  Placement placement{.tip_height = 0.3};
  double downward = 0.95;  ///< [1]
  double highest = 0.9;    ///< [m]
};

constexpr void describe(auto& v, Of<Around>) {
  using T = Around;
  v.inlined(&T::placement);
  v.member("downward", &T::downward, in_range({-1.0, 1.0}, "1", "least downward component of the tool's direction"));
  v.member("highest", &T::highest, quantity("m", "greatest height of the goal"));
}

bool build(const Around& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  if (world.goal.X_WG.translation().z() > p.highest) return builder.reject("goal: too high (highest)");
  if (-builder.approach().z() < p.downward) return builder.reject("goal: the tool does not point down (downward)");
  return true;
}

}  // namespace

FamilyType around_family() {
  return family_type<Around>("goals around the robot with the tool pointing down, no objects");
}

}  // namespace moma
