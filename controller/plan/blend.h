#pragma once

#include "controller/plan/configuration.h"
#include "controller/plan/path.h"

namespace moma {

/// A motion of base or arm from a velocity to rest at a given place. The robot slows down evenly for `brake` seconds;
/// meanwhile a motion to the place speeds up, so that both together never stop where they lead the same way. All
/// coordinates keep to these times, and none exceeds its speed or acceleration.
struct Blend {
  double brake = 0.0;  ///< time of slowing down, and of speeding up [s]
  double fall = 0.0;   ///< time of slowing down at the end [s]
  double time = 0.0;   ///< [s]
};

/// Coordinates that move together.
enum class Moves { kBase, kArm };

/// Returns the quickest blend from `start` to `end`, over a few times of braking: with r = brake, s = fall and the ways
/// x = end - start - r/2 v it takes T = (r + s)/2 + max(x/v_max, x/(a s), 1/u), where u is the largest full speed in
/// ways per second that keeps |u x - v| <= a r.
Blend quickest_blend(const MotionLimits& limits, Moves moves, const MotionState& start,
                     const WholeConfiguration& end) noexcept;

/// Adds it, in `time` >= blend.time seconds, to a path with room for two motions.
void add_blend(Moves moves, const Blend& blend, double time, const MotionState& start, const WholeConfiguration& end,
               Path& path) noexcept;

/// A motion of base or arm from one velocity to another: the velocity goes evenly to that of the middle, and evenly
/// from there to the last one.
struct Glide {
  double time = 0.0;  ///< [s]
  double rise = 0.0;  ///< time of going over to the middle velocity [s]
  double fall = 0.0;  ///< and from it to the last one [s]
};

/// Returns a quick one that takes at least `least` seconds, over a few times of rising and falling: with x = b.c - a.c,
/// the middle velocity is w = (x - rise/2 a.v - fall/2 b.v)/(time - (rise + fall)/2). |w| keeps the speeds, |w - a.v|
/// is at most rise and |w - b.v| at most fall times the accelerations. The time is infinite if there is none.
Glide quick_glide(const MotionLimits& limits, Moves moves, const MotionState& a, const MotionState& b,
                  double least) noexcept;

/// Adds it to a path with room for three motions.
void add_glide(Moves moves, const Glide& glide, const MotionState& a, const MotionState& b, Path& path) noexcept;

}  // namespace moma
