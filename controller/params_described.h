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
constexpr auto alternative(Of<JointMargin>) { return WordOr{"auto", &JointMargin::automatic, &JointMargin::value}; }
constexpr auto alternative(Of<PostureTarget>) { return WordOr{"ready", &PostureTarget::ready, &PostureTarget::value}; }

/// `joint_limits: none`.
inline bool from_word(std::string_view word, JointLimitParams& params) {
  if (word != to_string(JointLimitMethod::kNone)) return false;
  params.method = JointLimitMethod::kNone;
  return true;
}

constexpr void describe(auto& v, Of<ServoParams>) {
  using T = ServoParams;
  v.member("position", &T::position, non_negative("1/s", "k_p: gain of the position error"));
  v.member("orientation", &T::orientation, non_negative("1/s", "k_R: gain of the orientation error"));
  v.member("max_linear", &T::max_linear,
           in_range(Range::positive_or_inf(), "m/s", "largest length of nu's linear part"));
  v.member("max_angular", &T::max_angular,
           in_range(Range::positive_or_inf(), "rad/s", "largest length of nu's angular part"));
  v.member(
      "error", &T::error,
      unless_default(
          {.text =
               "e_R: the rotation vector, or roll, pitch and yaw of the goal as seen from E, as in published code"}));
  v.member(
      "pass_from", &T::pass_from,
      unless_default(positive("m", "distance from which on the hand keeps its speed towards a goal that it passes")));
  v.member("pass_factor", &T::pass_factor,
           unless_default(in_range({1.0, 1000.0}, "1", "largest factor on the gains from there on")));
}

constexpr void describe(auto& v, Of<ErrorNormParams>) {
  using T = ErrorNormParams;
  v.member("kind", &T::kind, {.text = "norm of the error in the weights"});
  v.member("min", &T::min, positive("", "least value of ||e||"));
  v.member("max", &T::max, positive("", "largest value of ||e||"));
  v.member("scale", &T::scale, non_negative("m/rad", "factor on |e_R| in the pose norm"));
}

constexpr void describe(auto& v, Of<SlackParams>) {
  v.member("weight", &SlackParams::weight, non_negative("", "lambda_delta: 1/||e|| or a constant"));
  v.member("limit", &SlackParams::limit,
           {.unit = "rad/s or m/s",
            .range = Range::positive_or_inf(),
            .one_for_all = true,
            .text = "bounds of delta, angular rows first"});
}

constexpr void describe(auto& v, Of<ManipulabilityParams>) {
  v.member("weight", &ManipulabilityParams::weight, non_negative("", "lambda_m: weight"));
  v.member("rows", &ManipulabilityParams::rows, {.text = "rows of the arm's Jacobian"});
}

constexpr void describe(auto& v, Of<JointLimitParams>) {
  using T = JointLimitParams;
  v.member("method", &T::method, {.text = "law: the article's S+-, a damper, speeds that can be braked, or none"});
  v.member("margin", &T::margin,
           {.unit = "rad or m",
            .range = Range::positive(),
            .per = Per::kJoint,
            .one_for_all = true,
            .text = "q_s of the article; auto: min(0.3, a quarter of the joint's range)"});
  v.member("influence", &T::influence, positive("rad or m", "rho_i: distance from a limit at which the damper begins"));
  v.member("stop", &T::stop, non_negative("rad or m", "rho_s: distance kept from the limit"));
  v.member("gain", &T::gain, positive("rad/s or m/s", "eta of the damper"));
  v.member("share", &T::share,
           unless_default(
               in_range({0.0, 1.0, true, false}, "", "share of the acceleration limit with which `braking` brakes")));
}

constexpr void describe(auto& v, Of<DamperParams>) {
  using T = DamperParams;
  v.member("enabled", &T::enabled, {.text = "switches these rows on"});
  v.member("influence", &T::influence, positive("m", "d_i: distance below which a pair has a row"));
  v.member("stop", &T::stop, non_negative("m", "d_s: stop distance"));
  v.member("gain", &T::gain, positive("m/s", "xi: speed of approach allowed at d_i"));
}

