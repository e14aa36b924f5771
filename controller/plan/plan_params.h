#pragma once

#include "controller/describe/describe.h"

namespace moma {

// The members' units and meanings stand in their descriptions.

/// Direct way (plan/direct_way.h): the quickest motion without a corner at the start of a motion.
struct DirectWayParams {
  double share = 0.95;
  double joints = 1.6;
  double near = 0.3, far = 0.9;
  double aside = 0.8;
  int stay = 3;
  int around_tries = 20;
  int pass_tries = 500, pass_ends = 4;
  double pass_anywhere = 0.25;
  double pass_linear = 0.8, pass_angular = 2.2, pass_joints = 0.9;
  double pass_reach = 0.4;
};

constexpr void describe(auto& v, Of<DirectWayParams>) {
  using T = DirectWayParams;
  v.member("share", &T::share, positive_share("share of speeds and accelerations that it uses"));
  v.member("joints", &T::joints, positive("rad", "range of the joints of a try around those of the start"));
  v.member("near", &T::near, non_negative("m", "least distance from the goal to the base of a try"));
  v.member("far", &T::far, non_negative("m", "largest distance from the goal to the base of a try"));
  v.member("aside", &T::aside, non_negative("rad", "range of a try's bearing from the goal around the start's"));
  v.member("stay", &T::stay, in_range({1.0, 1e4}, "", "each try of this number leaves a differential base in place"));
  v.member("around_tries", &T::around_tries,
           in_range({0.0, 1e4}, "", "further tries around the end of the best way, since the last that shortened it"));
  v.member("pass_tries", &T::pass_tries,
           in_range({0.0, 1e4}, "", "tries of a search for a way through a goal; 0: none is passed in motion"));
  v.member("pass_ends", &T::pass_ends, in_range({1.0, 100.0}, "", "ways on to the next goal that each of them has"));
  v.member("pass_anywhere", &T::pass_anywhere,
           unless_default(share("share of them that end anywhere, in place of near the end of the way so far")));
  v.member("pass_linear", &T::pass_linear, non_negative("m/s", "largest speed of the hand at a goal that it passes"));
  v.member("pass_angular", &T::pass_angular, non_negative("rad/s", "the same of its turning"));
  v.member("pass_joints", &T::pass_joints, unless_default(positive_share("share of the joints' speeds there")));
  v.member("pass_reach", &T::pass_reach,
           positive("m", "largest distance at which a differential base passes its place at such a goal"));
}

/// Inverse kinematics of base and arm (plan/whole_body_ik.h), and the cost of a goal configuration.
struct WholeBodyIkParams {
  double inside = 0.03;
  double near = 0.2, far = 1.0, stand = 0.7;
  double joints = 0.6, place = 0.2;
  double stay = 1.5;
  int hard = 8;
  double tight = 0.7, limit = 0.4, limit_room = 0.5, singular = 1.0, agile = 0.06;
};

constexpr void describe(auto& v, Of<WholeBodyIkParams>) {
  using T = WholeBodyIkParams;
  v.member("inside", &T::inside, non_negative("rad or m", "distance inside a path's joint limits"));
  v.member("near", &T::near, non_negative("m", "least distance from the goal to the base of a try"));
  v.member("far", &T::far, non_negative("m", "largest distance from the goal to the base of a try"));
  v.member("stand", &T::stand, non_negative("m", "the same of a try that stays on the start's side"));
  v.member("joints", &T::joints, non_negative("rad", "range of joints and heading of a try around a solution"));
  v.member("hard", &T::hard,
           in_range({1.0, 1e4}, "", "tries for each configuration beyond which a goal close to objects is hard"));
  v.member("place", &T::place, non_negative("m", "the same of the base's place"));
  v.member("stay", &T::stay,
           non_negative("m", "distance up to which the base stays in a third of the tries for a hard goal"));
  v.member("tight", &T::tight, non_negative("s", "cost of a goal configuration without the roomy clearance"));
  v.member("limit", &T::limit, non_negative("s", "cost of each joint at its limit"));
  v.member("limit_room", &T::limit_room, positive("rad or m", "distance from a limit at which that cost vanishes"));
  v.member("singular", &T::singular, non_negative("s", "cost of a singular arm"));
  v.member("agile", &T::agile, positive("m^2", "manipulability at which that cost vanishes"));
}

/// Search for a path (plan/search.h, plan/planner.h): shares of samples, steps of the trees, clearances of its tiers.
struct SearchParams {
  double step = 0.8, arm_step = 0.25, least_step = 0.05;
  int from_goal = 2;
  double between = 0.2, near_goal = 0.15, near_start = 0.1;
  double reach = 0.6;
  double hand_moves = 0.3, hand_step = 0.1;
  double hand_back = 0.25, hand_axes = 0.35;
  int hand_steps = 12;
  double base_alone = 0.2, arm_alone = 0.6, base_way = 1.0;
  double back = 1.0;
  double tight = 0.3, closer = 1.7;
  double off_goal = 0.0;
  double same = 0.001, same_turn = 0.002, same_goal = 0.001, same_goal_turn = 0.002;
  double beyond = 2.5, roomy_beyond = 1.5;
  double apart = 0.12;
  int goals = 3, effort = 16, hard = 4;
};

constexpr void describe(auto& v, Of<SearchParams>) {
  using T = SearchParams;
  v.member("step", &T::step, positive("m", "longest step of a tree of a robot that drives"));
  v.member("arm_step", &T::arm_step, positive("m", "longest step of a tree of a fixed arm"));
  v.member("least_step", &T::least_step, non_negative("m", "shorter free parts of a step are left out"));
  v.member("from_goal", &T::from_goal, in_range({1.0, 100.0}, "", "nodes of the goals' tree for each of the start's"));
  v.member("between", &T::between, share("share of samples with the arm between start and goal"));
  v.member("near_goal", &T::near_goal, share("share of samples near a goal configuration"));
  v.member("near_start", &T::near_start, share("share of samples with the base near the start"));
  v.member("reach", &T::reach, non_negative("m", "reach of the arm, which the base need not drive"));
  v.member("hand_moves", &T::hand_moves, share("share of a tree's growth that moves the hand straight"));
  v.member("hand_step", &T::hand_step, positive("m", "length of one step of the hand"));
  v.member("hand_steps", &T::hand_steps, in_range({1.0, 1000.0}, "", "most steps of the hand in one direction"));
  v.member("hand_back", &T::hand_back, unless_default(share("share of its directions that go back along the arm")));
  v.member("hand_axes", &T::hand_axes, unless_default(share("share of its directions along the axes of E")));
  v.member("base_alone", &T::base_alone, share("share of samples that move the base alone"));
  v.member("arm_alone", &T::arm_alone, share("share of samples that move the arm alone"));
  v.member("base_way", &T::base_way, positive("m", "longest way of a base that moves alone"));
  v.member("back", &T::back, positive_share("share of a blocked step's free part that a tree goes"));
  v.member("tight", &T::tight, share("share of the clearance in the last tier"));
  v.member("closer", &T::closer, positive("1", "least clearance at a close goal, in units of collision.at_goal.least"));
  v.member("off_goal", &T::off_goal,
           share("share of the goal's tolerances by which a goal that no configuration reaches is missed"));
  v.member("same", &T::same, positive("m", "motion of an object up to which a plan keeps what the last one found"));
  v.member("same_turn", &T::same_turn, positive("rad", "the same of its orientation"));
  v.member("same_goal", &T::same_goal, positive("m", "the same of the goal"));
  v.member("same_goal_turn", &T::same_goal_turn, positive("rad", "the same of the goal's orientation"));
  v.member("beyond", &T::beyond, non_negative("m", "distance beyond start and goal within which bases are drawn"));
  v.member("roomy_beyond", &T::roomy_beyond, non_negative("m", "the same in the roomy tier"));
  v.member("goals", &T::goals,
           in_range({1.0, 100.0}, "", "most goal configurations, in units of plan.ik_enough and search.effort"));
  v.member("apart", &T::apart,
           unless_default(non_negative("m", "travel of the robot between goal configurations that differ")));
  v.member("effort", &T::effort,
           in_range({1.0, 1000.0}, "", "largest factor after failures on checks, tries, solutions and roots"));
  v.member("hard", &T::hard,
           unless_default(
               in_range({1.0, 1000.0}, "",
                        "factor on the work from which the last tier to a close goal keeps half as much on the way")));
}

/// Routes of a base (plan/route.h) and motion past the corners of a path (plan/smooth_path.h), for robots that drive.
struct SmoothParams {
  int routes = 4;
  double cell = 0.2, near = 0.3;
  int tries = 100, tries_moving = 300;
  double early = 0.5, late = 0.2;
  double gain = 0.03, slower = 2.0;
  double aside = 1.0, aside_last = 0.15;
  double past = 0.15, turning = 0.9;
  double moves = 0.8, farthest = 0.5, takes_on = 0.5;
  double leave_out = 0.6;
  double check = 0.7;
};

constexpr void describe(auto& v, Of<SmoothParams>) {
  using T = SmoothParams;
  v.member("routes", &T::routes,
           in_range({0.0, 1000.0}, "", "routes of the base with its arm tucked, tried before a search; 0: none"));
  v.member("cell", &T::cell, in_range({0.02, 10.0}, "m", "distance between neighbouring places of a route"));
  v.member("near", &T::near, positive("m", "distance from a goal configuration's place at which a route ends"));
  v.member("tries", &T::tries,
           in_range({0.0, 1e4}, "", "motions tried past the corners of a path; 0: it stops at each"));
  v.member("tries_moving", &T::tries_moving,
           unless_default(in_range({0.0, 1e4}, "", "the same of a robot in motion, which does not wait for them")));
  v.member("early", &T::early, non_negative("s", "time before a corner at which the robot turns to the next one"));
  v.member("late", &T::late, non_negative("s", "the same where that is not free, before it stops at the corner"));
  v.member("gain", &T::gain, non_negative("s", "time by which a further motion is quicker"));
  v.member("slower", &T::slower,
           in_range({1.0, 100.0}, "1", "a first motion may take so many times what counts: further ones shorten it"));
  v.member("aside", &T::aside,
           non_negative("rad or m", "largest change of a joint that makes up for the heading of the base"));
  v.member("aside_last", &T::aside_last,
           unless_default(non_negative("rad or m", "the same where a motion is simulated again")));
  v.member("past", &T::past,
           unless_default(non_negative("m", "distance at which a base that turns about a corner gives it up")));
  v.member("turning", &T::turning, unless_default(share("share of its angular speed with which it then turns")));
  v.member("moves", &T::moves, unless_default(share("share of a corner's variations that move it")));
  v.member("farthest", &T::farthest, unless_default(non_negative("m", "farthest move of the base's place at it")));
  v.member("takes_on", &T::takes_on,
           unless_default(share("most of the way that its arm then goes to that of a corner beside it")));
  v.member("leave_out", &T::leave_out, unless_default(share("share of the others that leave it out")));
  v.member("check", &T::check,
           unless_default(positive_share("way between two checks of such a motion, in units of plan.check_step")));
}

/// Following of a path (plan/follow.h, qp/pose.h).
struct FollowParams {
  double heading = 0.4, joint = 0.3;
  double across = 6.0;
  double rate = 15.0;
  double kept = 0.45;
  double joint_influence = 0.1, joint_stop = 0.002;
  bool to_end = false;
};

constexpr void describe(auto& v, Of<FollowParams>) {
  using T = FollowParams;
  v.member("heading", &T::heading, non_negative("m/rad", "lag of an error of the heading"));
  v.member("joint", &T::joint, non_negative("m/rad", "lag of an error of a joint"));
  v.member("across", &T::across, non_negative("rad/m^2", "turn to the path per metre beside it and metre driven"));
  v.member("rate", &T::rate, positive("1/s", "least gain of the rows' dampers on a path"));
  v.member("kept", &T::kept, share("share of the path's clearances that rows keep"));
  v.member("joint_influence", &T::joint_influence,
           unless_default(positive("rad or m", "distance from a joint's limit at which its damper begins, at most")));
  v.member("joint_stop", &T::joint_stop,
           unless_default(non_negative("rad or m", "distance from it that the damper keeps, at most")));
  v.member("to_end", &T::to_end, {.text = "a path of less than plan.clearance is followed to its end"});
}

/// Decisions of the look-ahead (lookahead/lookahead.h): when it predicts, chooses, follows, and gives a path up.
struct DecisionParams {
  double standing = 0.1;
  double stop_time = 1.0, set_out_time = 0.25, choice_time = 1.8;
  double go_on_driving = 0.52, go_on_standing = 0.24;
  double sure = 0.5;
  double soon = 0.3;
  double way_ahead = 0.12, way_gain = 0.05;
  double arrived = 0.005, arrived_close = 0.0005;
  double tolerance = 0.7, beside = 0.25, last_part = 1.0;
  double missed = 0.3, pass_ahead = 0.2, pass_rest = 1.5;
  double progress = 0.05;
  double pushed = 0.3;
  double meet = 2.0, wait = 0.5, meet_room = 0.05;
  double meet_speed = 0.6, meet_time = 1.0;
  double goal_jump = 0.02, goal_turn = 0.05;
  int plans = 4;
  double moved = 0.008, turned = 0.03;
  double least = 0.015, less = 0.005, share = 0.5;
  double watch_step = 0.08;
};

constexpr void describe(auto& v, Of<DecisionParams>) {
  using T = DecisionParams;
  v.member("standing", &T::standing, positive("rad/s or m/s", "velocities below which the robot counts as standing"));
  v.member("stop_time", &T::stop_time, non_negative("s", "longest time to come to rest for a choice"));
  v.member("set_out_time", &T::set_out_time, non_negative("s", "longest time of looking for a direct way"));
  v.member("choice_time", &T::choice_time, non_negative("s", "longest choice of a robot that stands"));
  v.member("go_on_driving", &T::go_on_driving, non_negative("s", "a base goes on for this time during a choice"));
  v.member("go_on_standing", &T::go_on_standing, non_negative("s", "a fixed arm goes on for this time"));
  v.member("sure", &T::sure, non_negative("s", "time beyond that without contact, or the robot stops"));
  v.member("soon", &T::soon, non_negative("s", "a goal predicted to be reached within this time needs no choice"));
  v.member("way_ahead", &T::way_ahead,
           non_negative("s", "a direct way from a motion begins where the path has the robot after this time"));
  v.member("way_gain", &T::way_gain, non_negative("s", "time by which it is quicker than the rest of the path"));
  v.member("arrived", &T::arrived, non_negative("m", "lag at a path's end at which the policy takes over"));
  v.member("arrived_close", &T::arrived_close, non_negative("m", "the same where the goal is close to an object"));
  v.member("tolerance", &T::tolerance,
           positive_share("share of the goal's tolerances within which a prediction arrives"));
  v.member("beside", &T::beside,
           unless_default(share("share of that beyond which a robot that stands for plan.stuck chooses again")));
  v.member("last_part", &T::last_part,
           unless_default(non_negative("s", "rest of a path that is left once to a policy predicted to arrive")));
  v.member("pass_ahead", &T::pass_ahead,
           non_negative("s", "a way through a goal begins where the path has the robot after this time"));
  v.member("missed", &T::missed,
           non_negative("s", "time after the passing of a goal at which it counts as missed, unless the next is told"));
  v.member("pass_rest", &T::pass_rest,
           unless_default(
               non_negative("s", "time to the passing of a goal within which no other path to it is looked for")));
  v.member("progress", &T::progress, non_negative("s", "advance of the path's clock that counts as progress"));
  v.member("pushed", &T::pushed, non_negative("m", "lag among moving objects at which a path is given up"));
  v.member("meet", &T::meet, positive("s", "time before meeting a moving object at which the path's clock slows down"));
  v.member("wait", &T::wait, non_negative("s", "time before a meeting at which the path's clock stands"));
  v.member("meet_room", &T::meet_room,
           unless_default(non_negative("m", "distance beyond the path's clearance that counts as meeting it")));
  v.member("meet_speed", &T::meet_speed,
           unless_default(
               positive_share("share of its largest speed with which plans expect a base to come to what moves")));
  v.member("meet_time", &T::meet_time,
           unless_default(non_negative("s", "time after which plans expect an arm to meet what moves")));
  v.member("goal_jump", &T::goal_jump, positive("m", "motion of the goal between steps that makes it a new goal"));
  v.member("goal_turn", &T::goal_turn, positive("rad", "the same of its orientation"));
  v.member("plans", &T::plans,
           in_range({1.0, 100.0}, "", "plans of one choice to a goal close to an object, or where nothing arrives"));
  v.member("moved", &T::moved, positive("m", "motion of an object at rest after which a path is checked again"));
  v.member("turned", &T::turned, positive("rad", "the same of its orientation"));
  v.member("least", &T::least, non_negative("m", "largest distance that is asked of a path when it is checked again"));
  v.member("less", &T::less, non_negative("m", "subtracted from the share of the path's clearance"));
  v.member("share", &T::share, share("share of the path's clearance that is asked then"));
  v.member("watch_step", &T::watch_step,
           unless_default(in_range({0.01, 10.0}, "s", "interval between moments that are checked")));
}

/// Look-ahead (controller/lookahead): the controller predicts its own motion, and plans for base and arm if it would
/// stop short of the goal. Work is counted in checks; one check computes one configuration's distances.
struct PlanParams {
  bool enabled = false;
  int budget = 600;
  double rate = 1.5e5;
  double period = 0.5, horizon = 10.0, step = 0.04;
  double touch = 0.005;
  double roomy = 0.08, clearance = 0.035, self = 0.015;
  double joint_margin = 0.12;
  double speed = 0.95, acceleration = 0.85;
  double check_step = 0.08;
  double overlap = 0.35;
  double settle = 0.3;
  double stuck = 1.0;
  double lag = 0.1;
  double weight = 10.0, gain = 3.0;
  int ik_tries = 150, ik_enough = 24;
  int roots = 10;
  int checks = 12000, runs = 4, shortcuts = 60;
  int direct = 60;
  DirectWayParams direct_way = {};
  WholeBodyIkParams ik = {};
  SearchParams search = {};
  SmoothParams smooth = {};
  FollowParams follow = {};
  DecisionParams decisions = {};

