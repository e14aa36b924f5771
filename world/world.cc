#include "world/world.h"

#include <algorithm>
#include <cstddef>

#include "controller/step.h"

namespace moma {

void set_pose(WorldObject& object, const Vector3& position, const Eigen::Quaterniond& rotation) {
  object.X_WO = pose_of(rotation.normalized().toRotationMatrix(), position);
  object.file_rotation = rotation;
}

void set_pose(WorldGoal& goal, const Vector3& position, const Eigen::Quaterniond& rotation) {
  goal.X_WG = pose_of(rotation.normalized().toRotationMatrix(), position);
  goal.file_rotation = rotation;
}

std::vector<ObjectShape> object_shapes(const World& world) {
  std::vector<ObjectShape> shapes;
  shapes.reserve(world.objects.size());
  for (const WorldObject& object : world.objects) shapes.push_back({object.name, object.shape});
  return shapes;
}

MovingPose place(const WorldObject& object, const Pace& pace, double t) {
  MovingPose out = evaluate(object.motion, object.X_WO, pace.time(t));
  out.V_W *= pace.rate;
  return out;
}

void object_states(const World& world, double t, std::vector<ObjectState>& states, std::span<const Pace> paces) {
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const MovingPose pose = place(world.objects[i], paces.empty() ? Pace{} : paces[i], t);
    states[i].X_WO = pose.X;
    states[i].V_WO_W = pose.V_W;
  }
}

bool carries(const World& world) {
  return world.held || !world.goal.take.empty() ||
         std::ranges::any_of(world.further, [](const WorldGoal& goal) { return !goal.take.empty(); });
}

int find_object(const World& world, std::string_view name) {
  for (std::size_t i = 0; i < world.objects.size(); ++i)
    if (world.objects[i].name == name) return static_cast<int>(i);
  return -1;
}

GoalState goal_state(const World& world, double t, std::size_t index) {
  const WorldGoal& goal = goal_of(world, index);
  const MovingPose pose = evaluate(goal.motion, goal.X_WG, t);
  return {pose.X, pose.V_W, goal.stop, goal.free};
}

}  // namespace moma
