#pragma once

#include "controller/plan/configuration.h"
#include "controller/plan/trapezoid.h"

namespace moma {

/// A piece of a path from a to b, from rest to rest. A differential base turns, drives straight (forwards or
/// backwards, whichever turns less) and turns; an omnidirectional one moves straight, turning evenly; a fixed one
/// stays. The arm goes straight through joint space meanwhile. The slower of base and arm sets the time of both.
struct Edge {
  WholeConfiguration a, b;
  double turn1 = 0.0, turn2 = 0.0;  ///< signed [rad]; turn1 is all of an omnidirectional base's
  double drive = 0.0;               ///< of a differential base signed, negative backwards [m]
  Trapezoid first, middle, last;  ///< of the base's parts, as quick as they can be; of an omnidirectional one `middle`
  Trapezoid arm;                  ///< as quick as it can be
  double time = 0.0;              ///< of the whole [s]

  double base_time() const noexcept { return first.time + middle.time + last.time; }
};

void make_edge(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b,
               Edge& edge) noexcept;

/// Where it is at t in [0, time]; times beyond are those of the ends.
void edge_at(const MotionLimits& limits, const Edge& edge, double t, WholeConfiguration& c) noexcept;

/// The same for looking at all of it, `part` in [0, 1]: of the arm's way where the base is bolted down, else of the
/// time.
void edge_point(const MotionLimits& limits, const Edge& edge, double part, WholeConfiguration& c) noexcept;

/// About how far the robot's farthest point goes on it [m].
double longest_way(const MotionLimits& limits, const Edge& edge) noexcept;

/// Only the time of that edge, without making it [s].
double edge_time(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b) noexcept;

/// Turns b's heading (a differential base) to that in which it drives there from a, forwards or backwards, whichever is
/// nearer to what it was; where they are `near` or nearer [m], it is left.
void head_along(const MotionLimits& limits, const WholeConfiguration& a, double near, WholeConfiguration& b) noexcept;

}  // namespace moma
