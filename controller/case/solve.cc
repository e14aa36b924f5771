#include "controller/case/solve.h"

#include "controller/case/case_step.h"
#include "controller/case/plan_case.h"
#include "controller/config/write_described.h"
#include "controller/lookahead/lookahead.h"

namespace moma {
namespace {

Json listed(const Eigen::Ref<const VectorX>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(config::number_or_word(value));
  return out;
}

Json matrix(const Eigen::Ref<const MatrixX>& values) {
  Json out = Json::array();
  for (Eigen::Index i = 0; i < values.rows(); ++i) out.push_back(listed(values.row(i).transpose()));
  return out;
}

Json tool_pose(const Isometry& X) {
  Eigen::Quaterniond q(X.linear());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return {{"position", listed(X.translation())}, {"quaternion", {q.w(), q.x(), q.y(), q.z()}}};
}

Json distance(const ProximityPair& pair, const ControllerCore& controller) {
  const RobotModel& model = controller.model();
  static constexpr const char* kKinds[] = {"object", "floor", "self"};
  const char* const kind = kKinds[static_cast<std::size_t>(pair.kind)];
  const CollisionShape& shape = model.shape(pair.first);
  const std::string second = pair.kind == PairKind::kObject
                                 ? controller.object_names()[static_cast<std::size_t>(pair.second)]
                             : pair.kind == PairKind::kSelf ? model.shape(pair.second).name
                                                            : kind;
  return {{"link", model.link(shape.link).name},
          {"object", second},
          {"d", config::number_or_word(pair.distance.d)},
          {"normal", listed(pair.distance.n_W)},
          {"point_robot", listed(pair.distance.p_first_W)},
          {"point_object", listed(pair.distance.p_second_W)},
          {"shape", shape.name},
          {"kind", kind}};
}

// Closed-form methods pose no problem: their matrices are empty.
void add_problem(const ControllerCore& controller, Json& out) {
  const QpProblem& p = controller.problem();
  const bool qp = controller.params().method == Method::kQp;
  const int n = qp ? p.n() : 0;
  out["Q"] = matrix(MatrixX(p.H.head(n).asDiagonal()));
  out["c"] = listed(p.g.head(n));
  out["A"] = matrix(p.A.topRows(p.rows));
  out["lbA"] = listed(p.lbA.head(p.rows));
  out["ubA"] = listed(p.ubA.head(p.rows));
  out["lb"] = listed(p.lb.head(n));
  out["ub"] = listed(p.ub.head(n));
  out["rows"] = Json::array();
  for (int i = 0; i < p.rows; ++i) out["rows"].push_back(controller.row_name(i));
}

}  // namespace

Json solve(const ControlCase& control_case) {
  const CaseStep step(control_case);
  const ControllerCore& controller = step.controller;
  const StepResult& result = step.result;
  const bool qp = controller.params().method == Method::kQp;
  Json out = Json::object();
  out["status"] = to_string(result.status);
  out["fallback"] = to_string(result.fallback);
  out["qdot"] = listed(result.command);
  out["delta"] = controller.params().slack.enabled && qp ? listed(result.slack) : Json::array();
  out["cost"] = qp ? config::number_or_word(controller.cost()) : Json();
  out["pose"] = tool_pose(controller.kinematics().X_WE());
  out["error"] = listed(result.error);
  out["error_norm"] = config::number_or_word(result.error_norm);
  out["nu"] = listed(controller.nu());
  out["J"] = matrix(controller.J());
  out["manipulability"] = config::number_or_word(result.manipulability);
  out["J_m"] = listed(controller.J_m());
  out["theta_eps"] = config::number_or_word(controller.theta_eps());
  add_problem(controller, out);
  out["distances"] = Json::array();
  for (const ProximityPair& pair : controller.distances()) out["distances"].push_back(distance(pair, controller));
  out["wheels"] = listed(controller.wheels());
  out["kkt_residual"] = step.has_solution() ? config::number_or_word(controller.kkt_residual()) : Json();
  out["iterations"] = result.iterations;
  out["escape"] = config::write_described(controller.escape_state());  // the next step's `state.escape`
  if (controller.lookahead() != nullptr)
    out["plan"] = to_json(controller.lookahead()->state());  // and its `state.plan`
  return out;
}

std::string layout(const Json& solution) {
  const auto nested = [](const Json& value) {
    return value.is_array() && !value.empty() && (value.front().is_array() || value.front().is_object());
  };
  std::string out = "{";
  for (const auto& [key, value] : solution.items()) {
    out += (out.size() > 1 ? ",\n " : "\n ") + Json(key).dump() + ": ";
    if (!nested(value)) {
      out += value.dump();
      continue;
    }
    std::string rows;
    for (const Json& row : value) rows += (rows.empty() ? "[\n  " : ",\n  ") + row.dump();
    out += rows + "\n ]";
  }
  return out + "\n}\n";
}

}  // namespace moma
