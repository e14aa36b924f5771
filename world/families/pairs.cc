#include "world/scenario/family.h"

namespace moma {
namespace {

/// Pairs of random configurations: the arm starts at one, and the goal is the tool's pose at the other. No obstacles.
struct Pairs {
  Placement placement;
  double range = 1.0;  ///< [1]
};

constexpr void describe(auto& v, Of<Pairs>) {
  using T = Pairs;
  v.inlined(&T::placement);
  v.member("range", &T::range,
           in_range({0.0, 1.0, true, false}, "1",
                    "share of each joint's range, around its middle, for start and witness; replaces limit_margin"));
}

bool build(const Pairs& p, SceneBuilder& builder, World& world) {
  return builder.place_pair(p.placement, p.range, world);
}

}  // namespace

FamilyType pairs_family() {
  return family_type<Pairs>(
      "the arm starts at a random configuration, the goal is the tool's pose at another; no objects");
}

}  // namespace moma
