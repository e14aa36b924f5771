#include "controller/case/plan_words.h"

#include <array>
#include <limits>
#include <string_view>

#include "controller/case/formatted.h"
#include "controller/lookahead/choice.h"
#include "controller/lookahead/lookahead.h"

namespace moma {
namespace {

std::string_view name_of(PlanKind kind) {
  static constexpr std::array<std::string_view, words(Of<PlanKind>{}).size()> kNames{"nothing", "the policy as it is",
                                                                                     "a detour", "a path"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::string after(double seconds, const char* otherwise) {
  return seconds < 0.0 ? otherwise : formatted("%.2f s", seconds);
}

std::string last_choice(const PlanVerdict& choice) {
  if (choice.kind == PlanKind::kNone) return "";
  const double best = choice.kind == PlanKind::kPath ? choice.by_path : choice.policy;
  std::string out = formatted("The last choice, of %d candidates, fell on ", choice.tried) +
                    std::string(name_of(choice.kind)) +
                    (best < 0.0 ? ", since nothing arrived" : formatted(": %.2f s to the goal, the least", best)) + ".";
  if (choice.kind == PlanKind::kPath)
    return out + " The policy as it was: " + after(choice.policy, "would not have arrived") + ".\n";
  return out + " A path: " + after(choice.by_path, "none that is quicker") + ".\n";
}

/// The policy's end in a prediction.
std::string end_of(const Rollout& rollout, double horizon) {
  switch (rollout.end()) {
    case RolloutEnd::kArrives:
      return formatted("arrives after %.2f s", rollout.time());
    case RolloutEnd::kTouches:
      return formatted("touches an object after %.2f s", rollout.time());
    case RolloutEnd::kStagnates:
      return formatted("stagnates after %.2f s", rollout.time());
    case RolloutEnd::kGoesOn:
    case RolloutEnd::kLate:
      break;
  }
  return formatted("does not arrive within %.1f s", horizon);
}

/// A choice that is made from beginning to end in one step; the controller spreads the same work over steps.
std::string choice_now(const ControlCase& c, int number) {
  ControllerParams policy = c.controller;
  policy.plan.enabled = false;
  const PlanParams& plan = c.controller.plan;
  Rollout rollout(c.robot.model, policy, plan.step);
  rollout.reset(c.objects);
  long work = std::numeric_limits<long>::max();
  rollout.begin(c.observation, c.memory.escape.state, prediction_limits(plan, c.controller.escape, plan.horizon));
  while (rollout.advance(work)) {
  }
  Choice choice(c.robot.model, c.controller);
  choice.reset(c.objects);
  choice.set_goal_axes(c.observation.goal.X_WG.linear());
  choice.begin(c.observation, rollout.end() == RolloutEnd::kArrives ? rollout.time() : -1.0, number);
  while (choice.advance(work)) {
  }
  const PlanVerdict& verdict = choice.verdict();
  const bool arrives = verdict.policy >= 0.0 || verdict.by_path >= 0.0;
  const auto line = [&](PlanKind kind, const std::string& end) {
    const char* mark = arrives && kind == verdict.kind ? ", the quicker one\n" : "\n";
    return "  " + std::string(name_of(kind)) + ": " + end + mark;
  };
  const char* no_path = arrives ? "none was found that is quicker" : "none was found";
  return "Of a choice made now:\n" + line(PlanKind::kPolicy, end_of(rollout, plan.horizon)) +
         line(PlanKind::kPath,
              verdict.by_path >= 0.0 ? formatted("arrives after %.2f s", verdict.by_path) : std::string(no_path));
}

}  // namespace

std::string meaning(PlanMode mode) {
  static constexpr std::array kMeanings{"goes by the controller's own policy", "follows a path",
                                        "slows down, to choose", "stands, while a path is worked out",
                                        "stands, while it looks for a direct way"};
  static_assert(kMeanings.size() == words(Of<PlanMode>{}).size());
  return kMeanings.at(static_cast<std::size_t>(mode));
}

std::string meaning(PlanReason reason) {
  static constexpr std::array kMeanings{"a motion begins with a choice",
                                        "that is predicted to arrive",
                                        "that is predicted to arrive soonest",
                                        "the policy is predicted not to arrive",
                                        "the policy stagnated",
                                        "nothing was found that arrives",
                                        "the path is at its end",
                                        "it did not get on along its path",
                                        "something is in the way of the path",
                                        "something moves",
                                        "a direct way to the goal is free",
                                        "it stands beside the goal"};
  static_assert(kMeanings.size() == words(Of<PlanReason>{}).size());
  return kMeanings.at(static_cast<std::size_t>(reason));
}

std::string describe_plan(const ControlCase& control_case, const ControllerCore& controller) {
  const Lookahead* ahead = controller.lookahead();
  if (ahead == nullptr) return "";
  const PlanBrief& brief = ahead->state().brief;
  std::string out = "Looking ahead: the robot " + meaning(brief.mode) + ": " + meaning(brief.reason) + ".";
  if (brief.mode == PlanMode::kFollow)
    out += formatted(" It is at %.2f of %.2f s, %.3f m behind.", brief.clock, brief.duration, brief.lag);
  if (brief.going_on) out += " Meanwhile a path is worked out.";
  out += formatted(" Choices so far: %d.\n", brief.attempts) + last_choice(brief.choice);
  return out + choice_now(control_case, control_case.memory.plan.brief.attempts + 1);
}

}  // namespace moma
