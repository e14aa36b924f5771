#include "controller/model/floor_reach.h"

#include <cmath>
#include <cstddef>
#include <memory>

#include "controller/model/kinematics.h"

namespace moma {
namespace {

// Vertical components of axes beyond which a rounded rpy of a URDF counts as exact.
constexpr double kUpright = 1.0 - 1e-6, kLevel = 1e-3;

bool lifts(const Link& link, const Isometry& X_WL) {
  if (link.controlled < 0) return false;
  const double along = std::abs((X_WL.linear() * link.axis).z());
  return link.joint_type == JointType::kPrismatic ? along > kLevel : along < kUpright;
}

}  // namespace

FloorReach floor_reach(const RobotModel& model) {
  const Kinematics at_ready(std::make_shared<const RobotModel>(model));  // any configuration would do
  std::vector<bool> lifted(model.links.size(), false);
  for (std::size_t i = 1; i < model.links.size(); ++i) {  // parents first
    const Link& link = model.links[i];
    // As long as nothing lifts a link, the vertical components of its axes are constant.
    lifted[i] = lifted[static_cast<std::size_t>(link.parent)] || lifts(link, at_ready.X_WL(static_cast<int>(i)));
  }
  FloorReach reach;
  for (const CollisionShape& shape : model.shapes) {
    const bool up = lifted[static_cast<std::size_t>(shape.link)];
    reach.lifted.push_back(up);
    reach.stands.push_back(shape.rigid_with_base ||
                           (!up && lowest_point(shape.shape, at_ready.X_WS(shape)) < kStanding));
  }
  return reach;
}

}  // namespace moma
