#pragma once

#include "controller/model/shape.h"

namespace moma::test {

/// What can be proved about two solids: a plane between them, or a point that both contain.
enum class Overlap { kApart, kBoundary, kDeep, kUndecided };

struct OverlapResult {
  Overlap verdict = Overlap::kUndecided;
  double gap = 0.0;                 ///< kApart: proved lower bound of the distance [m]
  Vector3 p_A_W = Vector3::Zero();  ///< nearest point of A's core found; kApart only
  Vector3 n_W = Vector3::UnitZ();   ///< from B to A; kApart only
};

/// Decides whether sphere, box, capsule or cylinder A overlaps B, by accelerated alternating projections on their cores
/// (exact closed-form projections) and by certificates: shares nothing with ODE or coal.
///
/// kApart: support points prove a gap > rounding. kDeep: solids shrunk by depth / 2 each have a point in common, so the
/// overlap is at least `depth` deep. kBoundary: neither; overlap less than a small multiple of `depth`.
/// Source of the projections' acceleration: Beck & Teboulle, SIAM J. Imaging Sci. 2(1), 2009, with restarts.
OverlapResult overlap(const Shape& A, const Isometry& X_WA, const Shape& B, const Isometry& X_WB, double depth);

/// min over the solid of direction . p, in closed form.
double least_along(const Shape& shape, const Isometry& X_WS, const Vector3& direction_W);

}  // namespace moma::test
