#include "controller/plan/whole_body_ik.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "controller/model/manipulability.h"

namespace moma {
namespace {

constexpr int kIterations = 20;
constexpr double kPosition = 1e-3, kOrientation = 2e-3;  // [m, rad]
constexpr double kMostTurn = 0.6, kMostWay = 0.3;        // of one iteration [rad, m]
constexpr double kDamping = 1e-4;
constexpr double kPlaceWeight = 0.5;
constexpr int kLook = 4;       // iterations ...
constexpr double kFall = 0.5;  // ... after which no more than this part of the error is left, or it is given up
constexpr int kPasses = 4;     // in which joints come to their bounds
// A joint whose range lacks no more than this of a whole turn goes on from its other limit [rad].
constexpr double kGap = 0.3;

using Matrix6 = Eigen::Matrix<double, 6, 6>;

double shortened(double length, double most) noexcept { return length > most ? most / length : 1.0; }

}  // namespace

WholeBodyIk::WholeBodyIk(std::shared_ptr<const RobotModel> model, const WholeBodyIkParams& params,
                         const MotionLimits& limits)
    : model_(std::move(model)),
      params_(params),
      limits_(&limits),
      lower_(limits.num_joints()),
      upper_(limits.num_joints()),
      round_(limits.num_joints()) {
  for (int i = 0; i < limits.num_joints(); ++i) {
    const bool turns = model_->joint(i).type != JointType::kPrismatic;
    round_[i] = turns && limits.upper[i] - limits.lower[i] > kFullTurn - kGap ? 1 : 0;
  }
  keep_room(1.0);
}

void WholeBodyIk::keep_room(double room) noexcept {
  const MotionLimits& limits = *limits_;
  for (int i = 0; i < limits.num_joints(); ++i) {
    const double inside = std::min(room * (limits.margin[i] + limits.part[i] * params_.inside),
                                   0.45 * (limits.upper[i] - limits.lower[i]));
    lower_[i] = limits.lower[i] + inside;
    upper_[i] = limits.upper[i] - inside;
  }
}

bool WholeBodyIk::solve(FreeSpace& space, const Isometry& X_WG, WholeConfiguration& c, bool moves_base) const noexcept {
  const int joints = limits_->num_joints();
  const int n = 3 + joints;
  WholeJacobian J(6, n);
  Matrix6 M;
  WholeConfiguration weight(n), step(n);
  double before = kInfinity;
  for (int k = 0; k < kIterations; ++k) {
    space.charge(k % 2);
    const Kinematics& kinematics = space.place(c);
    const Vector6 e = pose_error(kinematics.X_WE(), X_WG);
    const double turn = e.head<3>().norm(), way = e.tail<3>().norm();
    if (way < kPosition && turn < kOrientation) return true;
    if (k % kLook == 0) {
      const double error = turn / kMostTurn + way / kMostWay;
      if (error > kFall * before) return false;
      before = error;
    }
    free_jacobian(kinematics, J);
    if (!limits_->mobile() || !moves_base) J.leftCols<3>().setZero();
    Vector6 wanted = e;
    wanted.head<3>() *= shortened(turn, kMostTurn);
    wanted.tail<3>() *= shortened(way, kMostWay);
    weight.setOnes();
    weight.head<2>().setConstant(kPlaceWeight);
    for (int pass = 0; pass < kPasses; ++pass) {
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j <= i; ++j) {
          double sum = i == j ? kDamping : 0.0;
          for (int l = 0; l < n; ++l) sum += weight[l] * J(i, l) * J(j, l);
          M(i, j) = M(j, i) = sum;
        }
      }
      const Vector6 y = M.ldlt().solve(wanted);
      for (int l = 0; l < n; ++l) {
        double sum = 0.0;
        for (int i = 0; i < 6; ++i) sum += J(i, l) * y[i];
        step[l] = weight[l] * sum;
      }
      bool beyond = false;
      for (int l = 3; l < n; ++l) {
        if (weight[l] == 0.0) continue;
        const double turned = c[l] + step[l] + turned_back(l - 3, c[l] + step[l]);
        const double to = std::clamp(turned, lower_[l - 3], upper_[l - 3]);
        if (to == turned) continue;
        weight[l] = 0.0;
        wanted -= (step[l] + (to - turned)) * J.col(l);
        c[l] = to;
        step[l] = 0.0;
        beyond = true;
      }
      if (!beyond) break;
    }
    c += step;
    for (int l = 3; l < n; ++l) c[l] += turned_back(l - 3, c[l]);
  }
  return false;
}

