#pragma once

#include <array>
#include <string_view>

#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"

namespace moma {

/// Bounds on speeds from which the robot can still stop in front of near objects (braking.h).
struct BrakingParams {
  bool enabled = false;
  double share = 0.5;      ///< share of the deceleration along a row with all velocities braking
  double reaction = 0.02;  ///< time until braking begins [s]
};

constexpr void describe(auto& v, Of<BrakingParams>) {
  using P = BrakingParams;
  v.member("share", &P::share, positive_share("share of the deceleration with all velocities braking"));
  v.member("reaction", &P::reaction, non_negative("s", "time until braking begins"));
}

/// Relaxation of infeasible collision rows (solver/fallback.h): by one common slack, or only as far as braking would
/// violate them.
enum class Relaxation { kCommon, kBackup };
constexpr auto words(Of<Relaxation>) { return std::to_array<std::string_view>({"common", "backup"}); }

/// Check ahead: scales down commands whose backup trajectory comes too near to objects at rest (brake_check.h).
struct BrakeCheckParams {
  bool enabled = false;
  double margin = 0.02;  ///< distance kept on the braking trajectory [m]
  int every = 4;         ///< control periods between checked moments
  double widening = 1.5;
  double range = 1.0;
  double own = 0.5;
};

constexpr void describe(auto& v, Of<BrakeCheckParams>) {
  using P = BrakeCheckParams;
  v.member("margin", &P::margin, positive("m", "distance kept on the braking trajectory"));
  v.member("every", &P::every, in_range({1.0, 1000.0}, "", "control periods between checked moments"));
  v.member(
      "widening", &P::widening,
      unless_default(in_range({1.0, 100.0}, "1", "factor on margins of uncertainty along the braking trajectory")));
  v.member("range", &P::range, unless_default(positive("m", "range of the pairs from which these margins are taken")));
  v.member("own", &P::own,
           unless_default(share("share of the stop distances of floor and self rows that a braking trajectory keeps")));
}

/// Distances to objects at rest shrink towards those of the goal's own pose (goal_clearance.h).
struct GoalClearanceParams {
  bool enabled = false;
  double least = 0.0015;  ///< [m]
  double part = 0.5;      ///< share of the hand's distance at its goal that rows keep there [1]
  double slope = 0.25;    ///< increase of that per distance from the goal [1]
};

constexpr void describe(auto& v, Of<GoalClearanceParams>) {
  using P = GoalClearanceParams;
  v.member("least", &P::least, positive("m", "least distance, at the goal itself"));
  v.member("part", &P::part, positive_share("share of the hand's distance at the goal that rows keep there"));
  v.member("slope", &P::slope, positive("1", "increase of the kept distance with the distance from the goal"));
}

/// Separation rows: the robot slows down towards moving objects (qp/separation.h).
struct SeparationParams {
  bool enabled = false;
  double reaction = 0.1;   ///< T_R [s]
  double speed = 0.0;      ///< lower bound of v_H [m/s]
  double intrusion = 0.0;  ///< C, and further required distance [m]
  double share = 0.5;      ///< share of the deceleration along a row with all velocities braking
  double range = 3.0;      ///< nearer objects have rows [m]
};

constexpr void describe(auto& v, Of<SeparationParams>) {
  using P = SeparationParams;
  v.member("reaction", &P::reaction, non_negative("s", "T_R: time from an event to the beginning of braking"));
  v.member("speed", &P::speed, non_negative("m/s", "lower bound of v_H"));
  v.member("intrusion", &P::intrusion, non_negative("m", "C: required distance in addition to those of speeds"));
  v.member("share", &P::share, positive_share("share of the deceleration with all velocities braking"));
  v.member("range", &P::range, positive("m", "range of objects with rows"));
}

/// Evasion: if no admissible command avoids a moving object, the base drives away (evasion.h).
struct EvasionParams {
  bool enabled = false;
  double horizon = 2.0;   ///< time for which moving objects are assumed to keep their twists [s]
  double margin = 0.1;    ///< distance from them on a way out [m]
  double reaction = 0.1;  ///< further distance per speed of the base [s]
  double at_rest = 0.02, touch = 0.005;
  double first = 0.02, step = 0.1;
  double ranked = 3.0;
};

constexpr void describe(auto& v, Of<EvasionParams>) {
  using P = EvasionParams;
  v.member("horizon", &P::horizon, in_range({0.0, 10.0, true}, "s", "horizon of the prediction"));
  v.member("margin", &P::margin, positive("m", "distance from moving objects on a way out"));
  v.member("reaction", &P::reaction, unless_default(non_negative("s", "further distance per speed of the base")));
  v.member("at_rest", &P::at_rest, unless_default(non_negative("m", "distance from objects at rest on a way out")));
  v.member("touch", &P::touch, unless_default(non_negative("m", "distance at which a way out ends in contact")));
  v.member("first", &P::first, unless_default(in_range({0.001, 10.0}, "s", "time of a way out until its first check")));
  v.member("step", &P::step, unless_default(in_range({0.01, 10.0}, "s", "interval between further checks")));
  v.member("ranked", &P::ranked,
           unless_default(positive("1", "multiple of `margin` up to which distance ranks ways out; weight within it")));
}

/// Memory of objects that are no longer reported (object_memory.h).
struct MemoryParams {
  bool enabled = false;
  int rays = 8;       ///< least number of a frame's rays that would end on the object, for evidence against it
  double gone = 0.6;  ///< duration of evidence that removes it, or the time for which it had been reported [s]
  double keep = 1.0;  ///< time for which moving objects are kept, and all objects of a robot without sensors [s]
};

constexpr void describe(auto& v, Of<MemoryParams>) {
  using P = MemoryParams;
  v.member(
      "rays", &P::rays,
      in_range({1.0, 100'000.0}, "", "number of a frame's rays through its place that count as evidence against it"));
  v.member("gone", &P::gone,
           positive("s", "duration of evidence that removes an object, or the time for which it had been reported"));
  v.member("keep", &P::keep,
           non_negative("s", "time for which moving objects are kept, and all objects of a robot without sensors"));
}

/// Estimation of lateness from motion (round_trip.h, predictor.h), and jumps that begin an estimate anew.
struct EstimationParams {
  int least_tried = 12, beyond = 3;
  double forget = 0.5, better = 0.7;
  double velocity_noise = 0.03, observe = 0.5;
  double slips = 0.2, slip_prior = 0.05;
  double gain = 0.02, gain_forget = 10.0;
  double least_gain = 0.7, largest_gain = 1.3;
  double missed = 5.0;
  double relocated = 0.5;
  double jump = 0.1;
};

constexpr void describe(auto& v, Of<EstimationParams>) {
  using T = EstimationParams;
  constexpr Range kPeriods{1.0, 1000.0};
  v.member("least_tried", &T::least_tried, in_range(kPeriods, "control periods", "least longest round trip tried"));
  v.member("beyond", &T::beyond, in_range(kPeriods, "control periods", "round trips tried beyond the configured one"));
  v.member("forget", &T::forget, positive("s", "time constant with which a round trip's misfit forgets"));
  v.member("better", &T::better, share("factor on the present misfit below which another replaces it"));
  v.member(
      "velocity_noise", &T::velocity_noise,
      unless_default(non_negative("m/s or rad/s", "difference of the base's velocity from its ramp that is noise")));
  v.member("observe", &T::observe,
           unless_default(share("share of a larger difference by which the ramp is moved; 0: none")));
  v.member("slips", &T::slips,
           unless_default(share("share of a hard acceleration that a base that slips does not do, at least")));
  v.member(
      "slip_prior", &T::slip_prior,
      unless_default(positive("s", "time of full acceleration that the belief in a base without slip counts for")));
  v.member("gain", &T::gain,
           in_range({0.0, 0.5}, "1", "spread of the base's gains from drive to drive; 0: the gains are 1"));
  v.member("gain_forget", &T::gain_forget,
           positive("s", "time constant with which a gain's measurements are forgotten"));
  v.member("least_gain", &T::least_gain, unless_default(positive_share("least gain of the base that is believed")));
  v.member("largest_gain", &T::largest_gain,
           unless_default(in_range({1.0, 10.0}, "1", "largest gain of the base that is believed")));
  v.member("missed", &T::missed, positive("s", "time constant with which missed steps are forgotten"));
  v.member("relocated", &T::relocated, positive("m or rad", "error of the base's prediction that relocates it"));
  v.member("jump", &T::jump, positive("m or rad", "error of a track's prediction that begins it anew"));
}

/// Known latencies of drives and sensing, rounded up to control periods, and filters (predictor.h). All in seconds.
struct PredictionParams {
  bool enabled = false;
  double base_drive = 0.0;      ///< from a command to the base's motion
  double joint_drive = 0.0;     ///< from a command to the joints' motion
  double base_sensing = 0.0;    ///< age of the base's measured pose and velocity
  double joint_sensing = 0.0;   ///< age of the joints' measurements
  double object_sensing = 0.0;  ///< age of objects' poses and twists
  double goal_sensing = 0.0;    ///< age of the goal's
  double base_filter = 0.0;     ///< time constants; 0: no filter
  double resting_filter = 0.0;  ///< of poses of resting objects and goal,
  double moving_filter = 0.0;   ///< of moving ones,
  double twist_filter = 0.0;    ///< and of their twists
  /// Identify the round trips of base and joints from motion; the times above are first guesses.
  bool identify = false;
  EstimationParams estimation;
  MemoryParams memory;
};

constexpr void describe(auto& v, Of<PredictionParams>) {
  using P = PredictionParams;
  constexpr Range kLateness{0.0, 2.0};
  v.group("drives", "latency from a command to its effect", [=](auto& g) {
    g.member("base", &P::base_drive, in_range(kLateness, "s", "latency of the base's drive"));
    g.member("joints", &P::joint_drive, in_range(kLateness, "s", "latency of the joints' drives"));
  });
  v.group("sensing", "age of measurements", [=](auto& g) {
    g.member("base", &P::base_sensing, in_range(kLateness, "s", "age of pose and velocity"));
    g.member("joints", &P::joint_sensing, in_range(kLateness, "s", "age of positions and velocities"));
    g.member("objects", &P::object_sensing, in_range(kLateness, "s", "age of poses and twists"));
    g.member("goal", &P::goal_sensing, in_range(kLateness, "s", "age of pose and twist"));
  });
  v.group("filters", "time constants, 0: none", [](auto& g) {
    g.member("base", &P::base_filter, non_negative("s", "time constant for the base's pose"));
    g.member("resting", &P::resting_filter, non_negative("s", "time constant for poses of objects and goal at rest"));
    g.member("moving", &P::moving_filter, non_negative("s", "time constant for poses of moving ones"));
    g.member("twist", &P::twist_filter, non_negative("s", "time constant for their twists"));
  });
  v.member("identify", &P::identify, {.text = "identify the round trips of base and joints from their motion"});
  v.member("estimation", &P::estimation,
           unless_default({.text = "estimation of lateness, and jumps that begin it anew"}));
  v.optional("memory", &P::memory, &MemoryParams::enabled, Off::kOmitted,
             "objects that are no longer reported stay until a sensor sees through their place");
}

/// Errors of measurements (uncertainty.h): standard deviations per axis, as in `disturbances`.
struct UncertaintyParams {
  bool enabled = false;
  double probability = 0.99;             ///< one-sided probability with which a row's distance is kept
  double object_noise = 0.0;             ///< of an object's position at each step [m],
  double object_rotation_noise = 0.0;    ///< of its orientation [rad],
  double object_bias = 0.0;              ///< constant error of its position [m],
  double object_rotation_bias = 0.0;     ///< [rad]
  double object_velocity = 0.0;          ///< of its linear velocity, at each step [m/s],
  double object_angular_velocity = 0.0;  ///< and its angular one [rad/s]
  double growth = 0.0;                   ///< growth of its position's error while out of sight [m/s]
  double keep = 0.0;                     ///< time for which an object out of sight is kept [s]
  double base_position = 0.0;            ///< of the base relative to what is seen [m],
  double base_rotation = 0.0;            ///< [rad]
  double joints = 0.0;                   ///< of each joint [rad or m]
};

constexpr void describe(auto& v, Of<UncertaintyParams>) {
  using P = UncertaintyParams;
  constexpr Range kSpread = Range::non_negative();
  v.member("probability", &P::probability,
           in_range({0.5, 1.0, false, true}, "1", "probability with which a row's distance is kept"));
  v.group("objects", "errors of the poses and twists of objects", [=](auto& objects) {
    objects.group("noise", "drawn at each step", [=](auto& g) {
      g.member("position", &P::object_noise, in_range(kSpread, "m", "noise of positions"));
      g.member("rotation", &P::object_rotation_noise, in_range(kSpread, "rad", "noise of orientations"));
    });
    objects.group("bias", "constant", [=](auto& g) {
      g.member("position", &P::object_bias, in_range(kSpread, "m", "constant error of positions"));
      g.member("rotation", &P::object_rotation_bias, in_range(kSpread, "rad", "constant error of orientations"));
    });
    objects.group("velocity_noise", "drawn at each step", [=](auto& g) {
      g.member("linear", &P::object_velocity, in_range(kSpread, "m/s", "noise of linear velocities"));
      g.member("angular", &P::object_angular_velocity, in_range(kSpread, "rad/s", "noise of angular velocities"));
    });
    objects.member("growth", &P::growth, in_range(kSpread, "m/s", "growth of the position error while out of sight"));
    objects.member("keep", &P::keep, in_range(kSpread, "s", "time for which an object out of sight is kept"));
  });
  v.group("base", "errors of the base relative to what is seen", [=](auto& g) {
    g.member("position", &P::base_position, in_range(kSpread, "m", "error of the position"));
    g.member("rotation", &P::base_rotation, in_range(kSpread, "rad", "error of the heading"));
  });
  v.member("joints", &P::joints, in_range(kSpread, "rad or m", "error of each joint"));
}

/// Limit of a base's speed: it can stop in front of objects that come into sight (qp/limits.h).
struct SightParams {
  bool enabled = false;
  double range = 3.0;     ///< distance from the base's middle at which every object is seen [m]
  double reach = 1.0;     ///< extent of the robot beyond the base's middle, plus the distance to keep [m]
  double reaction = 0.3;  ///< time from coming into range to braking: detection, latency [s]
  double speed = 0.0;     ///< speed at which an object may approach [m/s]
};

constexpr void describe(auto& v, Of<SightParams>) {
  using P = SightParams;
  v.member("range", &P::range, positive("m", "distance at which every object is seen"));
  v.member("reach", &P::reach, non_negative("m", "extent of the robot, plus the distance to keep"));
  v.member("reaction", &P::reaction, non_negative("s", "time from coming into range to braking"));
  v.member("speed", &P::speed, non_negative("m/s", "speed at which an object may approach"));
}

}  // namespace moma
