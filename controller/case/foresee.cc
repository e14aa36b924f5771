#include "controller/case/foresee.h"

#include <cmath>
#include <cstdio>

#include "controller/ahead/lookahead.h"
#include "controller/ahead/rollout.h"

namespace moma {
namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

std::string meaning(PlanMode mode) {
  switch (mode) {
    case PlanMode::kDirect:
      return "goes by the controller's own policy";
    case PlanMode::kFollow:
      return "follows a path";
    case PlanMode::kStop:
      return "slows down, to choose";
    case PlanMode::kChoose:
      return "stands, while a path and detours are worked out";
  }
  return "";
}

std::string meaning(PlanReason reason) {
  switch (reason) {
    case PlanReason::kStart:
      return "a motion begins with a choice";
    case PlanReason::kArrives:
      return "that is predicted to arrive";
    case PlanReason::kQuicker:
      return "that is predicted to arrive soonest";
    case PlanReason::kFails:
      return "the policy is predicted not to arrive";
    case PlanReason::kStagnates:
      return "the policy stagnated";
    case PlanReason::kNoPath:
      return "nothing was found that arrives";
    case PlanReason::kPathEnds:
      return "the path is at its end";
    case PlanReason::kNoProgress:
      return "it did not get on along its path";
    case PlanReason::kPathBroken:
      return "something is in the way of the path";
    case PlanReason::kTraffic:
      return "something moves";
  }
  return "";
}

std::string names_of_active(const ControllerCore& controller) {
  constexpr double kActive = 1e-7;
  const QpProblem& p = controller.problem();
  const VectorX& x = controller.solution().x;
  std::string names;
  for (int i = 0; i < p.rows; ++i) {
    if (!is_collision(p.ids[static_cast<std::size_t>(i)].kind)) continue;
    double value = 0.0;
    for (int j = 0; j < p.n(); ++j) value += p.A(i, j) * x[j];
    if (p.ubA[i] - value < kActive) names += (names.empty() ? "" : ", ") + controller.row_name(i);
  }
  return names.empty() ? "no row" : names;
}

std::string place(const Rollout& rollout) {
  const StepResult& r = rollout.result();
  const Vector3& base = rollout.state().base;
  std::string out =
      text("%6.2f s  goal %.3f m, %.3f rad away", rollout.time(), r.error.tail<3>().norm(), r.error.head<3>().norm());
  if (rollout.policy().model().mobile())
    out += text("; base at (%.2f, %.2f), heading %.2f", base.x(), base.y(), base.z());
  if (std::isfinite(r.least_distance)) out += text("; nearest object %.3f m", r.least_distance);
  return out + "\n";
}

}  // namespace

std::string describe_plan(const ControllerCore& controller) {
  const Lookahead* ahead = controller.lookahead();
  if (ahead == nullptr) return "";
  const PlanState& state = ahead->state();
  const PlanBrief& brief = state.brief;
  std::string out = "Looking ahead: the robot " + meaning(brief.mode) + ": " + meaning(brief.reason) + ".";
  if (brief.mode == PlanMode::kFollow)
    out += text(" It is at %.2f of %.2f s, %.3f m behind.", brief.clock, brief.duration, brief.lag);
  if (state.going_on) out += " Meanwhile a path and detours are worked out.";
  out += text(" Choices so far: %d.\n", brief.attempts);
  for (const PlanCandidate& candidate : ahead->candidates()) {
    if (candidate.kind == PlanCandidate::Kind::kDetour && candidate.time < 0.0) continue;
    out += candidate.kind == PlanCandidate::Kind::kDirect ? "  the policy goes on: "
           : candidate.kind == PlanCandidate::Kind::kPath ? "  a path: "
                                                          : text("  detour %d: ", candidate.index);
    out += candidate.time < 0.0 ? "does not arrive\n" : text("arrives in %.2f s\n", candidate.time);
  }
  return out;
}

std::string foresee(const ControlCase& control_case, double seconds) {
  Rollout rollout(control_case.robot.model, control_case.controller, control_case.control_period);
  rollout.reset(control_case.objects);
  const EscapeParams& escape = control_case.controller.escape;
  rollout.begin(control_case.observation, control_case.memory.escape.state,
                {seconds, 0.0, escape.position, escape.orientation, false});
  Lookahead* ahead = rollout.policy().lookahead();
  if (ahead != nullptr && control_case.has_plan) ahead->set_state(control_case.memory.plan);
  constexpr double kEvery = 0.5;  // [s]
  std::string out;
  double next = 0.0;
  int stagnations = control_case.memory.escape.state.stagnations;
  bool detour = control_case.memory.escape.state.detour;
  PlanMode mode = ahead != nullptr ? ahead->state().brief.mode : PlanMode::kDirect;
  Fallback fallback = Fallback::kNone;
  while (!rollout.over() && rollout.step() == RolloutEnd::kGoesOn) {
    const EscapeState& now = rollout.policy().escape_state();
    const double time = rollout.time();
    if (time + 1e-9 >= next) {
      out += place(rollout);
      next += kEvery;
    }
    if (now.stagnations > stagnations)
      out += text("%6.2f s  stagnates, held by ", time) + names_of_active(rollout.policy()) + "\n";
    if (now.detour != detour)
      out += text(now.detour ? "%6.2f s  begins a detour\n" : "%6.2f s  ends its detour\n", time);
    if (ahead != nullptr && ahead->state().brief.mode != mode) {
      mode = ahead->state().brief.mode;
      out += text("%6.2f s  ", time) + meaning(mode) + ": " + meaning(ahead->state().brief.reason) + "\n";
    }
    if (rollout.result().fallback != fallback && rollout.result().fallback != Fallback::kNone)
      out += text("%6.2f s  no solution: ", time) + std::string(to_string(rollout.result().fallback)) + "\n";
    fallback = rollout.result().fallback;
    stagnations = now.stagnations;
    detour = now.detour;
  }
  out += place(rollout);
  switch (rollout.end()) {
    case RolloutEnd::kArrives:
      return out + text("E is at the goal after %.2f s.\n", rollout.time());
    case RolloutEnd::kTouches:
      return out + text("It touches an object after %.2f s; held by ", rollout.time()) +
             names_of_active(rollout.policy()) + ".\n";
    case RolloutEnd::kStagnates:
    case RolloutEnd::kLate:
    case RolloutEnd::kGoesOn:
      break;
  }
  const double speed = rollout.result().command.lpNorm<Eigen::Infinity>();
  constexpr double kStands = 0.01;
  if (speed > kStands) return out + text("After %.2f s it is still on its way.\n", rollout.time());
  return out + text("After %.2f s it stands, not at its goal; held by ", rollout.time()) +
         names_of_active(rollout.policy()) + ".\n";
}

}  // namespace moma
