#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/identify/motion_log.h"

namespace moma::identify {

/// A latency in parts. Velocities show only the round trip, from a command to the measurement of its effect. Stamps in
/// the log show the sensor's part; the rest is the drive's. Without stamps the whole round trip counts as the drive's:
/// the sum alone determines the controller's behaviour (docs/explanation/safe-controller.md).
struct Latency {
  double round_trip = 0.0;  ///< [s], whole control periods
  double drive = 0.0;       ///< [s]
  double sensing = 0.0;     ///< [s]
  bool has_stamps = false;
  double jitter = 0.0;  ///< greatest minus least age of the stamps [s]
};

/// Estimates for one velocity, or for an omnidirectional base's linear pair.
struct Drive {
  double gain = 1.0;                   ///< measured over commanded velocity [1]
  double velocity_noise = 0.0;         ///< standard deviation, per axis [rad/s or m/s]
  std::optional<double> acceleration;  ///< of its ramp [m/s^2, rad/s^2]; empty if the log does not show a ramp
  /// Without a ramp: the highest commanded acceleration that the drive followed [m/s^2, rad/s^2].
  double least_acceleration = 0.0;
};

struct FoundBase {
  Latency latency;
  Drive linear, turn;
  std::optional<double> position_noise, heading_noise;  ///< [m], [rad]
};

struct FoundJoints {
  Latency latency;
  std::optional<double> position_noise;  ///< of all joints together [rad or m]
  double velocity_noise = 0.0;           ///< [rad/s or m/s]
  double gain_deviation = 0.0;           ///< root of the mean square of g - 1
};

struct FoundObjects {
  double position_noise = 0.0;    ///< per axis, of all objects together [m]
  std::optional<double> sensing;  ///< age of the measurements, by the stamps [s]
};

struct Found {
  double period = 0.0;  ///< [s]
  std::size_t rows = 0;
  std::optional<FoundBase> base;  ///< empty without a base in the log, or without any estimate for it
  std::optional<FoundJoints> joints;
  std::optional<FoundObjects> objects;
  std::vector<std::string> notes;  ///< quantities without an estimate, with reasons, for a person
};

/// Estimates round trips (the n that explains velocities best, 0 to 2 s), gains, ramps and noise (response.h). All n
/// are compared on the same rows, those after the longest round trip. A latency is reported only if commands change and
/// the best n explains the motion clearly better than the worst: its squared misfit is below 0.7 of the worst.
///
/// A log does not show biases, drift of the odometry, detection, or the age of objects and goal without stamps.
///
/// Throws config::ConfigError if the log shows nothing at all, or if a column moves against its commands or at more
/// than three times or less than a third of them: a wrong sign or unit (degrees). From a factor of 1.3 on there is a
/// note. Deterministic. Costs some 0.2 s per thousand rows.
Found identify(const MotionLog& log);

}  // namespace moma::identify
