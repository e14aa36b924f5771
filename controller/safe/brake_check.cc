#include "controller/safe/brake_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace moma {
namespace {

constexpr int kMostPlaces = 200;  // on one way to a stop
constexpr double kNear = 1.0;     // what is further takes no part in how wide margins may be [m]
constexpr double kWider = 1.5;    // and they may become so much wider on the way

// Of a velocity that falls evenly from 1 to 0 in `time`: the mean over [from, to].
double mean_left(double time, double from, double to) noexcept {
  const double a = std::min(from, time), b = std::min(to, time);
  return b > a ? ((b - a) - (b * b - a * a) / (2.0 * time)) / (to - from) : 0.0;
}

}  // namespace

OwnMargins own_margins(const DamperParams& floor, const DamperParams& self) noexcept {
  constexpr double kPart = 0.5;
  return {floor.enabled ? kPart * floor.stop : 0.0, self.enabled ? kPart * self.stop : 0.0};
}

BrakeCheck::BrakeCheck(std::shared_ptr<const RobotModel> model, const BrakeCheckParams& params,
                       const VectorX& acceleration, bool pair_together, double control_period,
                       const Uncertainty& uncertainty, const OwnMargins& own)
    : model_(std::move(model)),
      params_(params),
      own_(own),
      dt_(control_period),
      kinematics_(model_),
      proximity_(model_),
      ramp_(*model_),
      deceleration_(*model_, acceleration, pair_together),
      uncertainty_(uncertainty),
      J_(3, model_->num_velocities()),
      row_(VectorX::Zero(model_->num_velocities())),
      q_(VectorX::Zero(model_->num_joints())),
      mean_(VectorX::Zero(model_->num_velocities())),
      times_(mean_),
      trial_(mean_),
      full_(mean_),
      in_proportion_(mean_) {}

void BrakeCheck::set_objects(std::span<const ObjectShape> objects) {
  if (!on()) return;
  proximity_.set_objects(objects);
  states_.assign(objects.size(), ObjectState{});
}

double BrakeCheck::distance() noexcept {
  kinematics_.update(base_, q_);
  double d = std::numeric_limits<double>::infinity();
  const ProximityRanges ranges{params_.margin + widest_, own_.floor > 0.0 ? own_.floor : -1.0,
                               own_.self > 0.0 ? own_.self : -1.0};
  for (const ProximityPair& pair : proximity_.query(kinematics_, states_, ranges))
    d = std::min(d, pair.distance.d - margin_of(pair));
  return d < params_.margin ? d : std::numeric_limits<double>::infinity();
}

// What is kept beyond the margin; less than nothing of floor and self, which have their own. As kinematics_ stands.
double BrakeCheck::margin_of(const ProximityPair& pair) noexcept {
  if (pair.kind == PairKind::kFloor) return own_.floor - params_.margin;
  if (pair.kind == PairKind::kSelf) return own_.self - params_.margin;
  if (!uncertainty_.on()) return 0.0;
  const auto second = static_cast<std::size_t>(pair.second);
  kinematics_.point_jacobian(model_->shapes[static_cast<std::size_t>(pair.first)].link, pair.distance.p_first_W, J_);
  row_.noalias() = -J_.transpose() * pair.distance.n_W;
  return uncertainty_.margin(pair, kinematics_, row_, &states_[second],
                             second < spreads_.size() ? spreads_[second] : PlaceSpread{});
}

double BrakeCheck::widest_margin(const Observation& o) noexcept {
  if (!uncertainty_.on()) return 0.0;
  kinematics_.update(o.base, o.q);
  double widest = 0.0;
  for (const ProximityPair& pair : proximity_.query(kinematics_, states_, {kNear, -1.0, -1.0}))
    widest = std::max(widest, margin_of(pair));
  return kWider * widest;
}

double BrakeCheck::least_distance(const Observation& o, const VectorX& command, bool in_proportion) noexcept {
  base_ = o.base;
  q_ = o.q;
  deceleration_.stopping_times(command, times_);
  const double last = times_.maxCoeff();
  if (in_proportion) times_.setConstant(last);
  // The first period: the base still has to come to the command.
  mean_ = command;
  Vector3 velocity = Vector3::Zero(), wanted = Vector3::Zero();
  for (int i = 0; i < ramp_.dof(); ++i) {
    velocity[i] = o.qdot[i];
    wanted[i] = command[i];
  }
  const Vector3 ramped = ramp_.follow(wanted, dt_, velocity);
  for (int i = 0; i < ramp_.dof(); ++i) mean_[i] = ramped[i];
  integrate(*model_, base_, q_, mean_, dt_);
  double d = distance();
  const double part = params_.every * dt_;
  for (int k = 0; k < kMostPlaces && k * part < last; ++k) {
    const double from = k * part, to = std::min(from + part, last);
    for (Eigen::Index i = 0; i < mean_.size(); ++i) mean_[i] = command[i] * mean_left(times_[i], from, to);
    integrate(*model_, base_, q_, mean_, to - from);
    d = std::min(d, distance());
  }
  return d;
}

double BrakeCheck::clearance(const Observation& o, const VectorX& command) noexcept {
  const double d = least_distance(o, command, true);
  return d >= params_.margin ? d : std::max(d, least_distance(o, command, false));
}

double BrakeCheck::apply(const Observation& o, const Allowed& allowed, std::span<const PlaceSpread> spreads,
                         VectorX& command) noexcept {
  spreads_ = spreads;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    states_[i] = o.objects[i];
    if (!states_[i].V_WO_W.isZero(0.0)) states_[i].visible = false;
  }
  widest_ = widest_margin(o);
  double best = clearance(o, command);
  if (best >= params_.margin) return 1.0;
  double kept = 1.0;
  full_ = command;
  deceleration_.stopping_times(o.qdot, times_);
  in_proportion_ = (1.0 - dt_ / std::max(dt_, times_.maxCoeff())) * o.qdot;
  in_proportion_ = in_proportion_.cwiseMax(allowed.lower).cwiseMin(allowed.upper);
  for (const double share : {0.75, 0.5, 0.25, 0.0}) {
    for (const VectorX* slower : {static_cast<const VectorX*>(&in_proportion_), &allowed.slowest}) {
      trial_ = *slower + share * (full_ - *slower);
      const double d = clearance(o, trial_);
      if (!(d > best)) continue;
      best = d;
      kept = share;
      command = trial_;
      if (d >= params_.margin) return kept;
    }
  }
  return kept;
}

}  // namespace moma
