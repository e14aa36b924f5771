#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "controller/case/case_step.h"
#include "controller/case/formatted.h"
#include "controller/case/infeasible_set.h"
#include "controller/case/plan_words.h"
#include "controller/case/solve.h"
#include "controller/qp/limits.h"

namespace moma {
namespace {

std::string number(double value) { return formatted("%.4g", value); }

std::string name_of(const ControllerCore& controller, int variable) {
  const std::vector<std::string> names = controller.model().velocity_names();
  const int n = static_cast<int>(names.size());
  return variable < n ? names[static_cast<std::size_t>(variable)] : "delta/" + std::to_string(variable - n);
}

// Base velocities of a differential base are m/s, then rad/s; of an omnidirectional one the first two are m/s.
std::string unit_of(const ControllerCore& controller, int variable) {
  const RobotModel& model = controller.model();
  const int base = model.base_dof();
  if (variable < base) return variable < base - 1 ? "m/s" : "rad/s";
  if (variable < model.num_velocities()) {
    const auto joint = static_cast<std::size_t>(variable - base);
    return model.joints[joint].type == JointType::kPrismatic ? "m/s" : "rad/s";
  }
  return variable - model.num_velocities() < 3 ? "rad/s" : "m/s";
}

// Names the origin of a bound, read from the bounds of the step.
std::string bound_cause(const CaseStep& step, int variable, bool upper, double bound) {
  const ControllerCore& controller = step.controller;
  const RobotModel& model = controller.model();
  if (variable >= model.num_velocities()) return "the slack's limit";
  const Bounds& bounds = controller.bounds();
  const bool base = variable < model.base_dof();
  if (base && controller.asked().base)
    return controller.evades() ? "the base's backup trajectory" : "the base stands while the arm moves";
  if (bound == (upper ? 1.0 : -1.0) * controller.limits().speed()[variable]) return "the speed limit";
  if (base || bound != (upper ? bounds.hard_upper : bounds.hard_lower)[variable]) return "the acceleration limit";
  const int i = variable - model.base_dof();
  const ControlledJoint& joint = model.joint(i);
  const double q = controller.kinematics().q()[i];
  const double room = upper ? joint.upper - q : q - joint.lower;
  return std::string("the ") + (upper ? "upper" : "lower") + " joint limit, " + number(room) + " away";
}

// "JOINT >= -2.175 rad/s: the speed limit".
std::string bound_text(const CaseStep& step, int variable, const char* relation, bool upper, double bound) {
  return name_of(step.controller, variable) + relation + number(bound) + " " + unit_of(step.controller, variable) +
         ": " + bound_cause(step, variable, upper, bound);
}

// Describes the demand of a row in words.
std::string row_meaning(const QpProblem& problem, int row) {
  const RowId& id = problem.ids[static_cast<std::size_t>(row)];
  const double bound = problem.ubA[row];
  switch (id.kind) {
    case RowKind::kTracking: {
      static constexpr const char* kAxis[] = {"turn about x", "turn about y", "turn about z",
                                              "move along x", "move along y", "move along z"};
      return formatted("%s at %.4g %s", kAxis[id.first], bound, id.first < 3 ? "rad/s" : "m/s");
    }
    case RowKind::kWheel:
      return formatted("at most %.4g rad/s either way", bound);
    case RowKind::kDrive:
      return formatted("of what the drives can change in a period, %.4g m/s either way",
                       0.5 * (bound - problem.lbA[row]));
    case RowKind::kSeparation:
      return formatted("may approach what moves at no more than %.4g m/s, to stand before they meet", bound);
    case RowKind::kUpright:
      return formatted("the tool's axis %s %.4g rad/s",
                       bound >= 0.0 ? "may tilt at no more than" : "must rise at no less than", std::abs(bound));
    case RowKind::kObject:
    case RowKind::kFloor:
    case RowKind::kSelf:
      break;
  }
  // The row says -n^T v <= bound: a negative bound asks for a retreat.
  return formatted("%s %.4g m, %s %.4g m/s", id.d < 0.0 ? "overlapping by" : "distance", std::abs(id.d),
                   bound >= 0.0 ? "may approach at no more than" : "must retreat at no less than", std::abs(bound));
}

struct Active {
  std::string text;
  double multiplier;
};

std::string describe_active(const CaseStep& step) {
  const QpProblem p = step.controller.final_problem();
  const QpSolution& solution = step.controller.solution();
  const VectorX x = solution.x.head(p.n());
  std::vector<Active> active;
  for (int i = 0; i < p.rows; ++i) {
    const RowKind kind = p.ids[static_cast<std::size_t>(i)].kind;
    if (kind == RowKind::kTracking) continue;  // told apart, by the slack
    if (!p.holds(i, x)) continue;
    active.push_back({step.controller.row_name(i) + ": " + row_meaning(p, i), std::abs(solution.row_multipliers[i])});
  }
  const int named = step.controller.problem().n();
  for (int i = 0; i < named; ++i) {
    const bool upper = p.ub[i] - x[i] <= kHeld;
    if (!upper && x[i] - p.lb[i] > kHeld) continue;
    active.push_back(
        {bound_text(step, i, " at ", upper, upper ? p.ub[i] : p.lb[i]), std::abs(solution.bound_multipliers[i])});
  }
  if (active.empty()) return "No limit and no obstacle holds the command: it is what the terms below want.\n";
  std::stable_sort(active.begin(), active.end(),
                   [](const Active& a, const Active& b) { return a.multiplier > b.multiplier; });
  std::string out = "What holds the command (strongest first; the number is the cost saved per unit of relaxation):\n";
  for (const Active& a : active) out += formatted("  %9.3g  ", a.multiplier) + a.text + "\n";
  return out;
}

std::string describe_cost(const CaseStep& step) {
  std::vector<TermCost> terms = step.controller.term_costs();
  std::stable_sort(terms.begin(), terms.end(),
                   [](const TermCost& a, const TermCost& b) { return std::abs(a.value) > std::abs(b.value); });
  std::string out = "Cost " + number(step.controller.cost()) + ", largest term first";
  const double total = std::accumulate(terms.begin(), terms.end(), 0.0,
                                       [](double sum, const TermCost& t) { return sum + std::abs(t.value); });
  out += total > 0.0 ? ": " + std::string(terms.front().words) + " dominates.\n" : ".\n";
  for (const TermCost& term : terms) {
    const double share = total > 0.0 ? 100.0 * std::abs(term.value) / total : 0.0;
    out += formatted("  %10.3g  %3.0f %%  ", term.value, share) + std::string(term.words) + "\n";
  }
  return out;
}

std::string describe_infeasible(const CaseStep& step) {
  const QpProblem& problem = step.controller.problem();
  const auto set = minimal_infeasible_set(problem, step.controller.model().num_velocities());
  if (set.empty()) return "The solver could not say which constraints exclude each other.\n";
  std::string out = "These cannot be met together (without any one of them the others can):\n";
  for (const ConstraintId& id : set) {
    if (id.kind == ConstraintId::Kind::kRow) {
      out += "  " + step.controller.row_name(id.index) + ": " + row_meaning(problem, id.index) + "\n";
      continue;
    }
    const bool upper = id.kind == ConstraintId::Kind::kUpperBound;
    const double bound = upper ? problem.ub[id.index] : problem.lb[id.index];
    out += "  " + bound_text(step, id.index, upper ? " <= " : " >= ", upper, bound) + "\n";
  }
  return out;
}

// Names the unseen space that holds the motion.
std::string describe_unseen(const CaseStep& step) {
  const ControllerCore& controller = step.controller;
  const QpProblem p = controller.final_problem();
  const VectorX x = controller.solution().x.head(p.n());
  const auto states = controller.map().states();
  const auto state_of = [&](const RowId& id) {
    return static_cast<std::size_t>(id.second) - step.given.objects.size();
  };
  int rows = 0;
  const RowId* nearest = nullptr;
  for (int i = 0; i < p.rows; ++i) {
    const RowId& id = p.ids[static_cast<std::size_t>(i)];
    if (id.kind != RowKind::kObject || state_of(id) >= states.size() || states[state_of(id)].seen) continue;
    if (!p.holds(i, x)) continue;
    ++rows;
    if (nearest == nullptr || id.d < nearest->d) nearest = &id;
  }
  if (nearest == nullptr) return "";
  const ObjectState& box = states[state_of(*nearest)];
  const Vector3& at = box.X_WO.translation();
  return formatted(
      "Unseen space holds the motion with %d %s until a sensor has looked into it: the nearest, %.4g m "
      "away, is %.2f x %.2f x %.2f m about (%.4g, %.4g, %.4g).\n",
      rows, rows == 1 ? "row" : "rows", nearest->d, box.box.x(), box.box.y(), box.box.z(), at.x(), at.y(), at.z());
}

std::string describe_backup(const CaseStep& step) {
  if (step.controller.evades())
    return "The base drives off: what was asked for leaves no way out of the way of what moves.\n";
  if (!(step.result.kept < 1.0)) return "";
  return formatted("The check of the backup trajectory lets %.0f %% of the command through.\n",
                   100.0 * step.result.kept);
}

std::string describe_fallback(const CaseStep& step) {
  switch (step.result.fallback) {
    case Fallback::kNone:
      return "";
    case Fallback::kNoAcceleration:
      return "The command is that of the problem without acceleration limits.\n";
    case Fallback::kRelaxed:
      return "The command breaks every " +
             std::string(step.controller.outcome().only_separation ? "separation" : "collision") + " row by at most " +
             number(step.controller.outcome().collision_slack) + " m/s, next to the least that is possible.\n";
    case Fallback::kBrake:
      return "The command brakes: it is the smallest within the bounds.\n";
  }
  return "";
}

std::string describe_escape(const ControllerCore& controller) {
  const EscapeParams& params = controller.params().escape;
  const EscapeState& state = controller.escape_state();
  if (!params.enabled) return "";
  if (state.detour) {
    const Vector3& p = state.target_W;
    return formatted("On detour %d, to (%.4g, %.4g, %.4g) for another %.4g s; its orientation is nearly free.\n",
                     state.stagnations, p.x(), p.y(), p.z(), state.remaining);
  }
  return formatted("The way left has not become shorter than %.4g m for %.4g s, and stagnated %d times.\n", state.best,
                   state.idle, state.stagnations);
}

std::string describe_task(const CaseStep& step) {
  const StepResult& r = step.result;
  const double angle = r.error.head<3>().norm(), distance = r.error.tail<3>().norm();
  const Vector6& nu = step.controller.nu();
  const Vector6 got = step.controller.J() * r.command;
  const auto along = [](const Vector3& wanted, const Vector3& is) {  // [%]
    return 100.0 * (wanted.norm() > 1e-12 ? wanted.dot(is) / wanted.squaredNorm() : 1.0);
  };
  const std::string out = formatted(
      "The goal is %.4g m and %.4g rad away. The servo asks for %.4g m/s and %.4g rad/s; along that the command gives "
      "%.0f %% and %.0f %%.\n",
      distance, angle, nu.tail<3>().norm(), nu.head<3>().norm(), along(nu.tail<3>(), got.tail<3>()),
      along(nu.head<3>(), got.head<3>()));
  return out + describe_escape(step.controller) + describe_plan(step.given, step.controller);
}

std::string describe_surroundings(const CaseStep& step) {
  const ControllerCore& controller = step.controller;
  std::string out;
  if (controller.params().method == Method::kQp) {
    const auto pairs = controller.distances();
    int rows = 0, separation = 0;
    for (int i = 0; i < controller.problem().rows; ++i) {
      const RowKind kind = controller.problem().ids[static_cast<std::size_t>(i)].kind;
      separation += kind == RowKind::kSeparation ? 1 : 0;
      rows += is_collision(kind) ? 1 : 0;
    }
    out += formatted("%zu pairs are within their distance of influence, %d of them have a row", pairs.size(), rows);
    if (const int none = controller.rows_left_out(); none > 0)
      out += formatted(" (%d left out: nothing the robot can do would change them)", none);
    out += ".\n";
    if (separation > 0)
      out += formatted("%d %s the robot down towards what moves.\n", separation,
                       separation == 1 ? "row slows" : "rows slow");
  }
  return out + (step.result.manipulability < 1e-9
                    ? "The arm is at a singularity: the manipulability gradient is taken as zero.\n"
                    : "Manipulability " + number(step.result.manipulability) + ".\n");
}

}  // namespace

std::string explain(const ControlCase& control_case) {
  const CaseStep step(control_case);
  std::string out = "Status: " + std::string(to_string(step.result.status)) +
                    ", fallback: " + std::string(to_string(step.result.fallback)) + ".\n";
  for (const std::string& warning : control_case.warnings) out += "Warning: " + warning + "\n";
  if (step.result.status == StepStatus::kInvalidInput) {
    return out + "A number in the state, the goal or the objects leads to one that is not finite.\n";
  }
  out += describe_task(step) + describe_surroundings(step);
  if (step.controller.params().method != Method::kQp) {
    return out + "This method solves no QP: it knows neither obstacles nor joint limits.\n";
  }
  if (step.result.status == StepStatus::kInfeasible) out += describe_infeasible(step);
  out += describe_backup(step) + describe_fallback(step);
  if (!step.has_solution()) return out;
  return out + describe_unseen(step) + describe_active(step) + describe_cost(step);
}

}  // namespace moma
