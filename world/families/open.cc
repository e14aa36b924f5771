#include "world/scenario/family.h"

namespace moma {
namespace {

/// Goals anywhere reachable around the robot, no obstacles.
struct Open {
  Placement placement;
};

constexpr void describe(auto& v, Of<Open>) { v.inlined(&Open::placement); }

bool build(const Open& p, SceneBuilder& builder, World& world) { return builder.place_robot(p.placement, world); }

}  // namespace

FamilyType open_family() { return family_type<Open>("goals anywhere in reach around the robot, no objects"); }

}  // namespace moma
