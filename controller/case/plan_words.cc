#include "controller/case/plan_words.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "controller/ahead/candidates.h"
#include "controller/ahead/choice.h"
#include "controller/ahead/lookahead.h"
#include "controller/case/formatted.h"

namespace moma {
namespace {

std::string name_of(PlanKind kind, int index) {
  if (kind == PlanKind::kPolicy) return "the policy as it is";
  if (kind == PlanKind::kPath) return "a path";
  if (index < kVortices)
    return std::string("the policy, round obstacles ") + (index == 0 ? "one way" : "the other way");
  if (index < kFirstDetour) return "the policy, as if it had stagnated";
  const Detour detour = detour_of(index);
  const double degrees = std::abs(detour.angle) * 180.0 / std::numbers::pi;
  const std::string length = formatted("a detour of %.1f m ", detour.length);
  if (degrees > 179.0) return length + "back";
  return length + formatted(detour.angle > 0.0 ? "%.0f degrees to the left" : "%.0f degrees to the right", degrees) +
         " of the goal";
}

std::string after(double seconds, const char* otherwise) {
  return seconds < 0.0 ? otherwise : formatted("%.2f s", seconds);
}

std::string last_choice(const PlanVerdict& choice) {
  if (choice.kind == PlanKind::kNone) return "";
  const double best = choice.kind == PlanKind::kPolicy   ? choice.policy
                      : choice.kind == PlanKind::kDetour ? choice.by_detour
                                                         : choice.by_path;
  std::string out = formatted("The last choice, of %d candidates, fell on ", choice.tried) +
                    name_of(choice.kind, choice.detour) +
                    (best < 0.0 ? ", since nothing arrived" : formatted(": %.2f s to the goal, the least", best)) + ".";
  if (choice.kind != PlanKind::kPolicy)
    out += " The policy as it was: " + after(choice.policy, "would not have arrived") + ".";
  if (choice.kind != PlanKind::kDetour)
    out += " The best detour: " + after(choice.by_detour, "none arrived sooner") + ".";
  if (choice.kind != PlanKind::kPath) out += " A path: " + after(choice.by_path, "none that is quicker") + ".";
  return out + "\n";
}

/// A choice, made from beginning to end: as the controller's own, which is spread over steps.
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
  const RolloutEnd direct = rollout.end();
  const double direct_time = rollout.time();
  Choice choice(c.robot.model, c.controller);
  choice.reset(c.objects);
  choice.begin(c.observation, direct == RolloutEnd::kArrives ? direct_time : -1.0, number);
  while (choice.advance(rollout, work)) {
  }
  std::string out = "Of a choice made now:\n";
  std::array<int, words(Of<RolloutEnd>{}).size()> failed{};
  const PlanCandidate& best = choice.best();
  for (const PlanCandidate& candidate : choice.candidates()) {
    if (candidate.kind == PlanKind::kDetour && candidate.time < 0.0) {
      ++failed[static_cast<std::size_t>(candidate.end)];
      continue;
    }
    out += "  " + name_of(candidate.kind, candidate.index) + ": ";
    if (candidate.time >= 0.0)
      out += formatted("arrives after %.2f s", candidate.time);
    else if (candidate.kind == PlanKind::kPath)
      out += best.time < 0.0 ? "none was found" : "none was found that is quicker";
    else if (direct == RolloutEnd::kTouches)
      out += formatted("touches an object after %.2f s", direct_time);
    else if (direct == RolloutEnd::kStagnates)
      out += formatted("stagnates after %.2f s", direct_time);
    else
      out += formatted("does not arrive within %.1f s", plan.horizon);
    out += &candidate == &best && best.time >= 0.0 ? ", the quickest\n" : "\n";
  }
  int others = 0;
  for (const int n : failed) others += n;
  if (others == 0) return out;
  const auto of = [&](RolloutEnd end) { return failed[static_cast<std::size_t>(end)]; };
  return out + formatted("  %d other detours: %d touch something, %d stagnate, %d are not quicker\n", others,
                         of(RolloutEnd::kTouches), of(RolloutEnd::kStagnates),
                         of(RolloutEnd::kLate) + of(RolloutEnd::kGoesOn));
}

}  // namespace

std::string meaning(PlanMode mode) {
  static constexpr std::array kMeanings{"goes by the controller's own policy", "follows a path",
                                        "slows down, to choose", "stands, while a path and detours are worked out",
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
                                        "a direct way to the goal is free"};
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
  if (brief.going_on) out += " Meanwhile a path and detours are worked out.";
  out += formatted(" Choices so far: %d.\n", brief.attempts) + last_choice(brief.choice);
  if (control_case.observation.goal.V_WG_W.norm() > 0.0) return out + "A goal that moves is the policy's.\n";
  return out + choice_now(control_case, control_case.memory.plan.brief.attempts + 1);
}

}  // namespace moma
