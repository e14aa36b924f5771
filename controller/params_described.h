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
            .text = "sideways part where an obstacle is touched head-on, in units of |nu_lin|"});
  v.member("distance", &VortexParams::distance,
           {.unit = "m", .range = Range::positive(), .text = "of the obstacles that count"});
  v.member("when", &VortexParams::when, {.text = "once the robot has stagnated, or always"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ServoParams>) {
  v.member("position", &ServoParams::position, {.unit = "1/s", .range = Range::non_negative(), .text = "k_p"});
  v.member("orientation", &ServoParams::orientation, {.unit = "1/s", .range = Range::non_negative(), .text = "k_R"});
  v.member("max_linear", &ServoParams::max_linear,
           {.unit = "m/s", .range = Range::positive_or_inf(), .text = "clamp of nu's linear part in length"});
  v.member("max_angular", &ServoParams::max_angular,
           {.unit = "rad/s", .range = Range::positive_or_inf(), .text = "clamp of nu's angular part in length"});
  v.member(
      "error", &ServoParams::error,
      {.written = Written::kUnlessDefault,
       .text = "e_R: the rotation vector, or roll, pitch and yaw of the goal seen from E, as published code has it"});
  v.optional("vortex", &ServoParams::vortex, &VortexParams::enabled, Off::kNone,
             "a sideways part of nu along obstacles");
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ErrorNormParams>) {
  v.member("kind", &ErrorNormParams::kind, {.text = "of ||e|| in the weights"});
  v.member("min", &ErrorNormParams::min, {.range = Range::positive(), .text = "||e|| is clamped from below"});
  v.member("max", &ErrorNormParams::max, {.range = Range::positive(), .text = "and from above"});
  v.member("scale", &ErrorNormParams::scale,
           {.unit = "m/rad", .range = Range::non_negative(), .text = "of |e_R| in the pose norm"});
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
  v.member("weight", &ManipulabilityParams::weight, {.range = Range::non_negative(), .text = "lambda_m"});
  v.member("rows", &ManipulabilityParams::rows, {.text = "of the arm's Jacobian that count"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<JointLimitParams>) {
  v.member("method", &JointLimitParams::method,
           {.text = "the article's S+-, a damper, what can be braked, or nothing"});
  v.word_or("margin", "auto", &JointLimitParams::auto_margin, &JointLimitParams::margin,
            {.unit = "rad or m",
             .range = Range::positive(),
             .per = Per::kJoint,
             .one_for_all = true,
             .text = "q_s of the article; auto: min(0.3, a quarter of the joint's range)"});
  v.member("influence", &JointLimitParams::influence,
           {.unit = "rad or m", .range = Range::positive(), .text = "rho_i of the damper"});
  v.member("stop", &JointLimitParams::stop,
           {.unit = "rad or m", .range = Range::non_negative(), .text = "rho_s: room that is left to the limit"});
  v.member("gain", &JointLimitParams::gain,
           {.unit = "rad/s or m/s", .range = Range::positive(), .text = "eta of the damper"});
  v.member("share", &JointLimitParams::share,
           {.range = {0.0, 1.0, true, false},
            .written = Written::kUnlessDefault,
            .text = "part of the acceleration limit with which `braking` brakes"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<DamperParams>) {
  v.member("enabled", &DamperParams::enabled, {.text = "whether there are such rows"});
  v.member("influence", &DamperParams::influence, {.unit = "m", .range = Range::positive(), .text = "d_i"});
  v.member("stop", &DamperParams::stop, {.unit = "m", .range = Range::non_negative(), .text = "d_s"});
  v.member("gain", &DamperParams::gain, {.unit = "m/s", .range = Range::positive(), .text = "xi"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<PassingParams>) {
  v.member("horizon", &PassingParams::horizon,
           {.unit = "s",
            .range = Range::positive(),
            .text = "a gap may be used up in no less than this, on a wrong course"});
  v.member("clearance", &PassingParams::clearance,
           {.unit = "m", .range = Range::non_negative(), .text = "room that is left as they pass"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<CollisionParams>) {
  v.inlined(&CollisionParams::object);
  v.member("max_pairs", &CollisionParams::max_pairs, {.range = {0, 10000}, .text = "of rows, nearest first"});
  v.member("end_rows", &CollisionParams::end_rows,
           {.unit = "m",
            .range = Range::non_negative(),
            .text = "object pairs closer than this also have rows for their capsules' ends; 0: none"});
  v.optional("passing", &CollisionParams::passing, &PassingParams::enabled, Off::kOmitted,
             "rows that let objects in motion pass on one side of the base");
  v.member("floor", &CollisionParams::floor, {.text = "rows against the floor"});
  v.member("self", &CollisionParams::self, {.text = "rows between the robot's own shapes"});
  v.optional("braking", &CollisionParams::braking, &BrakingParams::enabled, Off::kOmitted,
             "rows know from which speeds the robot can still stop");
  v.member("relaxation", &CollisionParams::relaxation,
           {.written = Written::kUnlessDefault, .text = "how rows give way that cannot all be kept"});
  v.optional("check", &CollisionParams::check, &BrakeCheckParams::enabled, Off::kOmitted,
             "commands from which braking comes too near to something at rest give way");
  v.optional("separation", &CollisionParams::separation, &SeparationParams::enabled, Off::kOmitted,
             "the robot slows down towards what moves, by the distance of ISO/TS 15066 and ISO 13855");
  v.optional("evasion", &CollisionParams::evasion, &EvasionParams::enabled, Off::kOmitted,
             "the base drives out of the way of what moves before there is no way out left");
  v.optional("at_goal", &CollisionParams::at_goal, &GoalClearanceParams::enabled, Off::kOmitted,
             "distances to objects at rest shrink towards what the goal's own pose needs");
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<PostureParams>) {
  v.member("weight", &PostureParams::weight, {.range = Range::non_negative(), .text = "lambda_qd"});
  v.member("gain", &PostureParams::gain, {.unit = "1/s", .range = Range::non_negative(), .text = "k_posture"});
  v.word_or("target", "ready", &PostureParams::ready, &PostureParams::target,
            {.unit = "rad or m", .per = Per::kJoint, .text = "where the joints are drawn to"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<AroundParams>) {
  v.member("clearance", &AroundParams::clearance,
           {.unit = "m", .range = Range::non_negative(), .text = "beyond the base's footprint"});
  v.member("reach", &AroundParams::reach,
           {.unit = "m", .range = Range::non_negative(), .text = "the last metres to the goal that are the arm's"});
  v.member("passed", &AroundParams::passed,
           {.unit = "m", .range = Range::positive(), .text = "horizontal distance of E at which a corner is passed"});
  v.member("duration", &AroundParams::duration,
           {.unit = "s", .range = Range::positive(), .text = "of a detour around"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<EscapeParams>) {
  v.member("scale", &EscapeParams::scale,
           {.unit = "m/rad",
            .range = Range::non_negative(),
            .text = "of the orientation's error in V = |e_p| + scale |e_R|"});
  v.member("progress", &EscapeParams::progress,
           {.unit = "m", .range = Range::positive(), .text = "V has to fall this far below its best"});
  v.member("patience", &EscapeParams::patience, {.unit = "s", .range = Range::positive(), .text = "within this time"});
  v.member("traffic_patience", &EscapeParams::traffic_patience,
           {.unit = "s", .range = Range::positive(), .text = "or within this one while an object that moves is near"});
  v.member("position", &EscapeParams::position,
           {.unit = "m", .range = Range::non_negative(), .text = "a pose this near to the goal does not stagnate"});
  v.member("orientation", &EscapeParams::orientation,
           {.unit = "rad", .range = Range::non_negative(), .text = "nor does one turned by less than this"});
  v.member("side_distance", &EscapeParams::side_distance,
           {.unit = "m", .range = Range::positive(), .text = "of the obstacles that decide the side"});
  v.member("angle", &EscapeParams::angle,
           {.unit = "rad", .range = Range::non_negative(), .text = "from the goal's direction to a detour's"});
  v.member("length", &EscapeParams::length,
           {.unit = "m", .range = Range::positive(), .text = "from the base to a detour's target"});
  v.member(
      "growth", &EscapeParams::growth,
      {.unit = "1", .range = Range::non_negative(), .text = "of length and duration from each detour to the next"});
  v.member("max_length", &EscapeParams::max_length,
           {.unit = "m", .range = Range::positive(), .text = "no detour's target is further"});
  v.member("duration", &EscapeParams::duration, {.unit = "s", .range = Range::positive(), .text = "of a detour"});
  v.member("reached", &EscapeParams::reached,
           {.unit = "m",
            .range = Range::non_negative(),
            .text = "horizontal distance to its target at which a detour ends"});
  v.member(
      "slack_factor", &EscapeParams::slack_factor,
      {.unit = "1", .range = Range::positive(), .text = "on the slack weight of the angular rows during a detour"});
  v.group("posture", "the arm's posture during a detour", [](auto& g) {
    g.member("weight", &EscapeParams::posture_weight,
             {.range = Range::non_negative(), .text = "pull of the arm to `ready` during a detour"});
    g.member("gain", &EscapeParams::posture_gain,
             {.unit = "1/s", .range = Range::non_negative(), .text = "its k_posture"});
  });
  v.optional("around", &EscapeParams::around, &AroundParams::enabled, Off::kOmitted,
             "detours that follow the shortest way around the obstacles, seen from above");
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ClosedFormParams>) {
  v.member("damping", &ClosedFormParams::damping,
           {.range = Range::non_negative(), .text = "at a singularity; 0: the plain pseudo-inverse"});
  v.member("scaled", &ClosedFormParams::scaled, {.text = "commands are scaled into the velocity limits"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<SeparateParams>) {
  v.member("reach", &SeparateParams::reach,
           {.unit = "m",
            .range = Range::positive(),
            .text = "horizontal distance of the goal from the base's origin where the base stands"});
  v.member("tolerance", &SeparateParams::tolerance, {.unit = "m", .range = Range::positive(), .text = "of that"});
  v.member(
      "bearing", &SeparateParams::bearing,
      {.unit = "rad", .range = Range::positive(), .text = "within which the goal lies ahead of a base that stands"});
  v.member("gain", &SeparateParams::gain, {.unit = "1/s", .range = Range::positive(), .text = "of the base's drive"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<OutputScalingParams>) {
  v.member("far", &OutputScalingParams::far, {.range = Range::positive(), .text = "qdot *= far/e beyond `switch`"});
  v.member("near", &OutputScalingParams::near, {.range = Range::positive(), .text = "qdot *= near nearer than that"});
  v.member("switch", &OutputScalingParams::switch_distance,
           {.range = Range::positive(), .text = "of the error's norm, not clamped"});
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<ControllerParams>) {
  v.member("method", &ControllerParams::method, {.text = "the QP, or one of the closed forms"});
  v.member("servo", &ControllerParams::servo, {.text = "the twist that E is asked for"});
  v.member("error_norm", &ControllerParams::error_norm, {.text = "||e|| in the weights"});
  v.member("base_weight", &ControllerParams::base_weight,
           {.range = Range::non_negative(), .text = "w_b: 1/||e|| or a constant"});
  v.member(
      "lambda_q", &ControllerParams::lambda_q,
      {.range = Range::non_negative(), .per = Per::kJoint, .one_for_all = true, .text = "lambda_qa; default 0.01"});
  v.optional("slack", &ControllerParams::slack, &SlackParams::enabled, Off::kNone,
             "delta of the tracking rows; none: they are hard");
  v.member("tracking_band", &ControllerParams::tracking_band,
           {.unit = "rad/s or m/s",
            .range = Range::non_negative(),
            .one_for_all = true,
            .text = "Delta of the tracking rows, angular rows first"});
  v.member("k_epsilon", &ControllerParams::k_epsilon,
           {.range = Range::non_negative(), .text = "turns a differential base towards E"});
  v.member("manipulability", &ControllerParams::manipulability, {.text = "the term that keeps the arm dexterous"});
  v.member("joint_limits", &ControllerParams::joint_limits, {.text = "how velocities give way to joint limits"});
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
              .text = "of each velocity; default .inf"});
    g.member("base", &ControllerParams::base_share,
             {.unit = "1",
              .range = {0.0, 1.0},
              .written = Written::kUnlessDefault,
              .text = "share of the robot's base.max_acceleration that holds in every stage; 0: as of acceleration"});
    g.optional("sight", &ControllerParams::sight, &SightParams::enabled, Off::kOmitted,
               "the base's speed, so that it stops in front of what comes into sight");
  });
  v.optional("prediction", &ControllerParams::prediction, &PredictionParams::enabled, Off::kOmitted,
             "the controller is given the state in which its command takes effect");
  v.optional("uncertainty", &ControllerParams::uncertainty, &UncertaintyParams::enabled, Off::kOmitted,
             "rows keep a margin for what is not known exactly");
  v.optional("output_scaling", &ControllerParams::output_scaling, &OutputScalingParams::enabled, Off::kNone,
             "scales the command as a whole (holistic)");
  v.optional("escape", &ControllerParams::escape, &EscapeParams::enabled, Off::kKept,
             "detours that lead out of local minima; stagnation is watched for the vortex, too");
  v.optional("plan", &ControllerParams::plan, &PlanParams::enabled, Off::kOmitted,
             "looking ahead: predictions, detours tried in them, and planned paths of base and arm");
  v.member("closed_form", &ControllerParams::closed_form,
           {.written = Written::kUnlessDefault, .text = "how rrmc, park and baur answer singularities and limits"});
  v.optional("separate", &ControllerParams::separate, &SeparateParams::enabled, Off::kOmitted,
             "the base drives to where the goal is in reach and stands there; then the arm moves");
  v.member("solver", &ControllerParams::solver, {.text = "of the QP"});
}

static_assert(is_complete<ControllerParams>(), "a parameter has no line in its description");

}  // namespace moma
