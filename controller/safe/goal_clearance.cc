#include "controller/safe/goal_clearance.h"

#include <optional>

namespace moma {

std::vector<char> of_hand(const RobotModel& model) {
  std::vector<char> of_hand(model.shapes.size(), 0);
  for (const int shape : model.hand_shapes()) of_hand[static_cast<std::size_t>(shape)] = 1;
  return of_hand;
}

GoalClearance::GoalClearance(const RobotModel& model) : shapes_(model.hand_shapes()) {}

double GoalClearance::least(const Kinematics& kinematics, const Isometry& X_WG, std::span<const ObjectState> objects,
                            double range, Proximity& proximity) noexcept {
  if (objects.size() != states_.size() || !is_pose(X_WG) || !proximity.place(kinematics)) return range;
  const Isometry move = kinematics.X_WE() * X_WG.inverse();
  double least = range;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    if (!objects[k].visible || !objects[k].seen || in_motion(objects[k]) || !is_pose(objects[k].X_WO)) continue;
    states_[k].X_WO = move * objects[k].X_WO;
    states_[k].box = objects[k].box;
    for (const int shape : shapes_) {
      const std::optional<Distance> distance =
          proximity.within(PairKind::kObject, shape, static_cast<int>(k), states_, least);
      if (distance) least = std::min(least, distance->d);
    }
  }
  return least;
}

}  // namespace moma
