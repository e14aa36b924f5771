#include "controller/params.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "controller/qp/limits.h"

namespace moma {
namespace {

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

class Checker {
 public:
  Checker(const ControllerParams& params, const RobotModel& model, double control_period)
      : p_(params), model_(model), dt_(control_period) {}

  std::vector<ParamsIssue> run() {
    if (!(dt_ > 0.0 && std::isfinite(dt_))) error("control_period", "must be a finite number above 0");
    sizes();
    if (!issues_.empty()) return issues_;
    numbers();
    dampers();
    if (p_.joint_limits.method == JointLimitMethod::kSource) source_margins();
    if (p_.joint_limits.method == JointLimitMethod::kDamper) damper_margins();
    weights();
    return issues_;
  }

 private:
  void error(const std::string& key, const std::string& message) { issues_.push_back({key, message, false}); }
  void warning(const std::string& key, const std::string& message) { issues_.push_back({key, message, true}); }

  void size(const std::string& key, const VectorX& v, int wanted, const char* of) {
    if (v.size() != wanted) {
      error(key, "has " + std::to_string(v.size()) + " values, the robot has " + std::to_string(wanted) + " " + of);
    }
  }

  void sizes() {
    size("lambda_q", p_.lambda_q, model_.num_joints(), "joints");
    size("joint_limits.margin", p_.joint_limits.margin, model_.num_joints(), "joints");
    size("acceleration.weight", p_.acceleration_weight, model_.num_velocities(), "velocities");
    size("limits.acceleration", p_.acceleration_limit, model_.num_velocities(), "velocities");
    size("posture.target", p_.posture.target, model_.num_joints(), "joints");
  }

  void finite(const std::string& key, double value, bool positive) {
    if (!std::isfinite(value) || value < 0.0 || (positive && value == 0.0))
      error(key,
            std::string("must be a finite number ") + (positive ? "above 0" : "of at least 0") + ", is " + text(value));
  }
  void positive_or_inf(const std::string& key, double value) {
    if (!(value > 0.0)) error(key, "must be above 0 or infinite, is " + text(value));
  }

  void numbers() {
    finite("servo.position", p_.servo.position, false);
    finite("servo.orientation", p_.servo.orientation, false);
    positive_or_inf("servo.max_linear", p_.servo.max_linear);
    positive_or_inf("servo.max_angular", p_.servo.max_angular);
    finite("error_norm.min", p_.error_norm.min, true);
    finite("error_norm.max", p_.error_norm.max, true);
    finite("error_norm.scale", p_.error_norm.scale, false);
    if (p_.error_norm.min > p_.error_norm.max) error("error_norm.min", "must not be above error_norm.max");
    if (!p_.base_weight.inverse_error) finite("base_weight", p_.base_weight.value, false);
    if (!p_.slack.weight.inverse_error) finite("slack.weight", p_.slack.weight.value, false);
    for (const double v : p_.lambda_q) finite("lambda_q", v, false);
    for (const double v : p_.slack.limit) positive_or_inf("slack.limit", v);
    for (const double v : p_.tracking_band) finite("tracking_band", v, false);
    for (const double v : p_.acceleration_weight) finite("acceleration.weight", v, false);
    for (const double v : p_.acceleration_limit) positive_or_inf("limits.acceleration", v);
    finite("k_epsilon", p_.k_epsilon, false);
    finite("manipulability.weight", p_.manipulability.weight, false);
    finite("posture.weight", p_.posture.weight, false);
    finite("posture.gain", p_.posture.gain, false);
    if (!p_.posture.target.allFinite()) error("posture.target", "must be finite");
    if (p_.output_scaling.enabled) {
      finite("output_scaling.far", p_.output_scaling.far, true);
      finite("output_scaling.near", p_.output_scaling.near, true);
      finite("output_scaling.switch", p_.output_scaling.switch_distance, true);
    }
    escape();
    finite("collision.passing.horizon", p_.collision.passing.horizon, true);
    finite("collision.passing.clearance", p_.collision.passing.clearance, false);
    if (p_.collision.max_pairs < 0) error("collision.max_pairs", "must be at least 0");
  }

