#include <numbers>

#include "world/scenario/family.h"
#include "world/scenario/objects.h"

namespace moma {
namespace {

/// A full cup is carried from start to goal, among solids as in `clutter`: the axis of the tool that is vertical at the
/// start has to stay near the vertical.
struct UprightTool {
  Placement placement;
  double angle = 0.26;                                    ///< [rad]
  Distribution at_goal{Distribution::Uniform{0.0, 0.5}};  ///< [1]
  SolidsAlong solids;
};

constexpr void describe(auto& v, Of<UprightTool>) {
  using T = UprightTool;
  v.inlined(&T::placement);
  v.member("angle", &T::angle,
           in_range({0.0, std::numbers::pi, true, false}, "rad",
                    "largest angle between the vertical and the tool's axis, which is vertical at the start"));
  v.member("at_goal", &T::at_goal, in_range({0.0, 1.0}, "1", "largest tilt at the goal, as a share of that angle"));
  v.inlined(&T::solids);
}

bool build(const UprightTool& p, SceneBuilder& builder, World& world) {
  return builder.place_upright(p.placement, p.angle, p.at_goal, world) && p.solids.place(builder, world);
}

}  // namespace

FamilyType upright_family() {
  return family_type<UprightTool>("a cup to be kept upright on the way, among solids as in clutter");
}

}  // namespace moma
