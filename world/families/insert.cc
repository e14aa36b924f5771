#include <utility>

#include "world/scenario/family.h"
#include "world/scenario/hand.h"

namespace moma {
namespace {

/// The hand in a slot between two boards. Each comes across its thin side until it is `clearance` away from what is in
/// the slot: the hand, and of an arm with a short one its wrist.
struct Insert {
  using Uniform = Distribution::Uniform;
  Placement placement{.tip_height = 0.3};
  Distribution clearance{Distribution::Fixed{0.02}};  ///< [m]
  Distribution depth{Uniform{0.02, 0.1}};             ///< [m]
  Distribution behind{Uniform{0.05, 0.15}};           ///< [m]
  Distribution width{Uniform{0.3, 0.5}};              ///< [m]
  double thickness = 0.02;                            ///< [m]
};

constexpr void describe(auto& v, Of<Insert>) {
  using T = Insert;
  constexpr Range kSize{0.001, 5.0};
  v.inlined(&T::placement);
  v.member("clearance", &T::clearance,
           in_range({0.001, 0.2}, "m", "distance between each board and the hand at the goal"));
  v.member("depth", &T::depth, in_range(kSize, "m", "depth of the hand's foremost point in the slot"));
  v.member("behind", &T::behind, in_range(kSize, "m", "length of the slot beyond that point"));
  v.member("width", &T::width, in_range(kSize, "m", "width of the boards"));
  v.member("thickness", &T::thickness, in_range(kSize, "m", "thickness of the boards"));
}

bool build(const Insert& p, SceneBuilder& builder, World& world) {
  constexpr double kBeside = 0.05;  // a board begins so far beside the hand [m]
  if (!builder.place_robot(p.placement, world)) return false;
  const Hand hand = hand_at_witness(builder, world, "insert");
  if (hand.thin.isZero()) return false;
  Draws draws = builder.draws(Stream::kObjects);
  const double clearance = p.clearance.sample(draws);
  const double depth = p.depth.sample(draws);
  const double behind = p.behind.sample(draws);
  const double width = p.width.sample(draws);

  const Vector3 middle = hand.point + (hand.reach + 0.5 * (behind - depth)) * hand.into;
  for (const double side : {1.0, -1.0}) {
    WorldObject board;
    board.name = side > 0.0 ? "board1" : "board2";
    board.shape = {ShapeKind::kBox, {depth + behind, width, p.thickness}, nullptr};
    const double beside = (side > 0.0 ? hand.above : hand.below) + clearance + kBeside + 0.5 * p.thickness;
    set_pose(board, middle + side * beside * hand.thin, rotation_along(hand.thin, hand.into));
    if (!builder.bring_near(board, -side * hand.thin, 2.0 * beside, clearance))
      return builder.reject("insert: a board meets the arm (depth, clearance)");
    if (lowest_point(board.shape, board.X_WO) < 0.0) return builder.reject("insert: a board reaches the floor");
    if (!builder.stands_near(board, clearance))
      return builder.reject("insert: a board not clear of the start (worlds.clearance)");
    world.objects.push_back(std::move(board));
  }
  return true;
}

}  // namespace

FamilyType insert_family() {
  return family_type<Insert>("the hand in a slot between two boards, as narrow as clearance says");
}

}  // namespace moma
