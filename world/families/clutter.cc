#include "world/scenario/family.h"
#include "world/scenario/objects.h"

namespace moma {
namespace {

/// Solids along the straight way from start to goal, clear of start and witness.
struct Clutter {
  Placement placement;
  SolidsAlong solids;
};

constexpr void describe(auto& v, Of<Clutter>) {
  v.inlined(&Clutter::placement);
  v.inlined(&Clutter::solids);
}

bool build(const Clutter& p, SceneBuilder& builder, World& world) {
  return builder.place_robot(p.placement, world) && p.solids.place(builder, world);
}

}  // namespace

FamilyType clutter_family() {
  return family_type<Clutter>("solids along the straight way from start to goal, clear of both");
}

}  // namespace moma