  /// Clearance of a path in the last tier [m].
  double tight() const noexcept { return search.tight * clearance; }
};

constexpr void describe(auto& v, Of<PlanParams>) {
  using T = PlanParams;
  v.member("budget", &T::budget,
           in_range({1.0, 1e7}, "", "most checks in one control step, and at most one piece of work more"));
  v.member("rate", &T::rate,
           unless_default(positive("1/s", "checks in a second: a fast loop does fewer in a step than plan.budget")));
  v.member("period", &T::period, positive("s", "interval between predictions"));
  v.member("horizon", &T::horizon, positive("s", "horizon of a prediction"));
  v.member("step", &T::step, positive("s", "control period of a prediction"));
  v.member("touch", &T::touch, quantity("m", "distance to an object at which a prediction fails"));
  v.member("roomy", &T::roomy, non_negative("m", "clearance of a path from objects, tried first"));
  v.member("clearance", &T::clearance, non_negative("m", "clearance of a path if that finds none"));
  v.member("self", &T::self, non_negative("m", "clearance from the robot itself and from the floor"));
  v.member("joint_margin", &T::joint_margin, non_negative("rad or m", "distance of a path from joint limits"));
  v.member("speed", &T::speed, positive_share("share of the largest speeds that a path uses"));
  v.member("acceleration", &T::acceleration, positive_share("share of the accelerations that a path uses"));
  v.member("check_step", &T::check_step, positive("m", "way of any point of the robot between two checks"));
  v.member("overlap", &T::overlap, non_negative("s", "largest overlap of successive motions of a path"));
  v.member("settle", &T::settle, non_negative("s", "time from a path's end to the goal"));
  v.member("stuck", &T::stuck, positive("s", "time without progress on a path after which the robot chooses again"));
  v.member("lag", &T::lag,
           positive("m", "the path's clock runs at the rate clip(1.5 - lag of the robot / this, 0, 1)"));
  v.member("weight", &T::weight, positive("1", "weight of the path's velocities in the QP"));
  v.member("gain", &T::gain, non_negative("1/s", "gain of the path's servo"));
  v.member("ik_tries", &T::ik_tries,
           in_range({1.0, 1e5}, "", "tries of whole-body inverse kinematics at each clearance"));
  v.member("ik_enough", &T::ik_enough, in_range({1.0, 1000.0}, "", "number of solutions that suffices"));
  v.member("roots", &T::roots, in_range({1.0, 1000.0}, "", "number of solutions from which the search starts"));
  v.member("checks", &T::checks, in_range({0.0, 1e7}, "", "checks of a search; half as many at the roomy clearance"));
  v.member("runs", &T::runs, in_range({1.0, 100.0}, "", "runs of the search"));
  v.member("shortcuts", &T::shortcuts,
           in_range({0.0, 1e5}, "",
                    "shortcuts tried in each run; those without a gain where no motion past corners follows"));
  v.member("direct", &T::direct,
           in_range({0.0, 1e4}, "", "tries of inverse kinematics for a direct way at a motion's start; 0: none"));
  v.member("direct_way", &T::direct_way, unless_default({.text = "the way without a corner at a motion's start"}));
  v.member("ik", &T::ik, unless_default({.text = "inverse kinematics of base and arm"}));
  v.member("search", &T::search, unless_default({.text = "the search for a path"}));
  v.member("smooth", &T::smooth, unless_default({.text = "routes of a base, and motion past the corners of a path"}));
  v.member("follow", &T::follow, unless_default({.text = "following a path"}));
  v.member("decisions", &T::decisions, unless_default({.text = "when to predict, choose, follow, and give a path up"}));
}

}  // namespace moma
