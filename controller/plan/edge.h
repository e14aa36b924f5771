#pragma once

#include "controller/plan/configuration.h"
#include "controller/plan/trapezoid.h"

namespace moma {

/// A piece of a path from a to b, from rest to rest. A differential base turns, drives straight (forwards or
/// backwards, whichever turns less, but for MotionLimits::facing) and turns; an omnidirectional base moves straight and
/// turns evenly; a fixed base stays. The arm moves straight in joint space. The slower of base and arm determines the
/// time of both.
struct Edge {
  WholeConfiguration a, b;
  double turn1 = 0.0, turn2 = 0.0;  ///< turns of the base [rad]; an omnidirectional base has turn1 only
  double drive = 0.0;               ///< way of the base; negative: a differential base drives backwards [m]
  Trapezoid first, middle, last;    ///< quickest motions of the base; an omnidirectional base has `middle` only
  Trapezoid arm;                    ///< quickest motion of the arm
  double time = 0.0;                ///< time of the edge [s]

  double base_time() const noexcept { return first.time + middle.time + last.time; }
};

void make_edge(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b,
               Edge& edge) noexcept;

/// Computes the configuration at time t, clamped to [0, time].
void edge_at(const MotionLimits& limits, const Edge& edge, double t, WholeConfiguration& c) noexcept;

/// Computes the configuration at `part` in [0, 1] of the arm's way if the base is fixed, otherwise of the time.
void edge_point(const MotionLimits& limits, const Edge& edge, double part, WholeConfiguration& c) noexcept;

/// Returns the approximate travel of the robot's farthest point on the edge [m].
double longest_way(const MotionLimits& limits, const Edge& edge) noexcept;

/// Returns the time of the edge from a to b without making it [s].
double edge_time(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b) noexcept;

/// Sets b's heading to that in which a differential base drives there from a, forwards or backwards, whichever is
/// nearer to b's heading. It stays if a and b are at most `near` apart [m].
void head_along(const MotionLimits& limits, const WholeConfiguration& a, double near, WholeConfiguration& b) noexcept;

}  // namespace moma
