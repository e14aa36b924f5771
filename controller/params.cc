#include "controller/params.h"

#include <algorithm>
#include <cmath>

#include "controller/describe/check.h"
#include "controller/map/occupancy_map.h"
#include "controller/model/base_kind.h"
#include "controller/model/robot_model.h"
#include "controller/params_described.h"
#include "controller/qp/limits.h"

namespace moma {
namespace {

using description::short_text;

class Checker {
 public:
  Checker(const ControllerParams& params, const RobotModel& model, double control_period)
      : p_(params),
        model_(model),
        dt_(control_period),
        longest_(std::max(dt_, params.plan.enabled ? params.plan.step : 0.0)) {}

  std::vector<ParamsIssue> run() {
    if (!(dt_ > 0.0 && std::isfinite(dt_))) error("control_period", "must be a finite number above 0");
    for (const Violation& v : violations(p_, {model_.num_joints(), model_.num_velocities()})) error(v.key, v.message);
    if (!issues_.empty()) return issues_;
    if (p_.error_norm.min > p_.error_norm.max) error("error_norm.min", "must not be above error_norm.max");
    closed_forms();
    dampers();
    if (p_.joint_limits.method == JointLimitMethod::kSource) source_margins();
    if (p_.joint_limits.method == JointLimitMethod::kDamper) damper_margins();
    weights();
    safe();
    base_first();
    if (p_.plan.enabled) plan();
    return issues_;
  }

 private:
  void error(const std::string& key, const std::string& message) { issues_.push_back({key, message, false}); }
  void warning(const std::string& key, const std::string& message) { issues_.push_back({key, message, true}); }

  void closed_forms() {
    if (p_.method == Method::kQp) return;
    if (p_.escape.enabled) error("escape", "needs method qp: the closed forms know no obstacles and have no slack");
    const std::string no_obstacles = "needs method qp: the closed forms know no obstacles";
    if (p_.collision.braking.enabled) error("collision.braking", no_obstacles);
    if (p_.collision.check.enabled) error("collision.check", no_obstacles);
    if (p_.collision.separation.enabled) error("collision.separation", no_obstacles);
    if (p_.collision.evasion.enabled) error("collision.evasion", no_obstacles);
    if (p_.collision.at_goal.enabled) error("collision.at_goal", no_obstacles);
    if (p_.collision.relaxation != Relaxation::kCommon)
      error("collision.relaxation", "needs method qp: there are no rows");
    if (p_.base_share > 0.0) error("limits.base", "needs method qp: the closed forms know no accelerations");
  }

  void damper(const std::string& key, const DamperParams& d) {
    if (!(d.stop < d.influence))
      error(key + "stop",
            "must be below " + key + "influence = " + short_text(d.influence) + ", is " + short_text(d.stop));
  }

  void dampers() {
    damper("collision.", p_.collision.object);
    damper("collision.floor.", p_.collision.floor);
    damper("collision.self.", p_.collision.self);
  }

  void source_margins() {
    for (int i = 0; i < model_.num_joints(); ++i) {
      const ControlledJoint& joint = model_.joint(i);
      if (std::isinf(joint.lower) && std::isinf(joint.upper)) continue;
      const double margin = p_.joint_limits.margin.value[i];
      const double step = joint.velocity * longest_;
      if (!(margin > step)) {
        error("joint_limits.margin", "of " + joint.name + " is " + short_text(margin) +
                                         "; it must be above velocity limit x " + longest_name() + " = " +
                                         short_text(step) + ", or one step can overshoot the limit");
      } else if (!(joint.lower + margin < joint.upper - margin)) {
        error("joint_limits.margin", "of " + joint.name + " is " + short_text(margin) +
                                         "; it must be below half the joint's range, " +
                                         short_text(0.5 * (joint.upper - joint.lower)));
      }
    }
  }