double WholeBodyIk::turned_back(int joint, double q) const noexcept {
  if (round_[joint] == 0 || (q >= lower_[joint] && q <= upper_[joint])) return 0.0;
  const double off = q - 0.5 * (limits_->lower[joint] + limits_->upper[joint]);
  return wrapped(off) - off;
}

void WholeBodyIk::seed(const FreeSpace& space, const Isometry& X_WG, const WholeConfiguration& start, int index,
                       CountedDraws& draws, WholeConfiguration& c) const noexcept {
  const int joints = limits_->num_joints();
  c = start;
  if (limits_->mobile()) {
    const Vector2 goal = X_WG.translation().head<2>();
    const double angle = draws.uniform(-std::numbers::pi, std::numbers::pi),
                 r = draws.uniform(params_.near, params_.far);
    Vector2 from = r * Vector2(std::cos(angle), std::sin(angle));
    if (index % 4 == 0) {
      from = start.head<2>() - goal;
      from *= shortened(from.norm(), params_.stand);
    }
    c.head<2>() = goal + from;
    const double anyhow = draws.uniform(-std::numbers::pi, std::numbers::pi);
    c[2] = index % 3 == 0 ? angle + std::numbers::pi : anyhow;
  }
  const int arm = index % 5;  // the start's, `ready`, or one of three that are drawn
  if (limits_->mobile() ? arm > 1 : index > 0) {
    constexpr double kRoom = 0.15;
    for (int i = 0; i < joints; ++i) {
      const bool winds = limits_->winds[i] != 0;
      const double low = winds ? space.lower()[i] : limits_->lower[i];
      const double high = winds ? space.upper()[i] : limits_->upper[i];
      const double room = winds ? 0.0 : std::min(limits_->part[i] * kRoom, 0.4 * (high - low));
      c[3 + i] = draws.uniform(low + room, high - room);
    }
  } else if (arm == 1) {
    c.tail(joints) = model_->ready;
  }
}

bool WholeBodyIk::find(FreeSpace& space, const Isometry& X_WG, const WholeConfiguration& start,
                       std::span<const GoalConfiguration> found, int index, CountedDraws& draws, bool hard,
                       WholeConfiguration& c) const noexcept {
  const bool stays = hard && limits_->mobile() && index % 3 == 1 &&
                     (X_WG.translation().head<2>() - start.head<2>()).norm() < params_.stay;
  if ((hard || !limits_->mobile()) && !found.empty() && index % 3 == 2) {
    c = found[draws.choice(found.size())].c;
    if (limits_->mobile()) {
      for (int i = 0; i < 2; ++i) c[i] += draws.uniform(-params_.place, params_.place);
      c[2] += draws.uniform(-params_.joints, params_.joints);
    }
    for (int i = 0; i < limits_->num_joints(); ++i)
      c[3 + i] = std::clamp(c[3 + i] + limits_->part[i] * draws.uniform(-params_.joints, params_.joints), lower_[i],
                            upper_[i]);
  } else {
    seed(space, X_WG, start, index, draws, c);
  }
  if (stays) c.head<3>() = start.head<3>();
  if (!solve(space, X_WG, c, !stays)) return false;
  space.unwind(c);
  c[2] = start[2] + wrapped(c[2] - start[2]);
  return true;
}

double WholeBodyIk::penalty(FreeSpace& space, double roomy, const WholeConfiguration& c) const noexcept {
  const int joints = limits_->num_joints();
  double cost = 0.0;
  const Clearances& now = space.clearances();
  if (now.object < roomy && !space.narrow() && !space.clear(c, {roomy, now.floor, now.self})) cost += params_.tight;
  for (int i = 0; i < joints; ++i) {
    const double room = std::min(limits_->upper[i] - c[3 + i], c[3 + i] - limits_->lower[i]);
    cost += params_.limit * std::max(0.0, 1.0 - room / (limits_->part[i] * params_.limit_room));
  }
  const double m = manipulability(space.place(c).J_WE_W().rightCols(joints), ManipulabilityRows::kTranslation);
  return cost + params_.singular * std::max(0.0, 1.0 - m / params_.agile);
}

}  // namespace moma
