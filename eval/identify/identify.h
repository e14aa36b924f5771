#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/identify/motion_log.h"

namespace moma::identify {

/// A latency in parts. Velocities show the whole way round alone, from a command until what it leads to is measured;
/// where the log has stamps, they show the sensor's part, and the rest is the drive's. Without stamps all of it counts
/// as the drive's: for what a controller does, the sum decides (docs/explanation/safe-controller.md).
struct Latency {
  double round_trip = 0.0;  ///< [s], whole control periods
  double drive = 0.0;       ///< [s]
  double sensing = 0.0;     ///< [s]
  bool has_stamps = false;
  double jitter = 0.0;  ///< of the stamps' age: greatest less least [s]
};

/// Found of one velocity, or of an omnidirectional base's linear pair.
struct Drive {
  double gain = 1.0;                   ///< of what is commanded [1]
  double velocity_noise = 0.0;         ///< standard deviation, per axis [rad/s or m/s]
  std::optional<double> acceleration;  ///< of its ramp [m/s^2, rad/s^2]; none where the log does not show one
  double least_acceleration = 0.0;     ///< then: what the commands asked for at most, and got [m/s^2, rad/s^2]
};

struct FoundBase {
  Latency latency;
  Drive linear, turn;
  std::optional<double> position_noise, heading_noise;  ///< [m], [rad]
};

struct FoundJoints {
  Latency latency;
  std::vector<Drive> drives;             ///< in the order of the log's joints
  std::optional<double> position_noise;  ///< of all joints together [rad or m]
  double velocity_noise = 0.0;           ///< [rad/s or m/s]
  double gain_deviation = 0.0;           ///< root of the mean square of g - 1
};

struct FoundObjects {
  double position_noise = 0.0;    ///< per axis, of all objects together [m]
  std::optional<double> sensing;  ///< age of what is measured, by the stamps [s]
};

struct Found {
  double period = 0.0;  ///< [s]
  std::size_t rows = 0;
  std::optional<FoundBase> base;  ///< none: there is no base in the log, or nothing can be said of it
  std::optional<FoundJoints> joints;
  std::optional<FoundObjects> objects;
  std::vector<std::string> notes;  ///< what could not be found, and why, for a person
};

/// Finds round trips (the n that explains velocities best, 0 to 2 s), gains, ramps (response.h) and noise (noise.h).
/// The rows on which all n are compared are those after the longest of them. A latency is only said where commands
/// change and the best n explains the motion clearly better than the worst: its squared misfit is below 0.7 of that.
///
/// Not to be found in such a log, and left as they are: biases, odometry's drift, detection, and the age of what is
/// seen of objects and goal without stamps.
///
/// Throws config::ConfigError where nothing at all can be found, and where a column moves against its commands or
/// more than three times as fast or slowly: a wrong sign or unit (degrees). From 1.3 times on it is a note.
/// Deterministic. Costs some 0.2 s a thousand rows.
Found identify(const MotionLog& log);

}  // namespace moma::identify
