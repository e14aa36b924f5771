#include "controller/fit/best_solid.h"

#include <limits>

namespace moma::fit {

double weight(ShapeKind kind, const Kinds& kinds) noexcept {
  return kind == ShapeKind::kBox ? kinds.box_weight : kind == ShapeKind::kCapsule ? kCapsuleWeight : 1.0;
}

Solid best_solid(const Points& points, const Kinds& kinds, Effort effort) {
  Solid best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Solid& solid) {
    const double cost = weight(solid.shape.kind, kinds) * volume(solid.shape);
    if (cost >= least) return;
    least = cost;
    best = solid;
  };
  if (kinds.sphere) consider(enclosing_sphere(points));
  if (kinds.capsule) consider(enclosing_capsule(points, effort));
  if (kinds.box) consider(enclosing_box(points, effort));
  return best;
}

}  // namespace moma::fit
