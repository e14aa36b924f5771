#pragma once

#include "controller/fit/solid.h"

namespace moma::fit {

/// Effort of a search: quick for comparing cuts (some percent off), thorough for the result.
enum class Effort { kQuick, kThorough };

/// A shape along the link's own axes is preferred if it is at most this factor larger than the smallest: its angles are
/// readable, and symmetric meshes get symmetric shapes.
inline constexpr double kAlignedGain = 1.003;

/// Smallest enclosing sphere of at least one point: exact, see smallest_ball().
Solid enclosing_sphere(const Points& points);

/// Returns an enclosing capsule of nearly least volume. The shortest length for a given axis and radius is a closed
/// form. The search covers directions (spread over the half sphere, the link's and the principal axes, each with the
/// smallest disc around the projected points), then locally all five variables: direction, offset, radius. A radius
/// above the smallest may pay, since the caps then cover more.
Solid enclosing_capsule(const Points& points, Effort effort);

/// Returns an enclosing box of nearly least volume. For a given normal the smallest rectangle around the projected
/// points has a side along an edge of their hull (Freeman and Shapira 1975) and is found exactly. Normals are those of
/// the hull's faces, the link's and the principal axes, and some spread over the half sphere. The best boxes are
/// improved by using the box's own axes as normals in turn (Chan and Tan 2001), then by small rotations.
Solid enclosing_box(const Points& points, Effort effort);

}  // namespace moma::fit
