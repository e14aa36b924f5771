#include "controller/lookahead/choice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/lookahead/rollout.h"
#include "controller/safe/pose_track.h"
#include "controller/step_described.h"

namespace moma {
namespace {

constexpr int kMoments = 40;        // of coming to rest
constexpr double kThinnest = 0.01;  // edge of a box [m]

}  // namespace

double comes_to_rest(const RobotModel& model, const MotionLimits& limits, const Observation& o, Rest rest,
                     WholeConfiguration& c) noexcept {
  const int base = model.base_dof();
  WholeConfiguration q = o.q, v = o.qdot, fall = o.qdot;
  Vector3 at = o.base;
  double time = 0.0;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    fall[i] = i >= base ? limits.joint_acceleration[i - base]
                        : (i + 1 == base ? limits.angular_acceleration : limits.linear_acceleration);
    time = std::max(time, std::abs(v[i]) / fall[i]);
  }
  if (rest == Rest::kEvenly && time > 0.0) fall = o.qdot.cwiseAbs() / time;
  for (int k = 0; k < kMoments && time > 0.0; ++k) {
    const double t = time * (k + 0.5) / kMoments;
    for (Eigen::Index i = 0; i < v.size(); ++i)
      v[i] = std::copysign(std::max(0.0, std::abs(o.qdot[i]) - fall[i] * t), o.qdot[i]);
    integrate(model, at, q, v, time / kMoments);
  }
  c.resize(3 + q.size());
  c << at, q;
  return time;
}

Choice::Choice(std::shared_ptr<const RobotModel> model, const ControllerParams& params)
    : model_(model),
      params_(params.plan),
      depth_(params.map.unseen.around),
      direct_way_(model, params),
      planner_(model, params),
      stand_(WholeConfiguration::Zero(3 + model->num_joints())) {
  from_.q = model->ready;
  from_.qdot = VectorX::Zero(model->num_velocities());
}

void Choice::reset(std::span<const ObjectShape> objects) {
  direct_way_.set_objects(objects);
  planner_.set_objects(objects);
  from_.objects.assign(objects.size(), ObjectState{});
  done_ = true;
}

MotionState Choice::motion_of(const Observation& o) const noexcept {
  MotionState motion{WholeConfiguration(3 + o.q.size()), WholeConfiguration::Zero(3 + o.q.size())};
  motion.c << o.base, o.q;
  if (o.qdot.lpNorm<Eigen::Infinity>() <= params_.decisions.standing) return motion;
  motion.v << planner_.limits().base->velocity_B(o.qdot), o.qdot.tail(o.q.size());
  motion.v.head<2>() = Eigen::Rotation2Dd(o.base.z()) * motion.v.head<2>();
  return motion;
}

void Choice::put(const MotionState& motion, Observation& o) const noexcept {
  const auto joints = o.q.size();
  o.base = motion.c.head<3>();
  o.q = motion.c.tail(joints);
  o.qdot.tail(joints) = motion.v.tail(joints);
  Vector3 v_B = motion.v.head<3>();
  v_B.head<2>() = Eigen::Rotation2Dd(-o.base.z()) * v_B.head<2>();
  planner_.limits().base->set_coordinates(v_B, o.qdot);
}

void Choice::begin(const Observation& from, double direct_time, int number, bool plans) noexcept {
  begin_way(from);
  verdict_ = {.kind = PlanKind::kPolicy, .tried = 1, .policy = direct_time};
  seed_ = static_cast<std::uint64_t>(number - 1);
  plans_ = 0;
  plans_paths_ = plans;
  direct_ = done_ = false;
}

void Choice::begin_way(const Observation& from) noexcept {
  copy_observation(from, from_);
  // Time after which the robot is expected where something is now.
  const auto meeting = [&](const Isometry& X) {
    const double way = (X.translation().head<2>() - from_.base.head<2>()).norm();
    const DecisionParams& decisions = params_.decisions;
    return model_->mobile() ? way / (decisions.meet_speed * model_->base.max_linear) : decisions.meet_time;
  };
  if (in_motion(from_.goal)) moma::advance(from_.goal.V_WG_W, meeting(from_.goal.X_WG), from_.goal.X_WG);
  around_ = false;
  for (ObjectState& object : from_.objects) {
    if (in_motion(object)) {
      moma::advance(object.V_WO_W, meeting(object.X_WO), object.X_WO);
      object.V_WO_W.setZero();  // plans keep clear of what stands
    }
    if (object.seen || !object.visible) continue;
    around_ = object.visible = depth_ > 0.0;
    object.box = (object.box.array() - 2.0 * depth_).max(kThinnest);
  }
  direct_way_.set_drive(drive_);
  planner_.set_drive(drive_);
  begin_way();
}

void Choice::begin_way() noexcept {
  on_way_ = true;
  direct_way_.begin(motion_of(from_), from_.goal.X_WG, from_.objects);
  stopping_ = comes_to_rest(*model_, planner_.limits(), from_, rest(), stand_);
}

// Begins again with ways through space that no sensor has seen. False if they had counted already.
bool Choice::go_through() noexcept {
  if (!std::exchange(around_, false)) return false;
  for (ObjectState& object : from_.objects)
    if (!object.seen) object.visible = false;
  plans_ = 0;
  begin_way();
  return true;
}

void Choice::end_way() noexcept {
  on_way_ = false;
  const double time = direct_way_.path().arrival();
  direct_ = direct_way_.found() && (verdict_.policy < 0.0 || time < verdict_.policy);
  if (direct_) {
    ++verdict_.tried;
    verdict_.by_path = time;
    verdict_.kind = PlanKind::kPath;
  }
  if (direct_ || !plans_paths_)
    done_ = direct_ || !go_through();
  else
    begin_plan();
}

// A path that takes longer than the policy is useless.
void Choice::begin_plan() noexcept {
  ++plans_;
  const double most = verdict_.policy >= 0.0 ? verdict_.policy : kInfinity;
  Braking braking;
  if (rest() == Rest::kEvenly) {
    braking = {WholeConfiguration(stand_.size()), stopping_};
    braking.from << from_.base, from_.q;
  }
  planner_.begin(stand_, from_.goal.X_WG, from_.objects, seed_, most - params_.settle - stopping_, braking,
                 {from_.goal.free, R_WG_});
}

bool Choice::advance(long& budget) noexcept {
  while (budget > 0 && !done_) {
    if (on_way_) {
      if (direct_way_.advance(budget)) break;
      end_way();
      continue;
    }
    if (planner_.advance(budget)) break;
    const bool again = planner_.close_goal() || (verdict_.policy < 0.0 && motion_of(from_).v.isZero(0.0));
    if (!planner_.found() && again && plans_ < params_.decisions.plans) {
      begin_plan();
      continue;
    }
    if (!planner_.found() && go_through()) continue;
    done_ = true;
    ++verdict_.tried;
    if (!planner_.found()) continue;
    verdict_.by_path = (rest() == Rest::kEach ? stopping_ : 0.0) + planner_.path().duration + params_.settle;
    if (verdict_.policy < 0.0 || verdict_.by_path < verdict_.policy) verdict_.kind = PlanKind::kPath;
  }
  return !done_;
}

}  // namespace moma
