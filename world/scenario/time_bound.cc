#include "world/scenario/time_bound.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/model/base_kind.h"
#include "controller/model/kinematics.h"
#include "world/draws.h"

namespace moma {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kApproach = 20;                            // iterations until a try is near the goal, else it ends
constexpr double kNearTurn = 0.2, kNearWay = 0.1;        // error of a configuration near the goal [rad, m]
constexpr int kIterations = 12;                          // of the descent from there
constexpr double kFirstStep = 0.1;                       // of the descent, as a part of the present time
constexpr double kShrink = 0.75;                         // of the step from one iteration to the next
constexpr double kPower = 8.0;                           // of the norm that stands for the longest of all times
constexpr double kMostTurn = 0.6, kMostWay = 0.3;        // correction of one iteration [rad, m]
constexpr double kPosition = 1e-3, kOrientation = 2e-3;  // error of a configuration at the goal [m, rad]
constexpr double kDamping = 1e-3;
constexpr double kNullSpace = 0.02;  // least share of the slope in the null space
constexpr double kNearby = 2.0;      // most by which joints of a try differ from the start [rad]
constexpr double kReach = 0.9;       // of a base from the goal [m]

// Least time of a turn by `first` and then by `second` [rad], with a stop in between if they are opposite.
double turning_time(double first, double second, const RampLimits& limits) noexcept {
  if (first * second >= 0.0) return rest_to_rest(std::abs(first + second), limits);
  return rest_to_rest(std::abs(first), limits) + rest_to_rest(std::abs(second), limits);
}

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 3 + kMaxJoints>;

// Configurations are (x, y, phi | q), or q alone for a robot that is bolted down.
class Search {
 public:
  Search(const std::shared_ptr<const RobotModel>& model, const World& world)
      : model_(*model), world_(world), kinematics_(model), bases_(model->mobile() ? 3 : 0) {
    const MobileBase& base = model_.base;
    linear_ = {base.max_linear, base.max_acceleration[0]};
    angular_ = {base.max_angular, base.max_acceleration[1]};
    const Eigen::Index n = bases_ + model_.num_joints();
    lower_ = VectorX::Constant(n, -std::numeric_limits<double>::infinity());
    upper_ = -lower_;
    metric_ = VectorX::Ones(n);
    for (int i = 0; i < model_.num_joints(); ++i) {
      const ControlledJoint& joint = model_.joint(i);
      joints_.push_back({joint.velocity, joint.acceleration, joint.jerk});
      lower_[bases_ + i] = joint.lower;
      upper_[bases_ + i] = joint.upper;
      metric_[bases_ + i] = joint.velocity * joint.velocity;
    }
    if (bases_ > 0)
      metric_.head<3>() << Vector2::Constant(linear_.speed * linear_.speed), angular_.speed * angular_.speed;
    start_ = joined(world.start);
    times_.reserve(static_cast<std::size_t>(1 + model_.num_joints()));
  }

  const TimeBound& best() const noexcept { return best_; }

  void from_witness() {
    if (world_.witness.q.size() == model_.num_joints()) descend(joined(world_.witness));
  }

  void from_nearby(Draws& draws) {
    VectorX x = start_;
    const double apart = kNearby * draws.uniform();
    for (int i = 0; i < model_.num_joints(); ++i) {
      const double part = model_.joint(i).type == JointType::kPrismatic ? 0.3 : 1.0;
      const double to = x[bases_ + i] + part * draws.uniform(-apart, apart);
      x[bases_ + i] = std::clamp(to, lower_[bases_ + i], upper_[bases_ + i]);
    }
    if (bases_ > 0) {
      const Vector2 goal = world_.goal.X_WG.translation().head<2>();
      const Vector2 way = goal - start_.head<2>();
      const double from = std::atan2(-way.y(), -way.x()) + draws.uniform(-1.2, 1.2);
      x.head<2>() = goal + std::min(way.norm(), kReach * draws.uniform()) * Vector2(std::cos(from), std::sin(from));
      x[2] = start_[2] + wrapped(draws.choice(2) == 0 ? from + kPi - start_[2] : draws.uniform(-kPi, kPi));
    }
    descend(std::move(x));
  }

