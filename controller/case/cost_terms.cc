#include "controller/case/cost_terms.h"

namespace moma {

std::vector<CostTerm> cost_terms(const CaseStep& step) {
  const ControllerCore& controller = step.controller;
  const ControllerParams& params = controller.params();
  const RobotModel& model = controller.model();
  const int base = model.base_dof(), joints = model.num_joints(), velocities = model.num_velocities();
  const VectorX x = controller.solution().x.head(controller.problem().n());
  const auto qdot = x.head(velocities);
  const auto arm = x.segment(base, joints);
  const auto weight = [&](const Weight& w) { return w.inverse_error ? 1.0 / controller.task().error_norm : w.value; };

  std::vector<CostTerm> out;
  if (base > 0) out.push_back({"moving the base", 0.5 * weight(params.base_weight) * qdot.head(base).squaredNorm()});
  out.push_back({"moving the joints", 0.5 * params.lambda_q.dot(arm.cwiseAbs2())});
  if (params.slack.enabled && (params.slack.weight.inverse_error || params.slack.weight.value > 0.0)) {
    out.push_back(
        {"slack (not following the goal)",
         0.5 * weight(params.slack.weight) * controller.task().slack_scale.dot(x.tail<6>().cwiseAbs2().matrix())});
  }
  if (base > 0 && params.k_epsilon != 0.0)
    out.push_back({"turning the base to its work", -params.k_epsilon * controller.theta_eps() * qdot[base - 1]});
  if (params.manipulability.weight != 0.0)
    out.push_back({"manipulability", -params.manipulability.weight * controller.J_m().dot(arm)});
  const VectorX& measured = step.given.observation.qdot;
  if (params.acceleration_weight.maxCoeff() > 0.0) {
    out.push_back(
        {"acceleration", params.acceleration_weight.dot((0.5 * qdot - measured).cwiseProduct(qdot).matrix())});
  }
  if (params.posture.weight > 0.0) {
    const VectorX wanted = params.posture.gain * (params.posture.target - step.given.observation.q);
    out.push_back({"posture", params.posture.weight * (0.5 * arm - wanted).dot(arm)});
  }
  if (controller.task().detour && controller.params().escape.posture_weight > 0.0) {
    const EscapeParams& e = controller.params().escape;
    const VectorX wanted = e.posture_gain * (model.ready - step.given.observation.q);
    out.push_back({"posture of the detour", e.posture_weight * (0.5 * arm - wanted).dot(arm)});
  }
  return out;
}

}  // namespace moma
