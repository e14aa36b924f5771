#pragma once

#include <string_view>

#include "controller/describe/complete.h"
#include "controller/describe/describe.h"
#include "controller/params.h"

namespace moma {

// Description of all parameters (describe/describe.h): keys, units, ranges and omissions in files. A new gain is its
// member in params.h, its line here, and its use; a member without a line does not compile. Members added after the
// first stores are written only if used (Off::kOmitted, Written::kUnlessDefault), so that the keys of trials without
// them do not change.

constexpr auto alternative(Of<Weight>) { return WordOr{"inverse_error", &Weight::inverse_error, &Weight::value}; }

/// `joint_limits: none`.
inline bool from_word(std::string_view word, JointLimitParams& params) {
  if (word != to_string(JointLimitMethod::kNone)) return false;
  params.method = JointLimitMethod::kNone;
  return true;
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<VortexParams>) {
  v.member("gain", &VortexParams::gain,
           {.unit = "1",
            .range = Range::non_negative(),
            .text = "sideways part if an obstacle touches head-on, in units of |nu_lin|"});
  v.member("distance", &VortexParams::distance,
           {.unit = "m", .range = Range::positive(), .text = "range of the obstacles that count"});
  v.member("when", &VortexParams::when, {.text = "after the first stagnation, or always"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ServoParams>) {
  v.member("position", &ServoParams::position,
           {.unit = "1/s", .range = Range::non_negative(), .text = "k_p: gain of the position error"});
  v.member("orientation", &ServoParams::orientation,
           {.unit = "1/s", .range = Range::non_negative(), .text = "k_R: gain of the orientation error"});
  v.member("max_linear", &ServoParams::max_linear,
           {.unit = "m/s", .range = Range::positive_or_inf(), .text = "largest length of nu's linear part"});
  v.member("max_angular", &ServoParams::max_angular,
           {.unit = "rad/s", .range = Range::positive_or_inf(), .text = "largest length of nu's angular part"});
  v.member(
      "error", &ServoParams::error,
      {.written = Written::kUnlessDefault,
       .text = "e_R: the rotation vector, or roll, pitch and yaw of the goal as seen from E, as in published code"});
  v.optional("vortex", &ServoParams::vortex, &VortexParams::enabled, Off::kNone, "sideways part of nu along obstacles");
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ErrorNormParams>) {
  v.member("kind", &ErrorNormParams::kind, {.text = "norm of the error in the weights"});
  v.member("min", &ErrorNormParams::min, {.range = Range::positive(), .text = "least value of ||e||"});
  v.member("max", &ErrorNormParams::max, {.range = Range::positive(), .text = "largest value of ||e||"});
  v.member("scale", &ErrorNormParams::scale,
           {.unit = "m/rad", .range = Range::non_negative(), .text = "factor on |e_R| in the pose norm"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<SlackParams>) {
  v.member("weight", &SlackParams::weight,
           {.range = Range::non_negative(), .text = "lambda_delta: 1/||e|| or a constant"});
  v.member("limit", &SlackParams::limit,
           {.unit = "rad/s or m/s",
            .range = Range::positive_or_inf(),
            .one_for_all = true,
            .text = "bounds of delta, angular rows first"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ManipulabilityParams>) {
  v.member("weight", &ManipulabilityParams::weight, {.range = Range::non_negative(), .text = "lambda_m: weight"});
  v.member("rows", &ManipulabilityParams::rows, {.text = "rows of the arm's Jacobian"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<JointLimitParams>) {
  v.member("method", &JointLimitParams::method,
           {.text = "law: the article's S+-, a damper, speeds that can be braked, or none"});
  v.word_or("margin", "auto", &JointLimitParams::auto_margin, &JointLimitParams::margin,
            {.unit = "rad or m",
             .range = Range::positive(),
             .per = Per::kJoint,
             .one_for_all = true,
             .text = "q_s of the article; auto: min(0.3, a quarter of the joint's range)"});
  v.member("influence", &JointLimitParams::influence,
           {.unit = "rad or m",
            .range = Range::positive(),
            .text = "rho_i: distance from a limit at which the damper begins"});
  v.member("stop", &JointLimitParams::stop,
           {.unit = "rad or m", .range = Range::non_negative(), .text = "rho_s: distance kept from the limit"});
  v.member("gain", &JointLimitParams::gain,
           {.unit = "rad/s or m/s", .range = Range::positive(), .text = "eta of the damper"});
  v.member("share", &JointLimitParams::share,
           {.range = {0.0, 1.0, true, false},
            .written = Written::kUnlessDefault,
            .text = "share of the acceleration limit with which `braking` brakes"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<DamperParams>) {
  v.member("enabled", &DamperParams::enabled, {.text = "switches these rows on"});
  v.member("influence", &DamperParams::influence,
           {.unit = "m", .range = Range::positive(), .text = "d_i: distance below which a pair has a row"});
  v.member("stop", &DamperParams::stop, {.unit = "m", .range = Range::non_negative(), .text = "d_s: stop distance"});
  v.member("gain", &DamperParams::gain,
           {.unit = "m/s", .range = Range::positive(), .text = "xi: speed of approach allowed at d_i"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<PassingParams>) {
  v.member(
      "horizon", &PassingParams::horizon,
      {.unit = "s", .range = Range::positive(), .text = "least time in which a gap on a collision course may close"});
  v.member("clearance", &PassingParams::clearance,
           {.unit = "m", .range = Range::non_negative(), .text = "distance kept while passing"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<CollisionParams>) {
  v.inlined(&CollisionParams::object);
  v.member("max_pairs", &CollisionParams::max_pairs,
           {.range = {0, 10000}, .text = "largest number of pairs with rows, nearest first"});
  v.member("end_rows", &CollisionParams::end_rows,
           {.unit = "m",
            .range = Range::non_negative(),
            .text = "object pairs closer than this also have rows for their capsules' ends; 0: none"});
  v.optional("passing", &CollisionParams::passing, &PassingParams::enabled, Off::kOmitted,
             "passing rows: moving objects pass on one side of the base");
  v.member("floor", &CollisionParams::floor, {.text = "rows against the floor"});
  v.member("self", &CollisionParams::self, {.text = "rows between the robot's own shapes"});
  v.optional("braking", &CollisionParams::braking, &BrakingParams::enabled, Off::kOmitted,
             "rows bound speeds by those from which the robot can still stop");
  v.member("relaxation", &CollisionParams::relaxation,
           {.written = Written::kUnlessDefault, .text = "relaxation of rows that contradict each other"});
  v.optional("check", &CollisionParams::check, &BrakeCheckParams::enabled, Off::kOmitted,
             "check ahead: scales down commands whose backup trajectory comes too near to objects at rest");
  v.optional(
      "separation", &CollisionParams::separation, &SeparationParams::enabled, Off::kOmitted,
      "separation rows: the robot slows down towards moving objects by the distance of ISO/TS 15066 and ISO 13855");
  v.optional("evasion", &CollisionParams::evasion, &EvasionParams::enabled, Off::kOmitted,
             "evasion: the base drives away from moving objects while it still can");
  v.optional("at_goal", &CollisionParams::at_goal, &GoalClearanceParams::enabled, Off::kOmitted,
             "distances to objects at rest shrink towards those of the goal's own pose");
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<PostureParams>) {
  v.member("weight", &PostureParams::weight, {.range = Range::non_negative(), .text = "lambda_qd: weight"});
  v.member(
      "gain", &PostureParams::gain,
      {.unit = "1/s", .range = Range::non_negative(), .text = "k_posture: rate of the joints towards the posture"});
  v.word_or("target", "ready", &PostureParams::ready, &PostureParams::target,
            {.unit = "rad or m", .per = Per::kJoint, .text = "posture to which the joints are drawn"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<AroundParams>) {
  v.member("clearance", &AroundParams::clearance,
           {.unit = "m", .range = Range::non_negative(), .text = "distance kept beyond the base's footprint"});
  v.member("reach", &AroundParams::reach,
           {.unit = "m", .range = Range::non_negative(), .text = "last part of the way, which the arm covers"});
  v.member("passed", &AroundParams::passed,
           {.unit = "m", .range = Range::positive(), .text = "horizontal distance of E at which a corner is passed"});
  v.member("duration", &AroundParams::duration,
           {.unit = "s", .range = Range::positive(), .text = "longest time of a detour around"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<EscapeParams>) {
  v.member("scale", &EscapeParams::scale,
           {.unit = "m/rad",
            .range = Range::non_negative(),
            .text = "factor on the orientation error in V = |e_p| + scale |e_R|"});
  v.member(
      "progress", &EscapeParams::progress,
      {.unit = "m", .range = Range::positive(), .text = "decrease of V below its minimum that counts as progress"});
  v.member("patience", &EscapeParams::patience,
           {.unit = "s", .range = Range::positive(), .text = "time without progress after which the robot stagnates"});
  v.member("traffic_patience", &EscapeParams::traffic_patience,
           {.unit = "s", .range = Range::positive(), .text = "the same while a moving object is near"});
  v.member(
      "position", &EscapeParams::position,
      {.unit = "m", .range = Range::non_negative(), .text = "position error below which the robot does not stagnate"});
  v.member("orientation", &EscapeParams::orientation,
           {.unit = "rad",
            .range = Range::non_negative(),
            .text = "orientation error below which the robot does not stagnate"});
  v.member("side_distance", &EscapeParams::side_distance,
           {.unit = "m", .range = Range::positive(), .text = "range of the obstacles that decide the side"});
  v.member(
      "angle", &EscapeParams::angle,
      {.unit = "rad", .range = Range::non_negative(), .text = "angle between the goal's direction and a detour's"});
  v.member("length", &EscapeParams::length,
           {.unit = "m", .range = Range::positive(), .text = "distance from the base to a detour's target"});
  v.member("growth", &EscapeParams::growth,
           {.unit = "1",
            .range = Range::non_negative(),
            .text = "relative growth of length and duration from each detour to the next"});
  v.member("max_length", &EscapeParams::max_length,
           {.unit = "m", .range = Range::positive(), .text = "largest distance of a detour's target"});
  v.member("duration", &EscapeParams::duration,
           {.unit = "s", .range = Range::positive(), .text = "longest time of a detour"});
  v.member("reached", &EscapeParams::reached,
           {.unit = "m",
            .range = Range::non_negative(),
            .text = "horizontal distance to its target at which a detour ends"});
  v.member("slack_factor", &EscapeParams::slack_factor,
           {.unit = "1",
            .range = Range::positive(),
            .text = "factor on the slack weight of the angular rows during a detour"});
  v.group("posture", "the arm's posture during a detour", [](auto& g) {
    g.member("weight", &EscapeParams::posture_weight,
             {.range = Range::non_negative(), .text = "weight of `ready` as the arm's posture during a detour"});
    g.member("gain", &EscapeParams::posture_gain,
             {.unit = "1/s", .range = Range::non_negative(), .text = "k_posture during a detour"});
  });
  v.optional("around", &EscapeParams::around, &AroundParams::enabled, Off::kOmitted,
             "detours that follow the shortest way around the obstacles, seen from above");
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ClosedFormParams>) {
  v.member("damping", &ClosedFormParams::damping,
           {.range = Range::non_negative(), .text = "damping at a singularity; 0: the pseudo-inverse"});
  v.member("scaled", &ClosedFormParams::scaled, {.text = "commands are scaled into the velocity limits"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<SeparateParams>) {
  v.member("reach", &SeparateParams::reach,
           {.unit = "m",
            .range = Range::positive(),
            .text = "horizontal distance from the base's origin to the goal at which the base stands"});
  v.member("tolerance", &SeparateParams::tolerance,
           {.unit = "m", .range = Range::positive(), .text = "tolerance of `reach`"});
  v.member("bearing", &SeparateParams::bearing,
           {.unit = "rad", .range = Range::positive(), .text = "largest bearing of the goal at which the base stands"});
  v.member("gain", &SeparateParams::gain,
           {.unit = "1/s", .range = Range::positive(), .text = "gain of the base's motion"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<OutputScalingParams>) {
  v.member("far", &OutputScalingParams::far, {.range = Range::positive(), .text = "qdot *= far/e beyond `switch`"});
  v.member("near", &OutputScalingParams::near, {.range = Range::positive(), .text = "qdot *= near below `switch`"});
  v.member("switch", &OutputScalingParams::switch_distance,
           {.range = Range::positive(), .text = "unclamped norm of the error at which the factor changes"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ControllerParams>) {
  v.member("method", &ControllerParams::method, {.text = "the QP, or one of the closed forms"});
  v.member("servo", &ControllerParams::servo, {.text = "wanted twist of E"});
  v.member("error_norm", &ControllerParams::error_norm, {.text = "||e|| in the weights"});
  v.member("base_weight", &ControllerParams::base_weight,
           {.range = Range::non_negative(), .text = "w_b: 1/||e|| or a constant"});
  v.member(
      "lambda_q", &ControllerParams::lambda_q,
      {.range = Range::non_negative(), .per = Per::kJoint, .one_for_all = true, .text = "lambda_qa; default 0.01"});
  v.optional("slack", &ControllerParams::slack, &SlackParams::enabled, Off::kNone,
             "delta of the tracking rows; none: hard rows");
  v.member("tracking_band", &ControllerParams::tracking_band,
           {.unit = "rad/s or m/s",
            .range = Range::non_negative(),
            .one_for_all = true,
            .text = "Delta of the tracking rows, angular rows first"});
  v.member("k_epsilon", &ControllerParams::k_epsilon,
           {.range = Range::non_negative(), .text = "weight that turns a differential base towards E"});
  v.member("manipulability", &ControllerParams::manipulability, {.text = "the term that keeps the arm manipulable"});
  v.member("joint_limits", &ControllerParams::joint_limits, {.text = "bounds of velocities by joint limits"});
  v.member("collision", &ControllerParams::collision, {.text = "rows against collisions"});
  v.group("acceleration", "the term against acceleration", [](auto& g) {
    g.member(
        "weight", &ControllerParams::acceleration_weight,
        {.range = Range::non_negative(), .per = Per::kVelocity, .one_for_all = true, .text = "lambda_qdd; default 0"});
  });
  v.member("posture", &ControllerParams::posture, {.text = "the term that draws the joints to a posture"});
  v.group("limits", "bounds beyond the robot's own", [](auto& g) {
    g.member("acceleration", &ControllerParams::acceleration_limit,
             {.unit = "m/s^2 or rad/s^2",
              .range = Range::positive_or_inf(),
              .per = Per::kVelocity,
              .one_for_all = true,
              .text = "acceleration limit of each velocity; default .inf"});
    g.member("base", &ControllerParams::base_share,
             {.unit = "1",
              .range = {0.0, 1.0},
              .written = Written::kUnlessDefault,
              .text = "share of the robot's base.max_acceleration as a bound in every stage; 0: `acceleration`"});
    g.optional("sight", &ControllerParams::sight, &SightParams::enabled, Off::kOmitted,
               "bound on the base's speed: it can stop in front of objects that come into sight");
  });
  v.optional("prediction", &ControllerParams::prediction, &PredictionParams::enabled, Off::kOmitted,
             "the controller acts on the state in which its command takes effect");
  v.optional("uncertainty", &ControllerParams::uncertainty, &UncertaintyParams::enabled, Off::kOmitted,
             "rows keep a margin for errors of measurement");
  v.optional("output_scaling", &ControllerParams::output_scaling, &OutputScalingParams::enabled, Off::kNone,
             "scales the command as a whole (holistic)");
  v.optional("escape", &ControllerParams::escape, &EscapeParams::enabled, Off::kKept,
             "detours out of local minima; the vortex also uses stagnation");
  v.optional("plan", &ControllerParams::plan, &PlanParams::enabled, Off::kOmitted,
             "looking ahead: predictions, detours in prediction, and planned paths of base and arm");
  v.member("closed_form", &ControllerParams::closed_form,
           {.written = Written::kUnlessDefault, .text = "singularities and limits in rrmc, park and baur"});
  v.optional("separate", &ControllerParams::separate, &SeparateParams::enabled, Off::kOmitted,
             "separate motion: the base drives until the goal is in reach, then the arm moves");
  v.member("solver", &ControllerParams::solver, {.text = "solver of the QP"});
}

static_assert(is_complete<ControllerParams>(), "a parameter has no line in its description");

}  // namespace moma