 private:
  VectorX joined(const Configuration& c) const {
    VectorX x(bases_ + c.q.size());
    if (bases_ > 0) x.head<3>() = c.base;
    x.tail(c.q.size()) = c.q;
    return x;
  }

  double driving_time(const VectorX& x) const noexcept {
    const Vector2 way = x.head<2>() - start_.head<2>();
    const double turn = wrapped(x[2] - start_[2]);
    const double drive = rest_to_rest(way.norm(), linear_);
    if (!kind_of(model_.base.type).nonholonomic() || way.norm() < 1e-9)
      return std::max(drive, rest_to_rest(std::abs(turn), angular_));
    const double ahead = wrapped(std::atan2(way.y(), way.x()) - start_[2]), back = wrapped(ahead + kPi);
    return std::max(drive, std::min(turning_time(ahead, wrapped(turn - ahead), angular_),
                                    turning_time(back, wrapped(turn - back), angular_)));
  }

  double joint_time(const VectorX& x, Eigen::Index i) const noexcept {
    return rest_to_rest(std::abs(x[bases_ + i] - start_[bases_ + i]), joints_[static_cast<std::size_t>(i)]);
  }

  // Times of the base, if it moves, and of each joint at x, into times_. Returns the longest.
  double time(const VectorX& x) noexcept {
    times_.clear();
    if (bases_ > 0) times_.push_back(driving_time(x));
    for (int i = 0; i < model_.num_joints(); ++i) times_.push_back(joint_time(x, i));
    return *std::max_element(times_.begin(), times_.end());
  }

  // Gradient of (sum t^p)^(1/p) over base and joints, by differences of the single times, of which times_ has those at
  // x and `now` is the longest.
  void gradient(VectorX& x, double now, VectorX& out) const noexcept {
    constexpr double kStep = 1e-6;
    const double longest = std::max(now, 1e-9);
    double sum = 0.0;
    const auto add = [&](double t, Eigen::Index first, Eigen::Index count, const auto& time_of) {
      const double weight = std::pow(t / longest, kPower - 1.0);
      sum += std::pow(t / longest, kPower);
      for (Eigen::Index at = first; at < first + count; ++at) {
        const double was = x[at];
        x[at] += kStep;
        out[at] = weight * (time_of() - t) / kStep;
        x[at] = was;
      }
    };
    auto t = times_.begin();
    if (bases_ > 0) add(*t++, 0, 3, [&] { return driving_time(x); });
    for (Eigen::Index i = 0; i < model_.num_joints(); ++i) add(*t++, bases_ + i, 1, [&] { return joint_time(x, i); });
    out *= std::pow(sum, 1.0 / kPower - 1.0);
  }

  Vector6 error(const VectorX& x) noexcept {
    kinematics_.update(bases_ > 0 ? Vector3(x.head<3>()) : world_.start.base, x.tail(model_.num_joints()));
    return pose_error(kinematics_.X_WE(), world_.goal.X_WG);
  }

  // A joint takes the turn that is nearest to the start, where its limits allow it.
  void unwind(VectorX& x) const noexcept {
    for (int i = 0; i < model_.num_joints(); ++i) {
      const Eigen::Index at = bases_ + i;
      const double nearest = start_[at] + wrapped(x[at] - start_[at]);
      if (model_.joint(i).type != JointType::kPrismatic && nearest >= lower_[at] && nearest <= upper_[at])
        x[at] = nearest;
    }
  }

