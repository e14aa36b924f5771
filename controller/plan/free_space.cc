#include "controller/plan/free_space.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace moma {
namespace {

// Subtracted from the distance of a start that is nearer to an object than the clearances [m].
constexpr double kSpare = 0.003;

ProximityRanges ranges_of(const Clearances& c) noexcept { return {c.object, c.floor, c.self, 0.0}; }

}  // namespace

FreeSpace::FreeSpace(std::shared_ptr<const RobotModel> model, const MotionLimits& limits)
    : limits_(&limits),
      kinematics_(model),
      proximity_(model),
      goal_clearance_(*model),
      hand_(of_hand(*model)),
      keeps_{.clearances = {}, .at_goal = {}, .low = limits.lower, .high = limits.upper},
      point_(WholeConfiguration::Zero(3 + limits.num_joints())) {}

void FreeSpace::set_objects(std::span<const ObjectShape> objects) {
  proximity_.set_objects(objects);
  goal_clearance_.allocate(objects.size());
  states_.assign(objects.size(), ObjectState{});
  for (ObjectState& state : states_) state.visible = false;
}

void FreeSpace::set_states(std::span<const ObjectState> states) noexcept {
  const std::size_t count = std::min(states.size(), states_.size());
  for (std::size_t i = 0; i < count; ++i) {
    states_[i] = states[i];
    states_[i].visible = counts_for_plans(states[i]);
  }
  proximity_.hold(states_);
}

Kinematics& FreeSpace::place(const WholeConfiguration& c) noexcept {
  kinematics_.update(c.head<3>(), c.tail(c.size() - 3));
  return kinematics_;
}

void FreeSpace::set_clearances(const Clearances& clearances, const WholeConfiguration& start,
                               const WholeConfiguration& turn, double room) noexcept {
  keeps_.clearances = clearances;
  place(start);
  ++checks_;
  for (const ProximityPair& pair : proximity_.query(kinematics_, ranges_of(clearances))) {
    double& clearance = pair.kind == PairKind::kObject  ? keeps_.clearances.object
                        : pair.kind == PairKind::kFloor ? keeps_.clearances.floor
                                                        : keeps_.clearances.self;
    clearance = std::min(clearance, std::max(0.0, pair.distance.d - kSpare));
  }
  for (int i = 0; i < limits_->num_joints(); ++i) {
    keeps_.low[i] = std::min(limits_->lower[i] + room * limits_->margin[i], start[3 + i]);
    keeps_.high[i] = std::max(limits_->upper[i] - room * limits_->margin[i], start[3 + i]);
    if (limits_->winds[i] == 0) continue;
    keeps_.low[i] =
        std::clamp(turn[3 + i] - 0.5 * kFullTurn, keeps_.low[i], std::max(keeps_.low[i], keeps_.high[i] - kFullTurn));
    keeps_.high[i] = std::min(keeps_.high[i], keeps_.low[i] + kFullTurn);
  }
}

void FreeSpace::keep_upright(const std::optional<Upright>& upright, double share, const WholeConfiguration& start,
                             const Isometry& X_WG) noexcept {
  constexpr double kMore = 0.01;  // [rad]
  upright_ = upright;
  if (!upright) return;
  const double at_goal = std::min(upright->angle, tilt(*upright, X_WG.linear()) + kMore);
  upright_->angle = std::max({share * upright->angle, at_goal, tilt(*upright, place(start)) + kMore});
}

bool FreeSpace::bring_upright(WholeConfiguration& c) noexcept {
  constexpr double kInside = 0.8;  // share of the angle
  if (!upright_ || tilt(*upright_, place(c)) <= upright_->angle) return true;
  const int updates = moma::bring_upright(*upright_, kInside * upright_->angle, keeps_.low, keeps_.high, kinematics_,
                                          c.tail(c.size() - 3));
  checks_ += 2;
  return updates > 0;
}