  void damper_margins() {
    const JointLimitParams& d = p_.joint_limits;
    if (!(d.stop < d.influence)) {
      error("joint_limits.stop",
            "must be below joint_limits.influence = " + short_text(d.influence) + ", is " + short_text(d.stop));
      return;
    }
    if (d.gain * longest_ >= d.influence - d.stop) {
      error("joint_limits.gain", "of " + short_text(d.gain) + " x " + longest_name() +
                                     " must stay below influence - stop = " + short_text(d.influence - d.stop) +
                                     ", or the damper overshoots");
    }
    for (const ControlledJoint& joint : model_.joints) {
      if (std::isinf(joint.lower) && std::isinf(joint.upper)) continue;
      const double influence = limit_part(joint) * d.influence;
      if (!(influence > joint.velocity * longest_)) {
        error("joint_limits.influence",
              "of " + short_text(influence) + " must be above velocity limit x " + longest_name() + " of " +
                  joint.name + " = " + short_text(joint.velocity * longest_) + ", or one step can overshoot the limit");
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

  void safe() {
    const bool base = p_.base_share > 0.0 && model_.base_dof() > 0;
    if (base && p_.output_scaling.enabled)
      error("output_scaling", "cannot keep limits.base: it changes the command after the bounds");
    if (p_.uncertainty.enabled && !p_.prediction.enabled)
      error("uncertainty", "needs `prediction`: only its tracks know the noise that averaging leaves");
    const CollisionParams& c = p_.collision;
    if (c.check.enabled && c.object.enabled && c.check.margin > c.object.stop)
      warning("collision.check.margin", "of " + short_text(c.check.margin) +
                                            " is above collision.stop = " + short_text(c.object.stop) +
                                            ": the rows allow a distance at which the check stops the robot");
    if (p_.sight.enabled && model_.base_dof() > 0 && !(sight_speed(p_.sight, model_, p_.acceleration_limit[0]) > 0.0))
      error("limits.sight", "leaves no speed: range must be above reach + speed x reaction");
    const MapParams& map = p_.map;
    if (map.enabled && !p_.prediction.enabled)
      error("map", "needs `prediction`: it knows how old the measurements are");
    if (map.enabled && model_.sensors.empty()) warning("map", "stays empty: the robot file has no `sensors`");
    if (map.unseen.enabled && !(map.unseen.stop < map.unseen.influence))
      error("map.unseen.stop", "must be below map.unseen.influence = " + short_text(map.unseen.influence) + ", is " +
                                   short_text(map.unseen.stop));
    if (base && !p_.prediction.enabled) {
      warning("limits.base",
              "without `prediction` holds around the measured velocity: late measurements and drives "
              "then do more harm than without it");
    }
  }

  void base_first() {
    if (!p_.base_first.enabled) return;
    if (p_.method != Method::kQp) error("base_first", "is of method qp: the arm's part is its QP");
    if (p_.plan.enabled) error("base_first", "contradicts plan, whose paths move base and arm together");
    if (model_.base_dof() == 0) warning("base_first", "has no effect: the base does not move");
  }

  void plan() {
    const SearchParams& s = p_.plan.search;
    if (!(p_.plan.decisions.wait < p_.plan.decisions.meet)) error("plan.decisions.wait", "must be below meet");
    if (s.between + s.near_goal + s.near_start > 1.0)
      error("plan.search", "the shares between, near_goal and near_start must not exceed 1 together");
    if (s.base_alone + s.arm_alone > 1.0)
      error("plan.search", "the shares base_alone and arm_alone must not exceed 1 together");
  }

  const ControllerParams& p_;
  // The look-ahead simulates the same laws with its own step.
  const char* longest_name() const { return longest_ > dt_ ? "plan.step" : "control period"; }

  const RobotModel& model_;
  double dt_;
  double longest_;
  std::vector<ParamsIssue> issues_;
};

// Lets rows begin where a base at its full speed can still stop: v t + v^2/(2 a) before their stop, of which
// stoppable_speed() is the inverse. Up to the configured distance they are as configured.
void widen(DamperParams& rows, const BrakingParams& braking, const MobileBase& base) {
  const double v = base.max_linear;
  const double range = rows.stop + v * (braking.reaction + 0.5 * v / base.max_acceleration.x());
  if (!(range > rows.influence)) return;
  rows.gain *= (range - rows.stop) / (rows.influence - rows.stop);
  rows.influence = range;
}

}  // namespace

ControllerParams resolved(ControllerParams p, const RobotModel& model) {
  if (p.lambda_q.size() == 0) p.lambda_q = VectorX::Constant(model.num_joints(), 0.01);
  if (p.acceleration_weight.size() == 0) p.acceleration_weight = VectorX::Zero(model.num_velocities());
  if (p.acceleration_limit.size() == 0) p.acceleration_limit = VectorX::Constant(model.num_velocities(), kInfinity);
  if (p.base_share > 0.0) {
    for (int i = 0; i < model.base_dof(); ++i) {
      const Vector2& most = model.base.max_acceleration;
      const bool turn = i + 1 == model.base_dof();
      // Drives bound the length of (v_x, v_y); the QP has an octagon in that circle (qp/limits.h).
      const double inside = kind_of(model.base.type).lateral() && !turn ? kOctagon : 1.0;
      p.acceleration_limit[i] = p.base_share * inside * (turn ? most.y() : most.x());
    }
  }
  for (int i = 0; p.joint_share > 0.0 && i < model.num_joints(); ++i) {
    const double most = model.joint(i).acceleration;
    if (std::isfinite(most)) p.acceleration_limit[model.base_dof() + i] = p.joint_share * most;
  }
  if (model.base_dof() > 0 && p.collision.braking.enabled && p.collision.object.enabled)
    widen(p.collision.object, p.collision.braking, model.base);
  p.joint_limits.margin.value = resolve_margin(model, p.joint_limits.margin);
  if (p.posture.target.ready) p.posture.target.value = model.ready;
  return p;
}

std::vector<ParamsIssue> check_params(const ControllerParams& params, const RobotModel& model, double control_period) {
  return Checker(params, model, control_period).run();
}

}  // namespace moma
