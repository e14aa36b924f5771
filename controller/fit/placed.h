#pragma once

#include "controller/fit/solid.h"

namespace moma::fit {

/// Resolution of written shapes: 0.1 mm and 0.1 mrad.
inline constexpr double kGrid = 1e-4;

/// A solid as a robot file writes it. `solid` is the one that the file's reader makes of these numbers.
struct Placed {
  Solid solid;
  Vector3 position = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
};

/// Rounds position and angles of `solid` to kGrid, and then chooses the smallest sizes in steps of kGrid that still
/// enclose all `points`. Sphere, capsule or box.
Placed rounded(const Solid& solid, const Points& points);

/// Writes a shape unchanged, to the bit except for the angles of its rotation.
Placed as_it_is(const Shape& shape, const Isometry& X_LS);

}  // namespace moma::fit
