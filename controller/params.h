#pragma once

#include <limits>
#include <string>
#include <vector>

#include "controller/describe/enumeration.h"
#include "controller/map/params.h"
#include "controller/model/manipulability.h"
#include "controller/model/robot_model.h"
#include "controller/plan/plan_params.h"
#include "controller/safe/params.h"
#include "controller/types.h"

namespace moma {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class Method { kQp, kRrmc, kPark, kBaur };
constexpr auto words(Of<Method>) { return std::to_array<std::string_view>({"qp", "rrmc", "park", "baur"}); }

enum class ErrorNormKind { kEuclidean, kL1, kPose };
constexpr auto words(Of<ErrorNormKind>) { return std::to_array<std::string_view>({"euclidean", "l1", "pose"}); }

enum class JointLimitMethod { kSource, kDamper, kBraking, kNone };
constexpr auto words(Of<JointLimitMethod>) {
  return std::to_array<std::string_view>({"source", "damper", "braking", "none"});
}

/// One word; the text of a controller, and so the key of a stored trial, names it.
enum class SolverKind { kDaqp };
constexpr auto words(Of<SolverKind>) { return std::to_array<std::string_view>({"daqp"}); }

enum class ServoError { kRotationVector, kRpy };
constexpr auto words(Of<ServoError>) { return std::to_array<std::string_view>({"rotation_vector", "rpy"}); }

/// k_p, k_R [1/s]; clamps of the two parts of nu in length [m/s, rad/s].
struct ServoParams {
  double position = 1.5;
  double orientation = 1.95;
  double max_linear = kInfinity;
  double max_angular = kInfinity;
  ServoError error = ServoError::kRotationVector;
  double pass_from = 0.3;    ///< distance from which on E keeps its speed towards a goal that is passed [m]
  double pass_factor = 3.0;  ///< largest factor on the gains there
};

/// ||e|| in the weights, clamped to [min, max]; `scale` [m/rad] enters the pose norm only.
struct ErrorNormParams {
  ErrorNormKind kind = ErrorNormKind::kEuclidean;
  double min = 0.001;
  double max = 10.0;
  double scale = 1.0;
};

/// A weight that is 1/||e|| or a constant >= 0.
struct Weight {
  bool inverse_error = true;
  double value = 0.0;  ///< value unless inverse_error
};

struct SlackParams {
  bool enabled = true;  ///< false: `slack: none`, tracking is a hard equality (mmc of 2020)
  Weight weight;
  Vector6 limit = Vector6::Constant(10.0);  ///< |delta| bounds, infinite allowed
};

struct ManipulabilityParams {
  double weight = 1.0;  ///< lambda_m
  ManipulabilityRows rows = ManipulabilityRows::kTranslation;
};

/// q_s per joint [rad, m]; `automatic`: min(0.3, a quarter of the joint's range), which resolved() fills in.
struct JointMargin {
  bool automatic = true;
  VectorX value;
};

/// `source`: the article's S+-, margin q_s per joint; `damper`: eta (rho - rho_s)/(rho_i - rho_s) inside rho_i;
/// `braking`: the speed from which `share` of the acceleration limit still stops the joint at rho_s, and acceleration
/// limits of all joints hold in every stage of the fallback.
struct JointLimitParams {
  JointLimitMethod method = JointLimitMethod::kSource;
  JointMargin margin;      ///< `source` only
  double influence = 0.9;  ///< rho_i
  double stop = 0.1;       ///< rho_s
  double gain = 1.0;       ///< eta; with `braking` the rate of the way back from beyond rho_s [1/s]
  double share = 0.8;      ///< share of the acceleration limit; `braking` only
};

struct DamperParams {
  bool enabled = true;
  double influence = 0.1;  ///< d_i [m]
  double stop = 0.01;      ///< d_s [m]
  double gain = 1.0;       ///< xi [m/s]
};

struct CollisionParams {
  DamperParams object{true, 0.3, 0.05, 1.0};
  int max_pairs = 30;
  double moving_room = 0.0;  ///< [m]
  double away = 0.0;         ///< weight of the cost of approaching objects (qp/terms.cc)
  DamperParams floor;
  DamperParams self;
  BrakingParams braking;
  Relaxation relaxation = Relaxation::kCommon;
  BrakeCheckParams check;
  SeparationParams separation;
  EvasionParams evasion;
  GoalClearanceParams at_goal;
};

/// Joint values; `ready`: those of the robot, which resolved() fills in.
struct PostureTarget {
  bool ready = true;
  VectorX value;
};

struct PostureParams {
  double weight = 0.0;  ///< lambda_qd
  double gain = 1.0;    ///< k_posture [1/s]
  PostureTarget target;
};

/// How the robot keeps Observation::upright: the row of the tilt (qp/upright.h), and the plans.
struct UprightParams {
  bool enabled = false;
  double gain = 3.0;     ///< [1/s]
  double margin = 0.15;  ///< share of the angle that the row keeps
  double plan = 0.75;    ///< share of the angle up to which plans tilt the tool
};

/// Stagnation and detours (task/escape.h).
struct EscapeParams {
  bool enabled = false;
  double scale = 0.3;            ///< factor on the orientation error in V = |e_p| + scale |e_R| [m/rad]
  double progress = 0.01;        ///< V has to fall this far below its minimum ... [m]
  double patience = 1.0;         ///< ... within this time [s]
  double position = 0.02;        ///< a pose this near to the goal does not stagnate [m]
  double orientation = 0.05;     ///< [rad]
  double side_distance = 0.15;   ///< range of the obstacles that decide the side [m]
  double angle = 2.0;            ///< angle between the goal's direction and a detour's [rad]
  double length = 0.75;          ///< distance from the base to a detour's target [m]
  double growth = 0.2;           ///< relative growth of length and duration from each detour to the next
  double max_length = 2.5;       ///< [m]
  double duration = 1.7;         ///< longest time of a detour [s]
  double reached = 0.05;         ///< horizontal distance to its target at which a detour ends [m]
  double slack_factor = 0.005;   ///< factor on the slack weight of the angular rows during a detour
  double posture_weight = 0.05;  ///< weight of `ready` as the arm's posture during a detour
  double posture_gain = 1.2;     ///< [1/s]
  double jump = 0.1;             ///< distance of a new goal from the old one's predicted pose [m]
  double jump_angle = 0.2;       ///< or its angle from that pose [rad]
};

/// Singularities and speed limits in rrmc, park and baur (closed_form/closed_form.h).
struct ClosedFormParams {
  double damping = 0.05;  ///< damping at a singularity; 0: the pseudo-inverse
  bool scaled = true;     ///< scale into the velocity limits; otherwise a command may exceed them
};

/// Separate motion of base and arm (task/servo.h).
struct BaseFirstParams {
  bool enabled = false;
  double reach = 0.65;      ///< horizontal distance from the base's origin to the goal at which the base stands [m]
  double tolerance = 0.03;  ///< tolerance of `reach` [m]
  double bearing = 0.1;     ///< largest bearing of a goal ahead of the base [rad]
  double gain = 1.5;        ///< [1/s]
};

/// qdot *= far/e beyond `switch_distance`, else near; e the unclamped norm; the result is clipped to the bounds.
struct OutputScalingParams {
  bool enabled = false;
  double far = 0.7;
  double near = 1.4;
  double switch_distance = 0.5;
};

/// All parameters that determine a controller's command besides robot and period. Names, units and defaults are those
/// of configs/controllers/*.yaml. Vectors "per joint" or "per velocity" get their full size when read.
struct ControllerParams {
  Method method = Method::kQp;
  ServoParams servo;
  ErrorNormParams error_norm;
  Weight base_weight;  ///< w_b
  VectorX lambda_q;    ///< per joint; default 0.01
  SlackParams slack;
  Vector6 tracking_band = Vector6::Zero();  ///< Delta
  double k_epsilon = 0.5;
  ManipulabilityParams manipulability;
  JointLimitParams joint_limits;
  CollisionParams collision;
  VectorX acceleration_weight;  ///< lambda_qdd per velocity; default 0
  PostureParams posture;
  UprightParams upright;
  VectorX acceleration_limit;  ///< per velocity, default infinite [rad/s^2, m/s^2]
  double base_share = 0.0;  ///< share of the robot's own base.max_acceleration, in every stage; 0: `acceleration_limit`
  double joint_share = 0.0;  ///< share of the joints' own accelerations, where known; 0: `acceleration_limit`
  SightParams sight;
  PredictionParams prediction;
  UncertaintyParams uncertainty;
  MapParams map;
  OutputScalingParams output_scaling;
  EscapeParams escape;
  PlanParams plan;
  ClosedFormParams closed_form;
  BaseFirstParams base_first;
  SolverKind solver = SolverKind::kDaqp;
};

/// Returns the parameters with every vector at its full size for this robot: empty ones get their defaults, the
/// posture's target comes from `ready`, an automatic margin is computed. Rows that know braking begin where the base
/// can still stop.
ControllerParams resolved(ControllerParams params, const RobotModel& model);

/// An error in parameters or, as a warning, a doubtful value; `key` is dotted as in the files.
struct ParamsIssue {
  std::string key;
  std::string message;
  bool warning = false;
};

/// Checks resolved parameters for this robot and control period [s]: sizes, ranges, margins shorter than a step,
/// weights that leave nothing to solve. Empty if all is well.
std::vector<ParamsIssue> check_params(const ControllerParams& params, const RobotModel& model, double control_period);

}  // namespace moma
