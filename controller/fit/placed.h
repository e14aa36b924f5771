#pragma once

#include "controller/fit/solid.h"

namespace moma::fit {

/// Steps in which fitted shapes are written: 0.1 mm and 0.1 mrad.
inline constexpr double kGrid = 1e-4;

/// A solid as a robot file writes it. `solid` is what the file's reader makes of these very numbers.
struct Placed {
  Solid solid;
  Vector3 position = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
};

/// `solid` with position and angles rounded to kGrid and then sizes as small as they can be, in steps of kGrid, so that
/// it still encloses all `points`: rounding covers, it never uncovers. Sphere, capsule or box.
Placed rounded(const Solid& solid, const Points& points);

/// As it is, to the bit but for the angles, which are those of its rotation.
Placed as_it_is(const Shape& shape, const Isometry& X_LS);

}  // namespace moma::fit
