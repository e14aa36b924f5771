#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace moma {

/// Standard deviations of a translation [m] and of a rotation [rad], each per axis.
struct PoseSpread {
  double position = 0.0;
  double rotation = 0.0;
  bool operator==(const PoseSpread&) const = default;
};

/// Standard deviations of a linear velocity [m/s] and of an angular one [rad/s], each per axis; of a gain's error
/// [1] where that is what they are used for.
struct TwistSpread {
  double linear = 0.0;
  double angular = 0.0;
  bool operator==(const TwistSpread&) const = default;
};

/// The arm's encoders. Every delay here and below is rounded up to whole control periods.
struct JointSensing {
  double noise = 0.0;           ///< of a position at each control step [rad or m]
  double velocity_noise = 0.0;  ///< [rad/s or m/s]
  double bias = 0.0;            ///< of each joint's offset, the same throughout a trial [rad or m]
  double delay = 0.0;           ///< [s], of positions and velocities
  bool operator==(const JointSensing&) const = default;
};

/// Errors of dead reckoning that grow with the way (odometry.h).
struct OdometryErrors {
  double distance = 0.0;  ///< of the relative error of distances, the same throughout a trial [1]
  double turn = 0.0;      ///< of the relative error of turns, likewise [1]
  double heading = 0.0;   ///< of the turn that is seen per metre driven, likewise [rad/m]
  PoseSpread walk;        ///< random walk along the way [m per sqrt(m), rad per sqrt(m)]
  bool operator==(const OdometryErrors&) const = default;
};

/// The base's pose and velocity. Without effect on a fixed base.
struct BaseSensing {
  PoseSpread noise;            ///< of x, y and of the heading at each control step
  TwistSpread velocity_noise;  ///< of the measured velocity
  PoseSpread bias;             ///< the same throughout a trial
  double delay = 0.0;          ///< [s], of pose and velocity
  OdometryErrors odometry;
  bool operator==(const BaseSensing&) const = default;
};

/// Where poses are measured from. kBase: by sensors on the robot, so that the base's own error at the time of the
/// measurement is carried into them, and they are right relative to the robot.
enum class SensingFrame { kWorld, kBase };

/// Poses and twists that are measured: those of objects and of the goal.
struct PoseSensing {
  SensingFrame frame = SensingFrame::kWorld;
  PoseSpread noise;               ///< at each control step
  TwistSpread velocity_noise;     ///< of the twist
  bool resting_is_known = false;  ///< what is at rest is measured to be: a twist of 0 has no noise
  PoseSpread bias;                ///< the same throughout a trial; for each object its own
  double delay = 0.0;             ///< [s], of pose, twist and of being seen at all
  bool operator==(const PoseSensing&) const = default;
};

/// When an object is found: once it has been in range for `detection`, and from then on to the trial's end.
struct DetectionRule {
  double range = std::numeric_limits<double>::infinity();  ///< from `sensor` to the object's surface [m]
  double detection = 0.0;                                  ///< [s]
  std::array<double, 3> sensor = {0.0, 0.0, 0.5};          ///< its place in the base frame B [m]
  bool known_at_start = false;  ///< the sensor was on before: what is in range at the first step is found at once
  bool operator==(const DetectionRule&) const = default;
};

/// Between a command and the motion: applied command of coordinate i at step k is (1 + g_i) command_i(k - delay).
struct ActuatorErrors {
  double joint_delay = 0.0;  ///< [s]
  double joint_gain = 0.0;   ///< standard deviation of g of each joint, the same throughout a trial [1]
  double base_delay = 0.0;   ///< [s]
  TwistSpread base_gain;     ///< likewise of the base's velocities
  bool operator==(const ActuatorErrors&) const = default;
};

/// A quantity of the trial's physics: drawn once per trial, normally, and never below 0.
struct Spread {
  double mean = 0.0;
  double spread = 0.0;  ///< standard deviation
  bool operator==(const Spread&) const = default;
};

/// What the robot file does not know of the physics. Dynamic mode only.
struct PhysicsErrors {
  Spread joint_friction;                        ///< dry, as a fraction of the joint's effort limit, each joint its own
  Spread payload_mass;                          ///< held at the end effector [kg]
  std::array<double, 3> payload_position = {};  ///< of its centre in the end effector's frame [m]
  Spread floor_friction = {1.0, 0.0};           ///< between floor and driven wheels [1]
  bool operator==(const PhysicsErrors&) const = default;
};

/// The section `disturbances` of a suite: what stands between the simulated robot and its controller. All off by
/// default. Each is drawn from a stream of its own (streams.h).
struct Disturbances {
  std::uint64_t seed = 0;  ///< other draws for the same world; below 2^32
  JointSensing joints;
  BaseSensing base;
  PoseSensing objects;
  DetectionRule detection;  ///< of objects
  PoseSensing goal;
  ActuatorErrors actuators;
  PhysicsErrors physics;
  bool operator==(const Disturbances&) const = default;
};

/// Whether the controller sees anything but the truth. Seed, frames and the sensor's place alone switch nothing on.
bool senses_with_errors(const Disturbances& disturbances);
/// Whether anything but the command is applied.
bool acts_with_errors(const Disturbances& disturbances);
/// Whether the physics are others than the robot file's. The payload's position alone switches nothing on.
bool moves_with_errors(const Disturbances& disturbances);
inline bool any(const Disturbances& d) { return senses_with_errors(d) || acts_with_errors(d) || moves_with_errors(d); }

/// Least number of control periods that last at least `delay` [s]; a billionth of a period of rounding is forgiven.
long delay_steps(double delay, double control_period);

}  // namespace moma
