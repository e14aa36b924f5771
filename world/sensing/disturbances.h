#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string_view>

#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "controller/describe/equal.h"

namespace moma {

// Spreads are standard deviations of normal draws, per axis. "Per trial" is one draw per world, "per step" one at each
// control step. Delays are rounded up to whole control periods.
//
// Only members that differ from their defaults are written, so that new disturbances do not change trial keys.

namespace disturbed {

// No loop stays stable over two seconds of delay; the limit bounds the memory of delayed values.
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

/// Standard deviations of a translation [m] and of a rotation [rad].
struct PoseSpread {
  double position = 0.0;
  double rotation = 0.0;
};

constexpr void describe(auto& v, Of<PoseSpread>) {
  v.member("position", &PoseSpread::position, disturbed::about("m", disturbed::kSpread, "value for each coordinate"));
  v.member("rotation", &PoseSpread::rotation, disturbed::about("rad", disturbed::kSpread, "value about each axis"));
}

/// Standard deviations of a linear velocity [m/s] and of an angular one [rad/s].
struct TwistSpread {
  double linear = 0.0;
  double angular = 0.0;
};

constexpr void describe(auto& v, Of<TwistSpread>) {
  v.member("linear", &TwistSpread::linear, disturbed::about("m/s", disturbed::kSpread, "value for each coordinate"));
  v.member("angular", &TwistSpread::angular, disturbed::about("rad/s", disturbed::kSpread, "value about each axis"));
}

/// Varying delay and loss: a value takes `delay` plus up to `jitter`, uniform in whole control periods, and is lost
/// with the probability `dropout`. The output is the newest value that has arrived.
struct Irregularity {
  double jitter = 0.0;   ///< [s]
  double dropout = 0.0;  ///< [1]
};

constexpr void describe(auto& v, Of<Irregularity>) {
  using namespace disturbed;
  v.member("jitter", &Irregularity::jitter,
           about("s", kDelay, "largest additional delay, uniformly drawn at each step"));
  v.member("dropout", &Irregularity::dropout, about("1", kGain, "probability of loss"));
}

/// The arm's encoders.
struct JointSensing {
  double noise = 0.0;           ///< [rad or m]
  double velocity_noise = 0.0;  ///< [rad/s or m/s]
  double bias = 0.0;            ///< [rad or m]
  double delay = 0.0;           ///< [s]
  Irregularity irregularity{};
  double resolution = 0.0;           ///< [rad or m]
  double velocity_resolution = 0.0;  ///< [rad/s or m/s]
};

constexpr void describe(auto& v, Of<JointSensing>) {
  using namespace disturbed;
  using T = JointSensing;
  v.member("noise", &T::noise, about("rad or m", kSpread, "noise of each joint's position, per step"));
  v.member("velocity_noise", &T::velocity_noise,
           about("rad/s or m/s", kSpread, "noise of each joint's velocity, per step"));
  v.member("bias", &T::bias, about("rad or m", kSpread, "constant error of each joint's position, per trial"));
  v.member("delay", &T::delay, about("s", kDelay, "delay of positions and velocities"));
  v.inlined(&T::irregularity);
  v.member("resolution", &T::resolution, about("rad or m", kSpread, "resolution of positions"));
  v.member("velocity_resolution", &T::velocity_resolution, about("rad/s or m/s", kSpread, "resolution of velocities"));
}

/// Occasional wheel slip: within a step's distance s with the probability 1 - exp(-rate s).
struct WheelSlip {
  double rate = 0.0;      ///< [1/m]
  double distance = 0.0;  ///< [m]
  double turn = 0.0;      ///< [rad]
};

constexpr void describe(auto& v, Of<WheelSlip>) {
  using namespace disturbed;
  using T = WheelSlip;
  v.member("rate", &T::rate, about("1/m", {0.0, 100.0}, "mean number of slips per metre driven"));
  v.member("distance", &T::distance, about("m", kSpread, "error of the measured distance by a slip"));
  v.member("turn", &T::turn, about("rad", kSpread, "error of the measured turn by a slip"));
}

/// Errors of dead reckoning that grow with the distance (Odometry, odometry.h).
struct OdometryErrors {
  double distance = 0.0;  ///< [1]
  double turn = 0.0;      ///< [1]
  double heading = 0.0;   ///< [rad/m]
  PoseSpread walk;        ///< [m per sqrt(m), rad per sqrt(m)]
  WheelSlip slip{};
};

constexpr void describe(auto& v, Of<OdometryErrors>) {
  using namespace disturbed;
  using T = OdometryErrors;
  v.member("distance", &T::distance, about("1", kGain, "relative error of distances, per trial"));
  v.member("turn", &T::turn, about("1", kGain, "relative error of turns, per trial"));
  v.member("heading", &T::heading, about("rad/m", kSpread, "apparent turn per metre driven, per trial"));
  v.member("walk", &T::walk, about("random walk, per sqrt(m): its variance grows with the distance driven"));
  v.member("slip", &T::slip, about("occasional wheel slip"));
}

/// Sensing of the base's pose and velocity. No effect on a fixed base.
struct BaseSensing {
  PoseSpread noise;
  TwistSpread velocity_noise;
  PoseSpread bias;
  double delay = 0.0;  ///< [s]
  Irregularity irregularity{};
  TwistSpread velocity_resolution;  ///< [m/s, rad/s]
  OdometryErrors odometry;
};

constexpr void describe(auto& v, Of<BaseSensing>) {
  using namespace disturbed;
  using T = BaseSensing;
  v.member("noise", &T::noise, about("noise of x, y and heading, per step"));
  v.member("velocity_noise", &T::velocity_noise, about("noise of the measured velocity, per step"));
  v.member("bias", &T::bias, about("constant error of x, y and heading, per trial"));
  v.member("delay", &T::delay, about("s", kDelay, "delay of pose and velocity"));
  v.inlined(&T::irregularity);
  v.member("velocity_resolution", &T::velocity_resolution, about("resolution of velocities"));
  v.member("odometry", &T::odometry, about("errors of dead reckoning"));
}

/// Frame of measured poses. kBase: sensors on the robot measure them, so that they contain the base's own error at the
/// time of measurement, and are exact relative to the robot.
enum class SensingFrame { kWorld, kBase };
constexpr auto words(Of<SensingFrame>) { return std::to_array<std::string_view>({"world", "base"}); }

/// Sensing of poses and twists of objects and goal.
struct PoseSensing {
  SensingFrame frame = SensingFrame::kWorld;
  PoseSpread noise;
  TwistSpread velocity_noise;
  bool resting_is_known = false;
  PoseSpread bias;     ///< drawn for each object
  double delay = 0.0;  ///< [s]
  Irregularity irregularity{};
  double noise_growth = 0.0;  ///< [1/m^2]
};

constexpr void describe(auto& v, Of<PoseSensing>) {
  using namespace disturbed;
  using T = PoseSensing;
  v.member("frame", &T::frame,
           about("base: measured from the robot, with the base's own error at that time; exact relative to the robot"));
  v.member("noise", &T::noise, about("noise of the pose, per step"));
  v.member("velocity_noise", &T::velocity_noise, about("noise of the twist, per step"));
  v.member("resting_is_known", &T::resting_is_known, about("a twist of 0 is measured without noise"));
  v.member("bias", &T::bias, about("constant error of the pose, per trial and object"));
  v.member("delay", &T::delay, about("s", kDelay, "delay of pose, twist and visibility"));
  v.inlined(&T::irregularity);
  v.member("noise_growth", &T::noise_growth,
           about("1/m^2", {0.0, 100.0},
                 "growth of noise: the factor at a distance r from the sensor is 1 + noise_growth r^2"));
}

/// Missed detections: in each span of time each found object is invisible with this probability, independently.
struct MissedDetections {
  double probability = 0.0;  ///< [1]
  double duration = 0.2;     ///< duration of a span [s]
};

constexpr void describe(auto& v, Of<MissedDetections>) {
  using namespace disturbed;
  using T = MissedDetections;
  v.member("probability", &T::probability, about("1", kGain, "probability that an object is missed in a span of time"));
  v.member("duration", &T::duration, about("s", {1e-3, 3600.0}, "duration of a span"));
}

/// False detections: balls at rest near the robot that do not exist, each for whole spans of time.
struct FalseDetections {
  int count = 0;             ///< largest number at a time
  double probability = 0.1;  ///< of each ball, in each span [1]
  double duration = 0.3;     ///< duration of a span [s]
  double radius = 0.1;       ///< [m]
  double nearest = 0.5;      ///< distance of the centres from the base's middle, in the plane [m]
  double furthest = 3.0;     ///< [m]
  double height = 1.2;       ///< upper bound of the centres' height, from 0 [m]
};

constexpr void describe(auto& v, Of<FalseDetections>) {
  using namespace disturbed;
  using T = FalseDetections;
  constexpr Range kPlace{0.0, 100.0};
  v.member("count", &T::count, about("", {0.0, 50.0}, "largest number at a time"));
  v.member("probability", &T::probability, about("1", kGain, "probability of each ball in each span of time"));
  v.member("duration", &T::duration, about("s", {1e-3, 3600.0}, "duration of a span"));
  v.member("radius", &T::radius, about("m", {1e-3, 10.0}, "radius of the balls"));
  v.member("nearest", &T::nearest,
           about("m", kPlace, "least distance of centres from the base's middle, in the plane"));
  v.member("furthest", &T::furthest, about("m", kPlace, "largest distance of centres from the base's middle"));
  v.member("height", &T::height, about("m", kPlace, "largest height of centres"));
}

/// Criterion of visibility. kRule: the rule below for one sensor that is not part of the robot file. kSensors: rays of
/// the robot's own sensors that end on the object.
enum class SeenBy { kRule, kSensors, kDepth };
constexpr auto words(Of<SeenBy>) { return std::to_array<std::string_view>({"rule", "sensors", "depth"}); }

/// Errors of the ranges of the robot's sensors: their standard deviation at the range r is noise + growth r^2
/// (Khoshelham & Elberink, Sensors 12(2), 2012, for the square).
struct RangeErrors {
  double noise = 0.0;    ///< [m]
  double growth = 0.0;   ///< [1/m]
  double missing = 0.0;  ///< probability that a ray has no measurement [1]
};

constexpr void describe(auto& v, Of<RangeErrors>) {
  using namespace disturbed;
  using T = RangeErrors;
  v.member("noise", &T::noise, about("m", kSpread, "noise of a range close by, per ray and frame"));
  v.member("growth", &T::growth, about("1/m", kSpread, "growth of that noise with the square of the range"));
  v.member("missing", &T::missing, about("1", kGain, "probability that a ray has no measurement"));
}

enum class SensorMount { kBase, kHand };
constexpr auto words(Of<SensorMount>) { return std::to_array<std::string_view>({"base", "hand"}); }

/// Detection: an object is found once it has been in range for the time `detection`, and stays found until the trial's
/// end. In range means near enough, in the field of view and not occluded.
struct DetectionRule {
  double range = std::numeric_limits<double>::infinity();  ///< [m]
  double detection = 0.0;                                  ///< [s]
  std::array<double, 3> sensor = {0.0, 0.0, 0.5};          ///< position in the base frame B [m]
  bool known_at_start = false;
  SensorMount mount = SensorMount::kBase;
  std::array<double, 3> axis = {1.0, 0.0, 0.0};   ///< in the same frame
  double field_of_view = 2.0 * std::numbers::pi;  ///< full angle of a cone about `axis` [rad]
  bool occlusion = false;
  bool lost = false;
  MissedDetections missed{};
  FalseDetections phantoms{};
  SeenBy seen_by = SeenBy::kRule;
  RangeErrors ranges{};
};

constexpr void describe(auto& v, Of<DetectionRule>) {
  using namespace disturbed;
  using T = DetectionRule;
  v.member(
      "seen_by", &T::seen_by,
      about("rule: within `range` of `sensor`; sensors: rays of the robot file's sensors end on the object; depth: "
            "no object is told, the controller gets the sensors' ranges"));
  v.member("ranges", &T::ranges, about("errors of these ranges"));
  v.member("range", &T::range, about("m", Range::non_negative_or_inf(), "range from `sensor` to the object's surface"));
  v.member("detection", &T::detection,
           about("s", {0.0, 3600.0}, "time in range, without a break, after which an object is found"));
  v.member("known_at_start", &T::known_at_start, about("objects in range at the first step are found at once"));
  v.member("sensor", &T::sensor, about("m", {-100.0, 100.0}, "position of the sensor in the frame of `mount`"));
  v.member("mount", &T::mount, about("the sensor moves with the base, or with the end effector"));
  v.member("axis", &T::axis, about("1", {-1.0, 1.0}, "viewing direction of the sensor, in the same frame"));
  v.member("field_of_view", &T::field_of_view,
           about("rad", {0.0, 2.0 * std::numbers::pi, true}, "full angle of the viewing cone"));
  v.member("occlusion", &T::occlusion, about("other objects and the robot occlude an object"));
  v.member("lost", &T::lost, about("a found object is visible only in range; false: until the end"));
  v.member("missed", &T::missed, about("missed detections"));
  v.member("phantoms", &T::phantoms, about("false detections"));
}

/// Dry friction of each joint, drawn for each joint, at most 0.95. Dynamic mode only.
struct JointFriction {
  double effort = 0.0;  ///< [1]
  double spread = 0.0;  ///< [1]
};

constexpr void describe(auto& v, Of<JointFriction>) {
  using namespace disturbed;
  v.member("effort", &JointFriction::effort, about("1", kFriction, "mean, as a share of the joint's effort limit"));
  v.member("spread", &JointFriction::spread, about("1", kFriction, "standard deviation"));
}

/// Between command and motion: the applied command of coordinate i at step k is (1 + g_i) command_i(k - delay),
/// followed with the time constant `lag`.
struct JointDrives {
  double delay = 0.0;       ///< [s]
  double gain_error = 0.0;  ///< standard deviation of g [1]
  JointFriction friction;
  Irregularity irregularity{};
  double lag = 0.0;  ///< [s]
};

constexpr void describe(auto& v, Of<JointDrives>) {
  using namespace disturbed;
  using T = JointDrives;
  v.member("delay", &T::delay,
           about("s", kDelay, "time from a command to its effect; nothing moves before the first command acts"));
  v.inlined(&T::irregularity);
  v.member("lag", &T::lag, about("s", kDelay, "time constant of the first-order lag with which a velocity follows"));
  v.member("gain_error", &T::gain_error,
           about("1", kGain, "standard deviation of g in v = (1 + g) command, per joint and trial"));
  v.member("friction", &T::friction, about("dry friction of each joint, per trial; dynamic mode"));
}

/// Standard deviations of g for the base's velocities [1].
struct GainSpread {
  double linear = 0.0;
  double angular = 0.0;
};

constexpr void describe(auto& v, Of<GainSpread>) {
  using namespace disturbed;
  v.member("linear", &GainSpread::linear, about("1", kGain, "standard deviation of g in v = (1 + g) command"));
  v.member("angular", &GainSpread::angular, about("1", kGain, "standard deviation of g for turning"));
}

/// Accelerations of a base's drive, as shares of the robot's base.max_acceleration, for increasing and decreasing
/// speed. An omnidirectional base's linear velocity is one vector.
struct BaseRamps {
  double speed_up = 1.0;   ///< [1]
  double slow_down = 1.0;  ///< [1]
};

constexpr void describe(auto& v, Of<BaseRamps>) {
  using namespace disturbed;
  using T = BaseRamps;
  v.member("speed_up", &T::speed_up,
           about("1", {0.0, 1.0, true}, "share of base.max_acceleration for increasing speed"));
  v.member("slow_down", &T::slow_down,
           about("1", {0.0, 1.0, true}, "share of base.max_acceleration for decreasing speed"));
}

struct BaseDrive {
  double delay = 0.0;  ///< [s]
  GainSpread gain_error;
  Irregularity irregularity{};
  TwistSpread deadband{};  ///< [m/s, rad/s]
  BaseRamps ramps{};
  double lag = 0.0;  ///< [s]
};

constexpr void describe(auto& v, Of<BaseDrive>) {
  using T = BaseDrive;
  using namespace disturbed;
  v.member("delay", &T::delay, about("s", kDelay, "as for joints"));
  v.inlined(&T::irregularity);
  v.member("lag", &T::lag, about("s", kDelay, "as for joints"));
  v.member("deadband", &T::deadband, about("commands up to this size do not move the base"));
  v.member("ramps", &T::ramps, about("accelerations below those of the robot file"));
  v.member("gain_error", &T::gain_error, about("gain errors of the base's velocities, per trial"));
}

struct Actuators {
  JointDrives joints;
  BaseDrive base;
};

constexpr void describe(auto& v, Of<Actuators>) {
  v.member("joints", &Actuators::joints, disturbed::about("the arm's drives"));
  v.member("base", &Actuators::base, disturbed::about("the base's drives"));
}

/// Control periods that the controller misses, as on a busy computer: the last command continues. The first period is
/// never missed. Sensors continue to measure.
struct ControlTicks {
  double missed = 0.0;  ///< [1]
};

constexpr void describe(auto& v, Of<ControlTicks>) {
  v.member("missed", &ControlTicks::missed,
           disturbed::about("1", disturbed::kFriction, "probability that the controller misses a period"));
}

/// A ball held at the end effector that the robot file does not contain. Its mass is never below 0. Dynamic mode only.
struct UnknownPayload {
  double mass = 0.0;                    ///< [kg]
  double spread = 0.0;                  ///< [kg]
  std::array<double, 3> position = {};  ///< [m]
};

constexpr void describe(auto& v, Of<UnknownPayload>) {
  using namespace disturbed;
  using T = UnknownPayload;
  v.member("mass", &T::mass, about("kg", kMass, "mean mass of a ball with the density of water"));
  v.member("spread", &T::spread, about("kg", kMass, "standard deviation, per trial"));
  v.member("position", &T::position, about("m", {-10.0, 10.0}, "centre of the ball in the end effector's frame"));
}

/// Friction between floor and driven wheels; for mecanum wheels it bounds their drive. Never below 0. Dynamic mode
/// only.
struct FloorFriction {
  double friction = 1.0;  ///< [1]
  double spread = 0.0;    ///< [1]
};

constexpr void describe(auto& v, Of<FloorFriction>) {
  using namespace disturbed;
  v.member("friction", &FloorFriction::friction, about("1", kSpread, "mean friction between floor and driven wheels"));
  v.member("spread", &FloorFriction::spread, about("1", kSpread, "standard deviation, per trial"));
}

/// The section `disturbances` of a suite: all errors between the simulated robot and its controller. All are off by
/// default. Each has its own stream of draws (streams.h).
struct Disturbances {
  std::uint64_t seed = 0;
  JointSensing joints;
  BaseSensing base;
  PoseSensing objects;
  DetectionRule detection;  ///< detection of objects
  PoseSensing goal;
  Actuators actuators;
  UnknownPayload payload;
  FloorFriction floor;
  ControlTicks control;
};

constexpr void describe(auto& v, Of<Disturbances>) {
  using disturbed::about;
  using T = Disturbances;
  v.member("seed", &T::seed,
           about("", {0.0, 0xffffffff}, "seed of the disturbances, for other draws in the same worlds"));
  v.member("joints", &T::joints, about("the arm's encoders"));
  v.member("base", &T::base, about("sensing of the base's pose and velocity; no effect on a fixed base"));
  v.group("objects", "measurement and detection of objects", [](auto& group) {
    group.inlined(&T::objects);
    group.inlined(&T::detection);
  });
  v.member("goal", &T::goal, about("measurement of the goal"));
  v.member("actuators", &T::actuators, about("drives between command and motion"));
  v.member("payload", &T::payload, about("payload at the end effector, unknown to the controller; dynamic mode"));
  v.member("floor", &T::floor, about("dynamic mode"));
  v.member("control", &T::control, about("missed control periods, in which the last command continues"));
}

/// True if a part of the disturbances is as by default: it switches nothing on.
template <class Part>
bool is_off(const Part& part) {
  return same(part, Part{});
}
/// True if the controller sees anything but the true state. Seed, frames and the sensor's position alone switch nothing
/// on.
bool senses_with_errors(const Disturbances& disturbances);
/// True if the applied command may differ from the controller's.
bool acts_with_errors(const Disturbances& disturbances);
/// True if the physics may differ from the robot file's. The payload's position alone switches nothing on.
bool moves_with_errors(const Disturbances& disturbances);
inline bool any(const Disturbances& d) {
  return senses_with_errors(d) || acts_with_errors(d) || moves_with_errors(d) || !is_off(d.control);
}

/// Returns the least number of control periods that last at least `delay` [s], with a tolerance of a billionth of a
/// period for rounding.
long delay_steps(double delay, double control_period);

}  // namespace moma
