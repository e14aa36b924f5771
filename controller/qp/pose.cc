#include "controller/qp/pose.h"

#include <algorithm>
#include <utility>

#include "controller/model/base_kind.h"

namespace moma {
namespace {

// Six rows nu - Delta <= J qdot + delta <= nu + Delta; without slack x has no delta. Delta = 0: equalities.
void add_tracking_rows(const Matrix6X& J_WE_W, const Vector6& nu, const Vector6& band, bool slack,
                       QpProblem& problem) noexcept {
  const int nv = static_cast<int>(J_WE_W.cols());
  for (int i = 0; i < 6; ++i) {
    const int row = problem.append({RowKind::kTracking, i, -1}, nu[i] - band[i], nu[i] + band[i]);
    if (row < 0) return;
    problem.A.row(row).head(nv) = J_WE_W.row(i);
    if (slack) problem.A(row, nv + i) = 1.0;
  }
}

// Turns the rows of the rotation into axes of E, about which a free rotation turns, those of the place into axes of G.
// The row of a free direction bounds nothing.
void free_directions(const Kinematics& kinematics, const Task& task, QpProblem& problem) noexcept {
  const int nv = static_cast<int>(kinematics.J_WE_W().cols());
  const Matrix3 axes[] = {kinematics.X_WE().linear(), task.R_WG};
  for (int i = 0; i < 6; ++i) {
    const int first = 3 * (i / 3);
    const bool free = task.free[i] != 0.0;
    const Vector3 n_W = axes[i / 3].col(i % 3);
    const double band = 0.5 * (problem.ubA[i] - problem.lbA[i]);
    const double nu = n_W.dot(task.nu.segment<3>(first));
    problem.lbA[i] = free ? -kInfinity : nu - band;
    problem.ubA[i] = free ? kInfinity : nu + band;
    for (int j = 0; j < nv; ++j) problem.A(i, j) = n_W.dot(kinematics.J_WE_W().col(j).segment<3>(first));
  }
}

}  // namespace

QpPoser::QpPoser(std::shared_ptr<const RobotModel> model, const ControllerParams& params, double control_period)
    : model_(std::move(model)),
      params_(params),
      limits_(*model_, params, control_period),
      proximity_(model_),
      deceleration_(*model_, params.acceleration_limit, params.base_share > 0.0),
      uncertainty_(params.uncertainty, model_->base_dof()),
      collision_(*model_, params.collision, deceleration_, uncertainty_),
      separation_(*model_, params.collision, deceleration_, uncertainty_),
      upright_(params.upright, params.collision.braking, deceleration_, model_->num_velocities()),
      goal_clearance_(*model_),
      stop_(params.collision.object.stop) {
  bounds_.allocate(model_->num_velocities());
  const UnseenParams& unseen = params.map.unseen;
  collision_.keep_from_unseen({true, unseen.influence, unseen.stop, params.collision.object.gain});
}

void QpPoser::set_objects(std::span<const ObjectShape> objects) {
  const int nv = model_->num_velocities();
  const int num_objects = static_cast<int>(objects.size());
  proximity_.set_objects(objects);
  goal_clearance_.allocate(objects.size());
  const int near_rows = collision_.allocate(num_objects) + separation_.allocate(num_objects);
  const int drive_rows = limits_.linear_pair(VectorX::Zero(nv)).on ? 2 : 0;
  problem_.allocate(nv + (params_.slack.enabled ? 6 : 0),
                    6 + near_rows + num_wheels(model_->base) + drive_rows + upright_.most());
  objective_.allocate(problem_.n());
  if (params_.slack.enabled) {
    problem_.lb.tail<6>() = -params_.slack.limit;
    problem_.ub.tail<6>() = params_.slack.limit;
  }
}

Near QpPoser::near() const noexcept { return {collision_.sorted(), collision_.ranges()}; }

Near QpPoser::look(const Situation& now) noexcept {
  enter(now.clock, StepPart::kDistances);
  collision_.select(proximity_.query(now.kinematics, now.o.objects, collision_.ranges()), now.o.objects);
  return near();
}

// The hand's distance at its goal, and the path's own clearance, bound the stop distance.
double QpPoser::stop_near_goal(const QpTask& asked, const Situation& now) noexcept {
  const GoalClearanceParams& at_goal = params_.collision.at_goal;
  const double stop = params_.collision.object.stop;
  if (!at_goal.enabled) return stop;
  const Vector3& p_WE = now.kinematics.X_WE().translation();
  KeptDistance kept{at_goal.least, at_goal.slope, now.o.goal.X_WG.translation()};
  if (kept.of(stop, p_WE) < stop) {
    const double needed =
        goal_clearance_.least(now.kinematics, now.o.goal.X_WG, now.o.objects, stop / at_goal.part, proximity_);
    kept.at_goal = std::max(at_goal.least, at_goal.part * needed);
  } else {
    kept.at_goal = kInfinity;
  }
  return std::max(at_goal.least, std::min(kept.of(stop, p_WE), asked.keeps.of(stop, p_WE)));
}

Posed QpPoser::pose(const QpTask& asked, const Situation& now) noexcept {
  enter(now.clock, StepPart::kRows);
  asked_ = asked;
  deceleration_.set_slowing(now.execution.drive.slowing);

  const VelocityBounds& limits = asked.bounds != nullptr ? *asked.bounds : limits_;
  limits.bound(now.o.q, now.o.qdot, now.execution.hold, bounds_);
  if (asked.base) bounds_.hold_base(model_->base_dof(), *asked.base);
  if (asked.evades) bounds_.pair = {};
  problem_.lb.head(bounds_.lower.size()) = bounds_.lower;
  problem_.ub.head(bounds_.upper.size()) = bounds_.upper;

  problem_.rows = 0;
  stop_ = stop_near_goal(asked, now);
  // A path keeps clear of objects by itself: the damper's rate would slow it down.
  const bool on_path = asked.pull && asked.pull->velocities != nullptr;
  // On a path to a close goal only the hand comes nearer there than on the way. No goal brings the base near.
  const double on_way = std::max(stop_, asked.keeps.most);
  const double arm = asked.keeps.most < params_.collision.object.stop ? on_way : stop_;
  collision_.keep_from_resting({stop_, arm, on_way}, on_path ? params_.plan.follow.rate : 0.0);
  // Rows keep less than a path does; to brake before what it passes would lead off it.
  collision_.allow(asked.passes ? asked.pull->velocities : nullptr);
  add_tracking_rows(now.kinematics.J_WE_W(), asked.task.nu, params_.tracking_band, params_.slack.enabled, problem_);
  if (!asked.task.free.isZero(0.0)) free_directions(now.kinematics, asked.task, problem_);
  collision_.add(now.kinematics, now.o.objects, now.spreads, problem_);
  if (!asked.evades) {
    separation_.add(now.kinematics, proximity_, now.o.objects, now.spreads, problem_);
    add_wheel_rows(model_->base, problem_);
    add_drive_rows(bounds_.pair, problem_);
  }
  upright_.add(now, problem_);
  objective_.pose(params_, *model_, now, asked, problem_);
  return {asked_, bounds_, problem_, near(), stop_};
}

void QpPoser::clear() noexcept {
  problem_.clear();
  objective_.clear();
  asked_ = {};
}

}  // namespace moma
