#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"

namespace moma {

// Spreads are standard deviations of normal draws, per axis. "Per trial" is drawn once for a world, "per step" at each
// control step. Delays are rounded up to whole control periods.
//
// Everything is written only where it is not the default's: trial keys must not change by disturbances that are added.

namespace disturbed {

// Two seconds are longer than any loop closed over them would bear, and bound the memory of what waits.
inline constexpr Range kDelay{0.0, 2.0};
inline constexpr Range kSpread{0.0, 10.0};
inline constexpr Range kGain{0.0, 1.0};
inline constexpr Range kFriction{0.0, 0.9};
inline constexpr Range kMass{0.0, 1000.0};

constexpr About about(std::string_view unit, const Range& range, std::string_view text) {
  return {.unit = unit, .range = range, .written = Written::kUnlessDefault, .text = text};
}
constexpr About about(std::string_view text) { return {.written = Written::kUnlessDefault, .text = text}; }

}  // namespace disturbed

/// Of a translation [m] and of a rotation [rad].
struct PoseSpread {
  double position = 0.0;
  double rotation = 0.0;
  bool operator==(const PoseSpread&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<PoseSpread>) {
  v.member("position", &PoseSpread::position, disturbed::about("m", disturbed::kSpread, "of each coordinate"));
  v.member("rotation", &PoseSpread::rotation, disturbed::about("rad", disturbed::kSpread, "about each axis"));
}

/// Of a linear velocity [m/s] and of an angular one [rad/s].
struct TwistSpread {
  double linear = 0.0;
  double angular = 0.0;
  bool operator==(const TwistSpread&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<TwistSpread>) {
  v.member("linear", &TwistSpread::linear, disturbed::about("m/s", disturbed::kSpread, "of each coordinate"));
  v.member("angular", &TwistSpread::angular, disturbed::about("rad/s", disturbed::kSpread, "about each axis"));
}

/// The arm's encoders.
struct JointSensing {
  double noise = 0.0;           ///< [rad or m]
  double velocity_noise = 0.0;  ///< [rad/s or m/s]
  double bias = 0.0;            ///< [rad or m]
  double delay = 0.0;           ///< [s]
  bool operator==(const JointSensing&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<JointSensing>) {
  using namespace disturbed;
  using T = JointSensing;
  v.member("noise", &T::noise, about("rad or m", kSpread, "of each joint's position, per step"));
  v.member("velocity_noise", &T::velocity_noise, about("rad/s or m/s", kSpread, "of each joint's velocity, per step"));
  v.member("bias", &T::bias, about("rad or m", kSpread, "of each joint's offset, per trial"));
  v.member("delay", &T::delay, about("s", kDelay, "of positions and velocities"));
}

/// Errors of dead reckoning that grow with the way (odometry.h).
struct OdometryErrors {
  double distance = 0.0;  ///< [1]
  double turn = 0.0;      ///< [1]
  double heading = 0.0;   ///< [rad/m]
  PoseSpread walk;        ///< [m per sqrt(m), rad per sqrt(m)]
  bool operator==(const OdometryErrors&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<OdometryErrors>) {
  using namespace disturbed;
  using T = OdometryErrors;
  v.member("distance", &T::distance, about("1", kGain, "of the relative error of distances, per trial"));
  v.member("turn", &T::turn, about("1", kGain, "of the relative error of turns, per trial"));
  v.member("heading", &T::heading, about("rad/m", kSpread, "of the turn that is seen per metre driven, per trial"));
  v.member("walk", &T::walk, about("random walk along the way, per sqrt(m): its variance grows with the way"));
}

/// The base's pose and velocity. Without effect on a fixed base.
struct BaseSensing {
  PoseSpread noise;
  TwistSpread velocity_noise;
  PoseSpread bias;
  double delay = 0.0;  ///< [s]
  OdometryErrors odometry;
  bool operator==(const BaseSensing&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<BaseSensing>) {
  using namespace disturbed;
  using T = BaseSensing;
  v.member("noise", &T::noise, about("of x, y and of the heading, per step"));
  v.member("velocity_noise", &T::velocity_noise, about("of the measured velocity, per step"));
  v.member("bias", &T::bias, about("of x, y and of the heading, per trial"));
  v.member("delay", &T::delay, about("s", kDelay, "of pose and velocity"));
  v.member("odometry", &T::odometry, about("errors of dead reckoning"));
}

/// Where poses are measured from. kBase: by sensors on the robot, so that the base's own error at the time of the
/// measurement is carried into them, and they are right relative to the robot.
enum class SensingFrame { kWorld, kBase };
constexpr auto words(Of<SensingFrame>) { return std::to_array<std::string_view>({"world", "base"}); }

/// Poses and twists that are measured: those of objects and of the goal.
struct PoseSensing {
  SensingFrame frame = SensingFrame::kWorld;
  PoseSpread noise;
  TwistSpread velocity_noise;
  bool resting_is_known = false;
  PoseSpread bias;     ///< for each object its own
  double delay = 0.0;  ///< [s]
  bool operator==(const PoseSensing&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<PoseSensing>) {
  using namespace disturbed;
  using T = PoseSensing;
  v.member("frame", &T::frame,
           about("base: seen by the robot, with the base's error of that time; right relative to the robot"));
  v.member("noise", &T::noise, about("of the pose, per step"));
  v.member("velocity_noise", &T::velocity_noise, about("of the twist, per step"));
  v.member("resting_is_known", &T::resting_is_known, about("what is at rest is measured to be: a twist of 0 is exact"));
  v.member("bias", &T::bias, about("of the pose, per trial; for each object its own"));
  v.member("delay", &T::delay, about("s", kDelay, "of pose, twist and of being seen at all"));
}

/// When an object is found: once it has been in range for `detection`, and from then on to the trial's end.
struct DetectionRule {
  double range = std::numeric_limits<double>::infinity();  ///< [m]
  double detection = 0.0;                                  ///< [s]
  std::array<double, 3> sensor = {0.0, 0.0, 0.5};          ///< in the base frame B [m]
  bool known_at_start = false;
  bool operator==(const DetectionRule&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<DetectionRule>) {
  using namespace disturbed;
  using T = DetectionRule;
  v.member("range", &T::range, about("m", Range::non_negative_or_inf(), "from `sensor` to the object's surface"));
  v.member("detection", &T::detection, about("s", {0.0, 3600.0}, "in range for so long without a break: found"));
  v.member("known_at_start", &T::known_at_start, about("what is in range at the first step is found at once"));
  v.member("sensor", &T::sensor, about("m", {-100.0, 100.0}, "the sensor's place in the base frame"));
}

/// Dry friction of each joint, drawn for each, at most 0.95. Dynamic mode only.
struct JointFriction {
  double effort = 0.0;  ///< [1]
  double spread = 0.0;  ///< [1]
  bool operator==(const JointFriction&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<JointFriction>) {
  using namespace disturbed;
  v.member("effort", &JointFriction::effort, about("1", kFriction, "mean, as a part of the joint's effort limit"));
  v.member("spread", &JointFriction::spread, about("1", kFriction, "standard deviation of it"));
}

/// Between a command and the motion: applied command of coordinate i at step k is (1 + g_i) command_i(k - delay).
struct JointDrives {
  double delay = 0.0;       ///< [s]
  double gain_error = 0.0;  ///< of g [1]
  JointFriction friction;
  bool operator==(const JointDrives&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<JointDrives>) {
  using namespace disturbed;
  using T = JointDrives;
  v.member("delay", &T::delay,
           about("s", kDelay, "from a command to its effect; until the first is due nothing moves"));
  v.member("gain_error", &T::gain_error, about("1", kGain, "of g in v = (1 + g) command, of each joint, per trial"));
  v.member("friction", &T::friction, about("dry friction of each joint, per trial; dynamic mode"));
}

/// Of g, of the base's velocities [1].
struct GainSpread {
  double linear = 0.0;
  double angular = 0.0;
  bool operator==(const GainSpread&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<GainSpread>) {
  using namespace disturbed;
  v.member("linear", &GainSpread::linear, about("1", kGain, "of g in v = (1 + g) command"));
  v.member("angular", &GainSpread::angular, about("1", kGain, "likewise of turning"));
}

struct BaseDrive {
  double delay = 0.0;  ///< [s]
  GainSpread gain_error;
  bool operator==(const BaseDrive&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<BaseDrive>) {
  using namespace disturbed;
  v.member("delay", &BaseDrive::delay, about("s", kDelay, "as of joints"));
  v.member("gain_error", &BaseDrive::gain_error, about("of the base's velocities, per trial"));
}

struct Actuators {
  JointDrives joints;
  BaseDrive base;
  bool operator==(const Actuators&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<Actuators>) {
  v.member("joints", &Actuators::joints, disturbed::about("the arm's drives"));
  v.member("base", &Actuators::base, disturbed::about("the base's drives"));
}

/// A ball held at the end effector, which the robot file does not know of. Its mass is never below 0. Dynamic mode
/// only.
struct UnknownPayload {
  double mass = 0.0;                    ///< [kg]
  double spread = 0.0;                  ///< [kg]
  std::array<double, 3> position = {};  ///< [m]
  bool operator==(const UnknownPayload&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<UnknownPayload>) {
  using namespace disturbed;
  using T = UnknownPayload;
  v.member("mass", &T::mass, about("kg", kMass, "mean; a ball of the density of water"));
  v.member("spread", &T::spread, about("kg", kMass, "standard deviation of it, per trial"));
  v.member("position", &T::position, about("m", {-10.0, 10.0}, "of its centre in the end effector's frame"));
}

/// Between floor and driven wheels; under mecanum wheels it bounds their drive. Never below 0. Dynamic mode only.
struct FloorFriction {
  double friction = 1.0;  ///< [1]
  double spread = 0.0;    ///< [1]
  bool operator==(const FloorFriction&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<FloorFriction>) {
  using namespace disturbed;
  v.member("friction", &FloorFriction::friction, about("1", kSpread, "mean, between floor and driven wheels"));
  v.member("spread", &FloorFriction::spread, about("1", kSpread, "standard deviation of it, per trial"));
}

/// The section `disturbances` of a suite: what stands between the simulated robot and its controller. All off by
/// default. Each is drawn from a stream of its own (streams.h).
struct Disturbances {
  std::uint64_t seed = 0;
  JointSensing joints;
  BaseSensing base;
  PoseSensing objects;
  DetectionRule detection;  ///< of objects
  PoseSensing goal;
  Actuators actuators;
  UnknownPayload payload;
  FloorFriction floor;
  bool operator==(const Disturbances&) const = default;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<Disturbances>) {
  using disturbed::about;
  using T = Disturbances;
  v.member("seed", &T::seed, about("", {0.0, 0xffffffff}, "other draws for the same worlds"));
  v.member("joints", &T::joints, about("the arm's encoders"));
  v.member("base", &T::base, about("the base's pose and velocity; without effect on a fixed base"));
  v.group("objects", "what is measured of objects, and when they are found", [](auto& group) {
    group.inlined(&T::objects);
    group.inlined(&T::detection);
  });
  v.member("goal", &T::goal, about("what is measured of the goal"));
  v.member("actuators", &T::actuators, about("between a command and the motion"));
  v.member("payload", &T::payload, about("held at the end effector, unknown to the controller; dynamic mode"));
  v.member("floor", &T::floor, about("dynamic mode"));
}

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
