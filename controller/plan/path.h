#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "controller/plan/edge.h"
#include "controller/plan/trapezoid.h"

namespace moma {

/// A motion of a path: it adds `change` to the configuration from the time `start` on the path's clock [s] on.
struct PathPart {
  double start = 0.0;
  Trapezoid motion;
  WholeConfiguration change;

  double end() const noexcept { return start + motion.time; }
};

/// A timed path of base and arm to rest, at its goal or at the next one: overlapping motions in a fixed size. Those of
/// a robot in motion begin at its velocity: a motion without a rise slows it down while others begin. Its axes are the
/// world's at the time of planning, when the goal was at X_WG.
struct Path {
  static constexpr int kMostMotions = 88;

  WholeConfiguration origin;
  std::array<PathPart, kMostMotions> motions;
  int count = 0;
  double duration = 0.0;   ///< [s]
  double clearance = 0.0;  ///< distance from objects at rest, half of it where motions overlap [m]
  /// Smaller distance at the goal; it grows with the distance from the goal (goal_clearance.h) [m].
  double kept_at_goal = kInfinity;
  double arm_at_goal = kInfinity;  ///< the same of all but the hand
  Isometry X_WG = Isometry::Identity();
  bool meets = false;                    ///< X_WG is the place at which a goal in motion was expected
  double pass = kInfinity;               ///< time at which E passes its goal; infinite: the path ends there [s]
  Isometry X_WN = Isometry::Identity();  ///< then the goal at which it ends: the one after that

  bool passes() const noexcept { return pass < kInfinity; }
  /// True if the goal is close to an object: the path keeps less than its clearance there.
  bool close() const noexcept { return kept_at_goal < clearance; }
  /// Time at which E is at the goal [s].
  double arrival() const noexcept { return std::min(pass, duration); }
  /// Computes the configuration at time t, clamped to the path's ends. The path must have motions.
  void at(double t, WholeConfiguration& c) const noexcept;
  /// Computes the velocity at time t from the configurations at t - h and t + h.
  void velocity(double t, double h, WholeConfiguration& v) const noexcept;
  std::span<PathPart> parts() noexcept { return std::span(motions).first(static_cast<std::size_t>(count)); }
  std::span<const PathPart> parts() const noexcept { return std::span(motions).first(static_cast<std::size_t>(count)); }
  /// Begins anew at `from`, without motions.
  void begin(const WholeConfiguration& from) noexcept;
  /// Adds a motion. False if the path cannot hold it.
  bool add(const PathPart& part) noexcept;
  /// Goes on along another path, which begins in its last configuration, to the goal at X_WN: the path passes its own
  /// goal there. Motions that have ended by time `t` become part of the origin. False, and nothing changes, if it
  /// cannot hold them all.
  bool append(double t, const Path& on, const Isometry& X_WN_then) noexcept;
  /// Lets the path begin `time` seconds earlier, at the velocity with which it begins.
  void begin_earlier(double time) noexcept;
};

/// The way in which a robot slows down evenly from a configuration to rest at a path's first edge.
struct Braking {
  WholeConfiguration from;
  double time = 0.0;  ///< [s]; 0: it stands there
};

/// Makes motions of edges, after the braking. Each motion begins up to `overlap` seconds before the end of the one
/// before it, at most half of the shorter one's time. Motions of the same kind overlap by a ramp, so that their summed
/// speeds keep the limits. False if the path cannot hold all motions.
bool lay_path(const MotionLimits& limits, std::span<const Edge> edges, double overlap, const Braking& braking,
              Path& path) noexcept;

}  // namespace moma
