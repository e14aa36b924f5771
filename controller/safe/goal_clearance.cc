#include "controller/safe/goal_clearance.h"

#include <algorithm>
#include <optional>

namespace moma {
namespace {

// Returns the link nearest to the root that no controlled joint separates from `link`.
int rigid_root(const RobotModel& model, int link) noexcept {
  while (model.links[static_cast<std::size_t>(link)].controlled < 0 &&
         model.links[static_cast<std::size_t>(link)].parent >= 0)
    link = model.links[static_cast<std::size_t>(link)].parent;
  return link;
}

}  // namespace

std::vector<int> hand_shapes(const RobotModel& model) {
  std::vector<int> shapes;
  const int hand = rigid_root(model, model.tip);
  for (std::size_t i = 0; i < model.shapes.size(); ++i)
    if (rigid_root(model, model.shapes[i].link) == hand) shapes.push_back(static_cast<int>(i));
  return shapes;
}

GoalClearance::GoalClearance(const RobotModel& model) : shapes_(hand_shapes(model)) {}

double GoalClearance::least(const Kinematics& kinematics, const Isometry& X_WG, std::span<const ObjectState> objects,
                            double range, Proximity& proximity) noexcept {
  if (objects.size() != states_.size() || !is_pose(X_WG) || !proximity.place(kinematics)) return range;
  const Isometry move = kinematics.X_WE() * X_WG.inverse();
  double least = range;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    if (!objects[k].visible || in_motion(objects[k]) || !is_pose(objects[k].X_WO)) continue;
    states_[k].X_WO = move * objects[k].X_WO;
    for (const int shape : shapes_) {
      const std::optional<Distance> distance =
          proximity.within(PairKind::kObject, shape, static_cast<int>(k), states_, least);
      if (distance) least = std::min(least, distance->d);
    }
  }
  return least;
}

}  // namespace moma
