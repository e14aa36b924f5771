#include "controller/qp/collision.h"

#include <algorithm>
#include <cmath>

namespace moma {
namespace {

// Height above its support at which the carried object counts: about the rows' stop distance, so that they hold it
// where it stands, and lift it where it is pressed in [m].
constexpr double kRaised = 0.03;

}  // namespace

double approach_speed(const DamperParams& params, double d) noexcept {
  return params.gain * (d - params.stop) / (params.influence - params.stop);
}

CollisionRows::CollisionRows(const RobotModel& model, const CollisionParams& params, const Deceleration& deceleration,
                             const Uncertainty& uncertainty)
    : model_(&model),
      params_(params),
      part_(model.shapes.size(), kArm),
      J_(3, model.num_velocities()),
      row_(model.num_velocities()),
      deceleration_(deceleration),
      uncertainty_(uncertainty) {
  resting_.fill(params.object);
  for (std::size_t i = 0; i < part_.size(); ++i)
    if (model.shapes[i].rigid_with_base) part_[i] = kBase;
  for (const int shape : model.hand_shapes()) part_[static_cast<std::size_t>(shape)] = kHand;
}

int CollisionRows::allocate(int num_objects) {
  const std::size_t shapes = model_->shapes.size();
  const ProximityRanges on = ranges();
  const std::size_t pairs = (on.object >= 0 ? shapes * static_cast<std::size_t>(num_objects) : 0) +
                            (on.floor >= 0 ? shapes : 0) + (on.self >= 0 ? model_->self_pairs.size() : 0);
  keys_.reserve(pairs);
  sorted_.reserve(pairs);
  keys_.clear();
  sorted_.clear();
  left_out_ = 0;
  return static_cast<int>(std::min(pairs, static_cast<std::size_t>(params_.max_pairs)));
}

ProximityRanges CollisionRows::ranges() const noexcept {
  const auto range = [&](const DamperParams& p) {
    return params_.object.enabled && p.enabled && params_.max_pairs > 0 ? p.influence : -1.0;
  };
  return {.object = range(params_.object),
          .floor = range(params_.floor),
          .self = range(params_.self),
          .unseen = unseen_.influence,
          .raised = kRaised};
}

void CollisionRows::keep_from_resting(const RestingStops& stops, double rate) noexcept {
  const DamperParams& object = params_.object;
  const auto set = [&](Part part, double stop) {
    DamperParams& damper = resting_[part];
    damper.stop = std::min(object.stop, stop);
    damper.influence = rate > 0.0 ? std::min(object.influence, damper.stop + object.gain / rate) : object.influence;
  };
  set(kHand, stops.hand);
  set(kArm, stops.arm);
  set(kBase, stops.base);
}

const DamperParams& CollisionRows::damper(PairKind kind) const noexcept {
  return kind == PairKind::kFloor ? params_.floor : kind == PairKind::kSelf ? params_.self : params_.object;
}

const DamperParams& CollisionRows::damper(const ProximityPair& pair,
                                          std::span<const ObjectState> states) const noexcept {
  const bool unseen = pair.kind == PairKind::kObject && !states[static_cast<std::size_t>(pair.second)].seen;
  return unseen ? unseen_ : damper(pair.kind);
}

void CollisionRows::select(std::span<const ProximityPair> pairs, std::span<const ObjectState> states) noexcept {
  keys_.clear();
  sorted_.clear();
  left_out_ = 0;
  for (std::size_t i = 0; i < pairs.size() && keys_.size() < keys_.capacity(); ++i) {
    const DamperParams& p = damper(pairs[i], states);
    const double d = pairs[i].distance.d;
    if (d >= p.influence) continue;
    // A distance that is not a number must not be lost: it comes first, and the solver refuses its row.
    keys_.emplace_back(std::isnan(d) ? -kInfinity : d - p.stop, i);
  }
  std::ranges::sort(keys_);
  for (const auto& [order, i] : keys_) sorted_.push_back(pairs[i]);
}

void CollisionRows::add(const Kinematics& kinematics, std::span<const ObjectState> states,
                        std::span<const PlaceSpread> spreads, QpProblem& problem) noexcept {
  const std::size_t kept = std::min(sorted_.size(), static_cast<std::size_t>(params_.max_pairs));
  for (const PairKind kind : {PairKind::kObject, PairKind::kFloor, PairKind::kSelf}) {
    for (std::size_t i = 0; i < kept; ++i) {
      if (sorted_[i].kind == kind && !fill(kinematics, sorted_[i], states, spreads, problem)) ++left_out_;
    }
  }
}

bool CollisionRows::fill(const Kinematics& kinematics, const ProximityPair& pair, std::span<const ObjectState> states,
                         std::span<const PlaceSpread> spreads, QpProblem& problem) noexcept {
  const Distance& distance = pair.distance;
  approach_row(pair, kinematics, J_, row_);
  const ObjectState* object = pair.kind == PairKind::kObject ? &states[static_cast<std::size_t>(pair.second)] : nullptr;
  const bool unseen = object != nullptr && !object->seen;
  const bool moves = object != nullptr && in_motion(*object);
  const bool rests = object != nullptr && !moves;
  double d = distance.d;
  if (uncertainty_.on() && !unseen) d -= uncertainty_.margin(pair, kinematics, row_, states, spreads);
  if (moves) d -= params_.moving_room;
  const DamperParams& row_damper = unseen  ? unseen_
                                   : rests ? resting_[part_[static_cast<std::size_t>(pair.first)]]
                                           : damper(pair.kind);
  double limit = approach_speed(row_damper, d);
  const double room = d - row_damper.stop;
  if (params_.braking.enabled && room > 0.0) {
    const double a = params_.braking.share * deceleration_.along(row_);
    double most = stoppable_speed(room, a, params_.braking.reaction);
    // A path past a corner comes near it faster than the robot could stop in front of it.
    const bool still = !moves && !unseen;
    if (path_velocities_ != nullptr && still) most = std::max(most, row_.dot(*path_velocities_));
    limit = std::min(limit, most);
  }
  if (object != nullptr) {
    limit -= distance.n_W.dot(velocity_at(*object, distance.p_second_W));
  }
  // A NaN keeps the row, so that the solver's input check reports it.
  if (row_.cwiseAbs().maxCoeff() < kNoEffect) return false;
  const RowKind kind = pair.kind == PairKind::kFloor  ? RowKind::kFloor
                       : pair.kind == PairKind::kSelf ? RowKind::kSelf
                                                      : RowKind::kObject;
  return problem.append({kind, pair.first, pair.second, moves, distance.d, distance.p_first_W, distance.p_second_W},
                        -kInfinity, limit, row_);
}

}  // namespace moma
