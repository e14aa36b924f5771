#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "controller/case/case_step.h"
#include "controller/case/infeasible_set.h"
#include "controller/case/plan_words.h"
#include "controller/case/solve.h"
#include "controller/qp/limits.h"

namespace moma {
namespace {

constexpr double kActive = 1e-7;  // a value this near to its limit is held by it [m/s, rad/s]

std::string number(double value, const char* format = "%.4g") {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, format, value == 0.0 ? 0.0 : value);  // no "-0"
  return buffer;
}

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

// What makes this bound: read from the bounds that the step had.
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
  const ControlledJoint& joint = model.joints[static_cast<std::size_t>(i)];
  const double q = controller.kinematics().q()[i];
  const double room = upper ? joint.upper - q : q - joint.lower;
  return std::string("the ") + (upper ? "upper" : "lower") + " joint limit, " + number(room) + " away";
}

// What a row asks, in words.
std::string row_meaning(const QpProblem& problem, int row) {
  const RowId& id = problem.ids[static_cast<std::size_t>(row)];
  switch (id.kind) {
    case RowKind::kTracking: {
      static constexpr const char* kAxis[] = {"turn about x", "turn about y", "turn about z",
                                              "move along x", "move along y", "move along z"};
      return std::string(kAxis[id.first]) + " at " + number(problem.ubA[row]) + (id.first < 3 ? " rad/s" : " m/s");
    }
    case RowKind::kWheel:
      return "at most " + number(problem.ubA[row]) + " rad/s either way";
    case RowKind::kDrive:
      return "of what the drives can change in a period, " + number(0.5 * (problem.ubA[row] - problem.lbA[row])) +
             " m/s either way";
    case RowKind::kSeparation:
      return "may approach what moves at no more than " + number(problem.ubA[row]) + " m/s, to stand before they meet";
    case RowKind::kObject:
    case RowKind::kFloor:
    case RowKind::kSelf:
      break;
  }
  const std::string text = (id.d < 0.0 ? "overlapping by " : "distance ") + number(std::abs(id.d)) + " m, ";
  // The row says -n^T v <= bound: a negative bound asks for a retreat.
  const double bound = problem.ubA[row];
  return text + (bound >= 0.0 ? "may approach at no more than " : "must retreat at no less than ") +
         number(std::abs(bound)) + " m/s";
}

struct Active {
  std::string text;
  double multiplier;
};

std::string describe_active(const CaseStep& step, const StageCheck& check) {
  const QpProblem& p = check.problem;
  std::vector<Active> active;
  for (int i = 0; i < p.rows; ++i) {
    const RowKind kind = p.ids[static_cast<std::size_t>(i)].kind;
    if (kind == RowKind::kTracking) continue;  // told apart, by the slack
    const double value = p.A.row(i).dot(check.x);
    if (p.ubA[i] - value > kActive && value - p.lbA[i] > kActive) continue;
    active.push_back({step.controller.row_name(i) + ": " + row_meaning(p, i), std::abs(check.report.y[i])});
  }
  const int named = step.controller.problem().n();
  for (int i = 0; i < named; ++i) {
    const bool upper = p.ub[i] - check.x[i] <= kActive;
    if (!upper && check.x[i] - p.lb[i] > kActive) continue;
    const double bound = upper ? p.ub[i] : p.lb[i];
    active.push_back({name_of(step.controller, i) + " at " + number(bound) + " " + unit_of(step.controller, i) + ": " +
                          bound_cause(step, i, upper, bound),
                      std::abs(check.report.z[i])});
  }
  if (active.empty()) return "No limit and no obstacle holds the command: it is what the terms below want.\n";
  std::stable_sort(active.begin(), active.end(),
                   [](const Active& a, const Active& b) { return a.multiplier > b.multiplier; });
  std::string out = "What holds the command (strongest first; the number is the cost saved per unit of relaxation):\n";
  for (const Active& a : active) out += "  " + number(a.multiplier, "%9.3g") + "  " + a.text + "\n";
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
    out +=
        "  " + number(term.value, "%10.3g") + "  " + number(share, "%3.0f") + " %  " + std::string(term.words) + "\n";
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
    out += "  " + name_of(step.controller, id.index) + (upper ? " <= " : " >= ") + number(bound) + " " +
           unit_of(step.controller, id.index) + ": " + bound_cause(step, id.index, upper, bound) + "\n";
  }
  return out;
}

std::string describe_evasion(const CaseStep& step) {
  return step.controller.evades()
             ? "The base drives off: what was asked for leaves no way out of the way of what moves.\n"
             : "";
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
    return "On detour " + std::to_string(state.stagnations) + ", to (" + number(p.x()) + ", " + number(p.y()) + ", " +
           number(p.z()) + ") for another " + number(state.remaining) + " s; its orientation is nearly free.\n";
  }
  std::string out = "The way left has not become shorter than " + number(state.best) + " m for " + number(state.idle) +
                    " s, and stagnated " + std::to_string(state.stagnations) + " times.\n";
  return out;
}

std::string describe_task(const CaseStep& step) {
  const StepResult& r = step.result;
  const double angle = r.error.head<3>().norm(), distance = r.error.tail<3>().norm();
  std::string out = "The goal is " + number(distance) + " m and " + number(angle) + " rad away.";
  const Vector6& nu = step.controller.nu();
  const Vector6 got = step.controller.J() * r.command;
  const auto along = [&](auto wanted, auto is) {
    return wanted.norm() > 1e-12 ? wanted.dot(is) / wanted.squaredNorm() : 1.0;
  };
  out += " The servo asks for " + number(nu.tail<3>().norm()) + " m/s and " + number(nu.head<3>().norm()) +
         " rad/s; along that the command gives " +
         number(100.0 * along(nu.tail<3>().eval(), got.tail<3>().eval()), "%.0f") + " % and " +
         number(100.0 * along(nu.head<3>().eval(), got.head<3>().eval()), "%.0f") + " %.\n";
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
    out += std::to_string(pairs.size()) + " pairs are within their distance of influence, " + std::to_string(rows) +
           " of them have a row";
    if (const long long none = controller.counters().rows_left_out; none > 0)
      out += " (" + std::to_string(none) + " left out: nothing the robot can do would change them)";
    out += ".\n";
    if (separation > 0)
      out += std::to_string(separation) + (separation == 1 ? " row slows" : " rows slow") +
             " the robot down towards what moves.\n";
  }
  if (step.result.manipulability < 1e-9) {
    out += "The arm is at a singularity: the manipulability gradient is taken as zero.\n";
  } else {
    out += "Manipulability " + number(step.result.manipulability) + ".\n";
  }
  return out;
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
  out += describe_evasion(step) + describe_fallback(step);
  if (!has_solution(step)) return out;
  return out + describe_active(step, check_stage(step)) + describe_cost(step);
}

}  // namespace moma