  void escape() {
    const EscapeParams& e = p_.escape;
    const VortexParams& v = p_.servo.vortex;
    finite("collision.end_rows", p_.collision.end_rows, false);
    finite("servo.vortex.gain", v.gain, false);
    finite("servo.vortex.distance", v.distance, true);
    finite("escape.scale", e.scale, false);
    finite("escape.progress", e.progress, true);
    finite("escape.patience", e.patience, true);
    finite("escape.traffic_patience", e.traffic_patience, true);
    finite("escape.position", e.position, false);
    finite("escape.orientation", e.orientation, false);
    finite("escape.side_distance", e.side_distance, true);
    finite("escape.angle", e.angle, false);
    finite("escape.length", e.length, true);
    finite("escape.growth", e.growth, false);
    finite("escape.max_length", e.max_length, true);
    finite("escape.duration", e.duration, true);
    finite("escape.reached", e.reached, false);
    finite("escape.slack_factor", e.slack_factor, true);
    finite("escape.posture.weight", e.posture_weight, false);
    finite("escape.posture.gain", e.posture_gain, false);
    finite("escape.around.clearance", e.around.clearance, false);
    finite("escape.around.reach", e.around.reach, false);
    finite("escape.around.passed", e.around.passed, true);
    finite("escape.around.duration", e.around.duration, true);
    if (p_.method == Method::kQp) return;
    if (e.enabled) error("escape", "needs method qp: the closed forms know no obstacles and have no slack");
    if (v.enabled) error("servo.vortex", "needs method qp: the closed forms know no obstacles");
  }

  void damper(const std::string& key, const DamperParams& d) {
    finite(key + "influence", d.influence, true);
    finite(key + "stop", d.stop, false);
    finite(key + "gain", d.gain, true);
    if (!(d.stop < d.influence))
      error(key + "stop", "must be below " + key + "influence = " + text(d.influence) + ", is " + text(d.stop));
  }

  void dampers() {
    damper("collision.", p_.collision.object);
    damper("collision.floor.", p_.collision.floor);
    damper("collision.self.", p_.collision.self);
  }

  void source_margins() {
    for (int i = 0; i < model_.num_joints(); ++i) {
      const ControlledJoint& joint = model_.joints[static_cast<std::size_t>(i)];
      if (std::isinf(joint.lower) && std::isinf(joint.upper)) continue;
      const double margin = p_.joint_limits.margin[i];
      const double step = joint.velocity * dt_;
      if (!(margin > step)) {
        error("joint_limits.margin", "of " + joint.name + " is " + text(margin) +
                                         "; it must be above velocity limit x control period = " + text(step) +
                                         ", or one step can overshoot the limit");
      } else if (!(joint.lower + margin < joint.upper - margin)) {
        error("joint_limits.margin", "of " + joint.name + " is " + text(margin) +
                                         "; it must be below half the joint's range, " +
                                         text(0.5 * (joint.upper - joint.lower)));
      }
    }
  }

  void damper_margins() {
    const JointLimitParams& d = p_.joint_limits;
    finite("joint_limits.gain", d.gain, true);
    finite("joint_limits.influence", d.influence, true);
    finite("joint_limits.stop", d.stop, false);
    if (!(d.stop < d.influence)) {
      error("joint_limits.stop",
            "must be below joint_limits.influence = " + text(d.influence) + ", is " + text(d.stop));
      return;
    }
    if (d.gain * dt_ >= d.influence - d.stop) {
      error("joint_limits.gain", "of " + text(d.gain) + " x control period must stay below influence - stop = " +
                                     text(d.influence - d.stop) + ", or the damper overshoots");
    }
    for (const ControlledJoint& joint : model_.joints) {
      if (std::isinf(joint.lower) && std::isinf(joint.upper)) continue;
      if (!(d.influence > joint.velocity * dt_)) {
        error("joint_limits.influence", "of " + text(d.influence) +
                                            " must be above velocity limit x control period of " + joint.name + " = " +
                                            text(joint.velocity * dt_) + ", or one step can overshoot the limit");
        return;
      }
    }
  }

  void weights() {
    const bool projected = p_.method == Method::kPark || p_.method == Method::kBaur;
    if (projected && !(p_.lambda_q.minCoeff() > 0.0))
      error("lambda_q", "must be above 0: methods park and baur divide by it");
    if (p_.method != Method::kQp) return;
    if (p_.slack.enabled && !p_.slack.weight.inverse_error && p_.slack.weight.value == 0.0) {
      warning("slack.weight", "is 0: with delta nearly free, nothing pulls the arm to its goal");
    }
  }

  const ControllerParams& p_;
  const RobotModel& model_;
  double dt_;
  std::vector<ParamsIssue> issues_;
};

}  // namespace

ControllerParams resolved(ControllerParams p, const RobotModel& model) {
  if (p.lambda_q.size() == 0) p.lambda_q = VectorX::Constant(model.num_joints(), 0.01);
  if (p.acceleration_weight.size() == 0) p.acceleration_weight = VectorX::Zero(model.num_velocities());
  if (p.acceleration_limit.size() == 0) p.acceleration_limit = VectorX::Constant(model.num_velocities(), kInfinity);
  if (p.joint_limits.auto_margin) p.joint_limits.margin = resolve_margin(model, p.joint_limits);
  if (p.posture.ready) p.posture.target = model.ready;
  return p;
}

std::vector<ParamsIssue> check_params(const ControllerParams& params, const RobotModel& model, double control_period) {
  return Checker(params, model, control_period).run();
}

}  // namespace moma