constexpr void describe(auto& v, Of<CollisionParams>) {
  using T = CollisionParams;
  v.inlined(&T::object);
  v.member("max_pairs", &T::max_pairs, in_range({0, 10000}, "", "largest number of pairs with rows, nearest first"));
  v.member("moving_room", &T::moving_room,
           unless_default(non_negative("m", "distance beyond `stop` that rows keep from objects in motion")));
  v.member(
      "away", &T::away,
      unless_default(non_negative("", "weight of the cost of approaching the objects that have rows, as in RMMI")));
  v.member("floor", &T::floor, {.text = "rows against the floor"});
  v.member("self", &T::self, {.text = "rows between the robot's own shapes"});
  v.optional("braking", &T::braking, &BrakingParams::enabled, Off::kOmitted,
             "rows bound speeds by those from which the robot can still stop, and begin where its base can");
  v.member("relaxation", &T::relaxation, unless_default({.text = "relaxation of rows that contradict each other"}));
  v.optional("check", &T::check, &BrakeCheckParams::enabled, Off::kOmitted,
             "check ahead: scales down commands whose backup trajectory comes too near to objects at rest");
  v.optional(
      "separation", &T::separation, &SeparationParams::enabled, Off::kOmitted,
      "separation rows: the robot slows down towards moving objects by the distance of ISO/TS 15066 and ISO 13855");
  v.optional("evasion", &T::evasion, &EvasionParams::enabled, Off::kOmitted,
             "evasion: the base drives away from moving objects while it still can");
  v.optional("at_goal", &T::at_goal, &GoalClearanceParams::enabled, Off::kOmitted,
             "distances to objects at rest shrink towards those of the goal's own pose");
}

constexpr void describe(auto& v, Of<PostureParams>) {
  using T = PostureParams;
  v.member("weight", &T::weight, non_negative("", "lambda_qd: weight"));
  v.member("gain", &T::gain, non_negative("1/s", "k_posture: rate of the joints towards the posture"));
  v.member("target", &T::target,
           {.unit = "rad or m", .per = Per::kJoint, .text = "posture to which the joints are drawn"});
}

constexpr void describe(auto& v, Of<UprightParams>) {
  using T = UprightParams;
  v.member("gain", &T::gain, positive("1/s", "rate of tilting per angle that is left"));
  v.member("margin", &T::margin, share("share of the angle that the row keeps from its end"));
  v.member("plan", &T::plan, positive_share("share of the angle that plans use"));
}

constexpr void describe(auto& v, Of<EscapeParams>) {
  using T = EscapeParams;
  v.member("scale", &T::scale, non_negative("m/rad", "factor on the orientation error in V = |e_p| + scale |e_R|"));
  v.member("progress", &T::progress, positive("m", "decrease of V below its minimum that counts as progress"));
  v.member("patience", &T::patience, positive("s", "time without progress after which the robot stagnates"));
  v.member("position", &T::position, non_negative("m", "position error below which the robot does not stagnate"));
  v.member("orientation", &T::orientation,
           non_negative("rad", "orientation error below which the robot does not stagnate"));
  v.member("side_distance", &T::side_distance, positive("m", "range of the obstacles that decide the side"));
  v.member("angle", &T::angle, non_negative("rad", "angle between the goal's direction and a detour's"));
  v.member("length", &T::length, positive("m", "distance from the base to a detour's target"));
  v.member("growth", &T::growth,
           non_negative("1", "relative growth of length and duration from each detour to the next"));
  v.member("max_length", &T::max_length, positive("m", "largest distance of a detour's target"));
  v.member("duration", &T::duration, positive("s", "longest time of a detour"));
  v.member("reached", &T::reached, non_negative("m", "horizontal distance to its target at which a detour ends"));
  v.member("slack_factor", &T::slack_factor,
           positive("1", "factor on the slack weight of the angular rows during a detour"));
  v.group("posture", "the arm's posture during a detour", [](auto& g) {
    g.member("weight", &T::posture_weight, non_negative("", "weight of `ready` as the arm's posture during a detour"));
    g.member("gain", &T::posture_gain, non_negative("1/s", "k_posture during a detour"));
  });
  v.member("jump", &T::jump,
           unless_default(positive("m", "distance from its predicted pose at which a goal is a new goal")));
  v.member("jump_angle", &T::jump_angle, unless_default(positive("rad", "angle from it at which a goal is a new one")));
}

constexpr void describe(auto& v, Of<ClosedFormParams>) {
  v.member("damping", &ClosedFormParams::damping, non_negative("", "damping at a singularity; 0: the pseudo-inverse"));
  v.member("scaled", &ClosedFormParams::scaled, {.text = "commands are scaled into the velocity limits"});
}

constexpr void describe(auto& v, Of<BaseFirstParams>) {
  using T = BaseFirstParams;
  v.member("reach", &T::reach,
           positive("m", "horizontal distance from the base's origin to the goal at which the base stands"));
  v.member("tolerance", &T::tolerance, positive("m", "tolerance of `reach`"));
  v.member("bearing", &T::bearing, positive("rad", "largest bearing of the goal at which the base stands"));
  v.member("gain", &T::gain, positive("1/s", "gain of the base's motion"));
}