void FreeSpace::vary_joints(double range, CountedDraws& draws, WholeConfiguration& c) const noexcept {
  for (int i = 0; i < limits_->num_joints(); ++i)
    c[3 + i] = std::clamp(c[3 + i] + limits_->part[i] * draws.uniform(-range, range), keeps_.low[i], keeps_.high[i]);
}

void FreeSpace::unwind(WholeConfiguration& c) const noexcept {
  for (int i = 0; i < limits_->num_joints(); ++i) {
    double& q = c[3 + i];
    if (limits_->winds[i] != 0 && (q < keeps_.low[i] || q > keeps_.high[i]))
      q -= kFullTurn * std::floor((q - keeps_.low[i]) / kFullTurn);
  }
}

bool FreeSpace::free(const WholeConfiguration& c) noexcept {
  for (int i = 0; i < limits_->num_joints(); ++i)
    if (c[3 + i] < keeps_.low[i] || c[3 + i] > keeps_.high[i]) return false;
  return clear(c, keeps_.clearances);
}

bool FreeSpace::clear(const WholeConfiguration& c, const Clearances& clearances) noexcept {
  ++checks_;
  kinematics_.place(c.head<3>(), c.tail(c.size() - 3));
  if (upright_ && tilt(*upright_, kinematics_) > upright_->angle) return false;
  ProximityRanges ranges = ranges_of(clearances);
  if (!(keeps_.at_goal.at_goal < ranges.object)) return proximity_.clear(kinematics_, ranges);
  // With half the clearances, half of the distances at the goal count.
  const double part =
      keeps_.clearances.object > 0.0 ? std::min(1.0, clearances.object / keeps_.clearances.object) : 1.0;
  ranges.object = std::min(ranges.object, part * keeps_.at_goal.of(kInfinity, hand()));
  if (!proximity_.clear(kinematics_, ranges)) return false;
  const double arm = std::min(clearances.object, part * keeps_.arm_at_goal);
  if (ranges.object >= arm) return true;
  // A goal brings the hand near objects, and no other part of the robot.
  for (const ProximityPair& pair : proximity_.query(kinematics_, {arm, -1.0, -1.0}))
    if (hand_[static_cast<std::size_t>(pair.first)] == 0) return false;
  return true;
}

// Position of E in the last configuration.
Vector3 FreeSpace::hand() const noexcept {
  const RobotModel& model = kinematics_.model();
  return kinematics_.X_WL(model.tip) * model.X_TE.translation();
}

// Limits the way between two checks to a multiple of the kept distance at `c`.
double FreeSpace::step_near(const WholeConfiguration& c, double step) noexcept {
  constexpr double kTimes = 2.3, kLeast = 0.012;  // [1, m]
  if (!narrow()) return step;
  kinematics_.place(c.head<3>(), c.tail(c.size() - 3));
  return std::clamp(kTimes * keeps_.at_goal.of(keeps_.clearances.object, hand()), kLeast, step);
}

bool FreeSpace::free(const Edge& edge, double step) noexcept {
  step = std::min(step_near(edge.a, step), step_near(edge.b, step));
  return free(longest_way(*limits_, edge), step, [&](double part, WholeConfiguration& c) {
    if (part < 1.0)
      edge_point(*limits_, edge, part, c);
    else
      c = edge.b;
  });
}

double FreeSpace::free_part(const Edge& edge, double step) noexcept {
  const double way = longest_way(*limits_, edge);
  step = std::min(step_near(edge.a, step), step_near(edge.b, step));
  const int parts = std::clamp(static_cast<int>(std::ceil(way / step)), 1, kMostParts);
  for (int k = 1; k <= parts; ++k) {
    edge_point(*limits_, edge, static_cast<double>(k) / parts, point_);
    if (!free(point_)) return static_cast<double>(k - 1) / parts;
  }
  return 1.0;
}

}  // namespace moma
