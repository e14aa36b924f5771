#include "eval/trial/clearance.h"

#include <algorithm>
#include <cmath>

namespace moma {
namespace {

constexpr double kAnything = 1e6;  // [m]

std::vector<SolidPair> measured_pairs(const RobotModel& model, std::size_t objects) {
  std::vector<SolidPair> pairs = solid_pairs(model, objects, {});
  std::erase_if(pairs, [](const SolidPair& pair) { return pair.kind == PairKind::kSelf; });
  for (const SelfPair& pair : model.self_pairs)
    if (pair.row) pairs.push_back({PairKind::kSelf, pair.first, pair.second});
  return pairs;
}

}  // namespace

ClearanceWatch::ClearanceWatch(const std::shared_ptr<const RobotModel>& model, const World& world)
    : gaps_(*model, world),
      watch_(model, measured_pairs(*model, world.objects.size()), world.objects.size()),
      travel_(watch_.rest()) {}

void ClearanceWatch::look(const Kinematics& kinematics, std::span<const ObjectState> objects, bool objects_move) {
  if (looked_) {
    watch_.between(base_, q_, kinematics.base(), kinematics.q(), travel_);
    for (std::size_t k = 0; k < X_WO_.size(); ++k)
      travel_.objects[static_cast<Eigen::Index>(k)] = moved(X_WO_[k], objects[k].X_WO, gaps_.object_radius(k));
    watch_.begin(travel_);
    watch_.end();
  }
  looked_ = true;
  base_ = kinematics.base();
  q_ = kinematics.q();
  X_WO_.clear();
  if (objects_move)
    for (const ObjectState& object : objects) X_WO_.push_back(object.X_WO);

  const auto range = [](double least) { return std::isnan(least) ? kAnything : std::max(least, 0.0); };
  const ProximityRanges ranges{range(to_objects_), 0.0, range(to_itself_)};
  watch_.within(ranges, [&](const SolidPair& pair) {
    const bool self = pair.kind == PairKind::kSelf;
    const PairGaps::Gap gap = gaps_.gap(pair, kinematics, objects, self ? ranges.self : ranges.object);
    double& least = self ? to_itself_ : to_objects_;
    if (gap.in_range && !(least <= gap.least)) least = gap.least;
    return gap.least;
  });
}

}  // namespace moma
