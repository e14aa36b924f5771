#include "controller/case/solve.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "controller/ahead/lookahead.h"
#include "controller/ahead/rollout.h"
#include "controller/case/formatted.h"
#include "controller/case/plan_words.h"
#include "controller/task/escape.h"

namespace moma {
namespace {

constexpr double kNearer = 0.005, kInVain = 1.0;  // less of a way left, or this long without, is no progress [m, s]

std::string names_of_active(const ControllerCore& controller) {
  constexpr double kActive = 1e-7;
  const QpProblem& p = controller.problem();
  const VectorX& x = controller.solution().x;
  std::vector<std::string> names;
  for (int i = 0; i < p.rows; ++i) {
    if (!is_collision(p.ids[static_cast<std::size_t>(i)].kind)) continue;
    double value = 0.0;
    for (int j = 0; j < p.n(); ++j) value += p.A(i, j) * x[j];
    if (p.ubA[i] - value < kActive) names.push_back(controller.row_name(i));
  }
  return names.empty() ? "no row" : joined(names);
}

std::string place(const Rollout& rollout) {
  const StepResult& r = rollout.result();
  const Vector3& base = rollout.state().base;
  std::string out = formatted("%6.2f s  goal %.3f m, %.3f rad away", rollout.time(), r.error.tail<3>().norm(),
                              r.error.head<3>().norm());
  if (rollout.policy().model().mobile())
    out += formatted("; base at (%.2f, %.2f), heading %.2f", base.x(), base.y(), base.z());
  if (std::isfinite(r.least_distance)) out += formatted("; nearest object %.3f m", r.least_distance);
  return out + "\n";
}

}  // namespace

std::string forecast(const ControlCase& control_case, double seconds) {
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
  double least_way = std::numeric_limits<double>::infinity(), nearer = 0.0;
  while (!rollout.over() && rollout.step() == RolloutEnd::kGoesOn) {
    const EscapeState& now = rollout.policy().escape_state();
    const double time = rollout.time();
    const double way = remaining_way(escape, rollout.result().error);
    if (way < least_way - kNearer) {
      least_way = way;
      nearer = time;
    }
    if (time + 1e-9 >= next) {
      out += place(rollout);
      next += kEvery;
    }
    if (now.stagnations > stagnations)
      out += formatted("%6.2f s  stagnates, held by ", time) + names_of_active(rollout.policy()) + "\n";
    if (now.detour != detour)
      out += formatted(now.detour ? "%6.2f s  begins a detour\n" : "%6.2f s  ends its detour\n", time);
    if (ahead != nullptr && ahead->state().brief.mode != mode) {
      mode = ahead->state().brief.mode;
      out += formatted("%6.2f s  ", time) + meaning(mode) + ": " + meaning(ahead->state().brief.reason) + "\n";
    }
    if (rollout.result().fallback != fallback && rollout.result().fallback != Fallback::kNone)
      out += formatted("%6.2f s  no solution: ", time) + std::string(to_string(rollout.result().fallback)) + "\n";
    fallback = rollout.result().fallback;
    stagnations = now.stagnations;
    detour = now.detour;
  }
  out += place(rollout);
  switch (rollout.end()) {
    case RolloutEnd::kArrives:
      return out + formatted("E is at the goal after %.2f s.\n", rollout.time());
    case RolloutEnd::kTouches:
      return out + formatted("It touches an object after %.2f s; held by ", rollout.time()) +
             names_of_active(rollout.policy()) + ".\n";
    case RolloutEnd::kStagnates:
    case RolloutEnd::kLate:
    case RolloutEnd::kGoesOn:
      break;
  }
  const bool led = detour || mode == PlanMode::kFollow;
  if (!led && rollout.time() - nearer >= kInVain)
    return out +
           formatted("After %.2f s it has come no nearer to its goal for %.2f s; held by ", rollout.time(),
                     rollout.time() - nearer) +
           names_of_active(rollout.policy()) + ".\n";
  const double speed = rollout.result().command.lpNorm<Eigen::Infinity>();
  constexpr double kStands = 0.01;
  if (speed > kStands) return out + formatted("After %.2f s it is still on its way.\n", rollout.time());
  return out + formatted("After %.2f s it stands, not at its goal; held by ", rollout.time()) +
         names_of_active(rollout.policy()) + ".\n";
}

}  // namespace moma
