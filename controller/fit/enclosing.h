#pragma once

#include "controller/fit/solid.h"

namespace moma::fit {

/// How hard to look: quick is for choosing among cuts (some percent off), thorough for what is written.
enum class Effort { kQuick, kThorough };

/// Shapes along the link's own axes are taken where they are at most so much larger than the smallest found: their
/// angles can be read, and symmetric meshes get symmetric shapes.
inline constexpr double kAlignedGain = 1.003;

/// Smallest enclosing sphere of at least one point: exact, see smallest_ball().
Solid enclosing_sphere(const Points& points);

/// An enclosing capsule of nearly least volume. For a given axis and radius the shortest length follows in closed form;
/// the search is over directions (spread over the half sphere, the link's and the principal axes, each with the
/// smallest disc around the projected points), then locally over all five variables: direction, offset, radius. A
/// radius above the smallest may pay, since it lets the caps do more of the covering.
Solid enclosing_capsule(const Points& points, Effort effort);

/// An enclosing box of nearly least volume. For a given normal the smallest rectangle around the projected points has
/// a side along an edge of their hull (Freeman and Shapira 1975), so that it is found exactly; normals are those of the
/// hull's faces, the link's and the principal axes and some spread over the half sphere. The best are improved by
/// taking the box's own axes for normals in turn (Chan and Tan 2001), then by small turns.
Solid enclosing_box(const Points& points, Effort effort);

}  // namespace moma::fit