constexpr void describe(auto& v, Of<OutputScalingParams>) {
  using T = OutputScalingParams;
  v.member("far", &T::far, positive("", "qdot *= far/e beyond `switch`"));
  v.member("near", &T::near, positive("", "qdot *= near below `switch`"));
  v.member("switch", &T::switch_distance, positive("", "unclamped norm of the error at which the factor changes"));
}

constexpr void describe(auto& v, Of<ControllerParams>) {
  using T = ControllerParams;
  v.member("method", &T::method, {.text = "the QP, or one of the closed forms"});
  v.member("servo", &T::servo, {.text = "wanted twist of E"});
  v.member("error_norm", &T::error_norm, {.text = "||e|| in the weights"});
  v.member("base_weight", &T::base_weight, non_negative("", "w_b: 1/||e|| or a constant"));
  v.member(
      "lambda_q", &T::lambda_q,
      {.range = Range::non_negative(), .per = Per::kJoint, .one_for_all = true, .text = "lambda_qa; default 0.01"});
  v.optional("slack", &T::slack, &SlackParams::enabled, Off::kNone, "delta of the tracking rows; none: hard rows");
  v.member("tracking_band", &T::tracking_band,
           {.unit = "rad/s or m/s",
            .range = Range::non_negative(),
            .one_for_all = true,
            .text = "Delta of the tracking rows, angular rows first"});
  v.member("k_epsilon", &T::k_epsilon, non_negative("", "weight that turns a differential base towards E"));
  v.member("manipulability", &T::manipulability, {.text = "the term that keeps the arm manipulable"});
  v.member("joint_limits", &T::joint_limits, {.text = "bounds of velocities by joint limits"});
  v.member("collision", &T::collision, {.text = "rows against collisions"});
  v.group("acceleration", "the term against acceleration", [](auto& g) {
    g.member(
        "weight", &T::acceleration_weight,
        {.range = Range::non_negative(), .per = Per::kVelocity, .one_for_all = true, .text = "lambda_qdd; default 0"});
  });
  v.member("posture", &T::posture, {.text = "the term that draws the joints to a posture"});
  v.optional("upright", &T::upright, &UprightParams::enabled, Off::kOmitted,
             "the tool stays upright if the observation asks for it");
  v.group("limits", "bounds beyond the robot's own", [](auto& g) {
    g.member("acceleration", &T::acceleration_limit,
             {.unit = "m/s^2 or rad/s^2",
              .range = Range::positive_or_inf(),
              .per = Per::kVelocity,
              .one_for_all = true,
              .text = "acceleration limit of each velocity; default .inf"});
    g.member("base", &T::base_share,
             unless_default(
                 share("share of the robot's base.max_acceleration as a bound in every stage; 0: `acceleration`")));
    g.member("joints", &T::joint_share,
             unless_default(
                 share("share of a joint's own acceleration as its limit if the robot file has it (`arm.limits`), else "
                       "and at 0 `acceleration`")));
    g.optional("sight", &T::sight, &SightParams::enabled, Off::kOmitted,
               "bound on the base's speed: it can stop in front of objects that come into sight");
  });
  v.optional("prediction", &T::prediction, &PredictionParams::enabled, Off::kOmitted,
             "the controller acts on the state in which its command takes effect");
  v.optional("uncertainty", &T::uncertainty, &UncertaintyParams::enabled, Off::kOmitted,
             "rows keep a margin for errors of measurement");
  v.optional("map", &T::map, &MapParams::enabled, Off::kOmitted,
             "map of occupied and unseen space from the ranges of the robot's sensors");
  v.optional("output_scaling", &T::output_scaling, &OutputScalingParams::enabled, Off::kNone,
             "scales the command as a whole (holistic)");
  v.optional("escape", &T::escape, &EscapeParams::enabled, Off::kKept, "detours out of local minima");
  v.optional("plan", &T::plan, &PlanParams::enabled, Off::kOmitted,
             "looking ahead: predictions, and planned paths of base and arm");
  v.member("closed_form", &T::closed_form, unless_default({.text = "singularities and limits in rrmc, park and baur"}));
  v.optional("base_first", &T::base_first, &BaseFirstParams::enabled, Off::kOmitted,
             "separate motion: the base drives until the goal is in reach, then the arm moves");
  v.member("solver", &T::solver, {.text = "solver of the QP"});
}

static_assert(is_complete<ControllerParams>(), "a parameter has no line in its description");

}  // namespace moma
