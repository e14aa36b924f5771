#include "controller/qp/separation.h"

#include <algorithm>
#include <cmath>

namespace moma {

double separation_speed(double room, double v_H, double deceleration, double reaction) noexcept {
  const double left = room - v_H * reaction;
  if (!(left > 0.0) || !(deceleration > 0.0)) return 0.0;
  if (std::isinf(deceleration)) return reaction > 0.0 ? left / reaction : kInfinity;
  // V^2/2 + v (a T_R + v_H) = a left; this form of the root avoids the difference of nearly equal numbers.
  const double b = deceleration * reaction + v_H;
  return 2.0 * deceleration * left / (b + std::sqrt(b * b + 2.0 * deceleration * left));
}

SeparationRows::SeparationRows(const RobotModel& model, const CollisionParams& params, const Deceleration& deceleration,
                               const Uncertainty& uncertainty)
    : model_(&model),
      params_(params.separation),
      on_(params.object.enabled && params.separation.enabled),
      max_rows_(static_cast<std::size_t>(params.max_pairs)),
      deceleration_(deceleration),
      uncertainty_(uncertainty),
      most_(model.velocity_limits()),
      J_(3, model.num_velocities()),
      row_(model.num_velocities()) {}

int SeparationRows::allocate(int num_objects) {
  if (!on_) return 0;
  const std::size_t pairs = model_->shapes.size() * static_cast<std::size_t>(num_objects);
  moving_.assign(static_cast<std::size_t>(num_objects), ObjectState{});
  chosen_.clear();
  chosen_.reserve(pairs);
  return static_cast<int>(std::min(pairs, max_rows_));
}

// Writes row_, and returns the remaining speed.
double SeparationRows::fill(const Kinematics& kinematics, const ProximityPair& pair,
                            std::span<const PlaceSpread> spreads) noexcept {
  const Distance& distance = pair.distance;
  const ObjectState& object = moving_[static_cast<std::size_t>(pair.second)];
  approach_row(pair, kinematics, J_, row_);
  const double v_H = std::max(params_.speed, distance.n_W.dot(velocity_at(object, distance.p_second_W)));
  double room = distance.d - params_.intrusion;
  if (uncertainty_.on()) room -= uncertainty_.margin(pair, kinematics, row_, moving_, spreads);
  return separation_speed(room, v_H, params_.share * deceleration_.along(row_), params_.reaction);
}

void SeparationRows::add(const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> states,
                         std::span<const PlaceSpread> spreads, QpProblem& problem) noexcept {
  if (!on_) return;
  bool any = false;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    moving_[i] = states[i];
    moving_[i].visible = states[i].visible && in_motion(states[i]);
    any = any || moving_[i].visible;
  }
  if (!any) return;
  const std::span<const ProximityPair> pairs = proximity.query(kinematics, moving_, {params_.range, -1.0, -1.0});
  chosen_.clear();
  for (std::size_t i = 0; i < pairs.size() && chosen_.size() < chosen_.capacity(); ++i) {
    const double speed = fill(kinematics, pairs[i], spreads);
    if (!(row_.cwiseAbs().maxCoeff() < kNoEffect) && !(row_.cwiseAbs().dot(most_) <= speed))
      chosen_.emplace_back(speed, i);
  }
  std::ranges::sort(chosen_);
  const std::size_t kept = std::min(chosen_.size(), max_rows_);
  for (std::size_t k = 0; k < kept; ++k) {
    const ProximityPair& pair = pairs[chosen_[k].second];
    const double speed = fill(kinematics, pair, spreads);
    problem.append({RowKind::kSeparation, pair.first, pair.second, true, pair.distance.d, pair.distance.p_first_W,
                    pair.distance.p_second_W},
                   -kInfinity, speed, row_);
  }
}

}  // namespace moma