  // Damped least squares until E is near the goal, then projected descent in the metric of the squared speeds: the part
  // of a step in the null space of the goal makes the motion quicker, the other part keeps E at the goal. Steps shrink
  // at a fixed rate, so that the last ones stay at the goal.
  void descend(VectorX x) {
    const Eigen::Index n = x.size();
    Jacobian J(6, n);
    VectorX slope(n), free(n), step(n), down(n), along(n);
    double length = kFirstStep;
    for (int k = 0, left = kIterations; left > 0; ++k) {
      Vector6 e = error(x);
      const double turn = e.head<3>().norm(), way = e.tail<3>().norm();
      const bool near = turn < kNearTurn && way < kNearWay;
      if (!near && k >= kApproach) return;
      const double now = near ? time(x) : 0.0;
      if (near && turn < kOrientation && way < kPosition && now < best_.time)
        best_ = {now, {kinematics_.base(), kinematics_.q()}};
      if (turn > kMostTurn) e.head<3>() *= kMostTurn / turn;
      if (way > kMostWay) e.tail<3>() *= kMostWay / way;
      if (bases_ > 0) {
        free_jacobian(kinematics_, J);
      } else {
        J = kinematics_.J_WE_W();
      }
      if (near) gradient(x, now, slope);
      free = metric_;
      // A joint that would leave its range stops at the limit, and the others make up for it.
      for (int pass = 0; pass < 2; ++pass) {
        const Matrix6 M = J * free.asDiagonal() * J.transpose() + kDamping * Matrix6::Identity();
        const Eigen::LDLT<Matrix6> ldlt(M);
        step = free.cwiseProduct(J.transpose() * ldlt.solve(e));
        if (near) {
          down = free.cwiseProduct(slope);
          along = down - free.cwiseProduct(J.transpose() * ldlt.solve(Vector6(J * down)));
          const double rate = slope.dot(along);
          // An arm that is not redundant has no null space: what damping leaves of it leads off the goal.
          if (rate > kNullSpace * slope.dot(down)) step -= length * now / rate * along;
        }
        bool beyond = false;
        for (Eigen::Index i = 0; i < n; ++i) {
          const double to = std::clamp(x[i] + step[i], lower_[i], upper_[i]);
          if (to == x[i] + step[i]) continue;
          e -= (to - x[i]) * J.col(i);
          x[i] = to;
          free[i] = step[i] = 0.0;
          beyond = true;
        }
        if (!beyond) break;
      }
      x = (x + step).cwiseMax(lower_).cwiseMin(upper_);
      unwind(x);
      if (!near) continue;
      length *= kShrink;
      --left;
    }
  }

  const RobotModel& model_;
  const World& world_;
  Kinematics kinematics_;
  Eigen::Index bases_;
  RampLimits linear_, angular_;
  std::vector<RampLimits> joints_;
  VectorX lower_, upper_, metric_, start_;
  std::vector<double> times_;
  TimeBound best_;
};

}  // namespace

double rest_to_rest(double way, const RampLimits& limits) noexcept {
  if (way <= 0.0) return 0.0;
  const double v = limits.speed, a = limits.acceleration, j = limits.jerk;
  if (std::isinf(a) && std::isinf(j)) return way / v;
  const bool reaches_a = v * j >= a * a;  // before the greatest speed
  const double ramp = reaches_a ? v / a + a / j : 2.0 * std::sqrt(v / j);
  if (way >= v * ramp) return way / v + ramp;
  if (reaches_a && way * j * j >= 2.0 * a * a * a) return a / j + std::sqrt(a / j * (a / j) + 4.0 * way / a);
  return 4.0 * std::cbrt(way / (2.0 * j));
}

TimeBound time_bound(const std::shared_ptr<const RobotModel>& model, const World& world, int tries) {
  Search search(model, world);
  search.from_witness();
  Draws draws(world.seed, world.index, Stream::kTimeBound);
  for (int k = 0; k < (std::isinf(search.best().time) ? 10 * tries : tries); ++k) search.from_nearby(draws);
  return search.best();
}

}  // namespace moma
