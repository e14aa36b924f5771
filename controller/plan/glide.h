#pragma once

#include "controller/plan/configuration.h"
#include "controller/plan/path.h"

namespace moma {

/// Coordinates that move together.
enum class Moves { kBase, kArm };

// A glide is a motion of base or arm from one velocity to another: the velocity goes evenly to that of the middle in
// `rise` seconds, and evenly from there to the last one in `fall` seconds, as that of a Trapezoid between rests. All
// coordinates keep to these times, and none exceeds its speed or acceleration.

/// Returns the quickest glide from `start` to rest at `end`, over a few times of rising: with r = rise, s = fall and
/// the ways x = end - start - r/2 v it takes T = (r + s)/2 + max(x/v_max, x/(a s), 1/u), where u is the largest full
/// speed in ways per second that keeps |u x - v| <= a r.
Trapezoid glide_to_rest(const MotionLimits& limits, Moves moves, const MotionState& start,
                        const WholeConfiguration& end) noexcept;

/// Returns a quick one from `a` to `b` that takes at least `least` seconds, over a few times of rising and falling:
/// with x = b.c - a.c, the middle velocity is w = (x - rise/2 a.v - fall/2 b.v)/(time - (rise + fall)/2). |w| keeps the
/// speeds, |w - a.v| is at most rise and |w - b.v| at most fall times the accelerations. The time is infinite if there
/// is none.
Trapezoid quick_glide(const MotionLimits& limits, Moves moves, const MotionState& a, const MotionState& b,
                      double least) noexcept;

/// Adds a glide to a path with room for three motions.
void add_glide(Moves moves, const Trapezoid& glide, const MotionState& a, const MotionState& b, Path& path) noexcept;

}  // namespace moma
