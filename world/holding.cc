#include "world/holding.h"

#include <fmt/format.h>

#include <stdexcept>
#include <vector>

namespace moma {
namespace {

/// Returns the shapes of links that a held object may touch; pairs with shapes of the hand do not exist.
Vector6 touchable(const Held& held, const RobotModel& model) {
  Vector6 touch = Carried().touch;
  Eigen::Index count = 0;
  const int hand = model.rigid_root(model.tip);
  for (const std::string& name : held.touch) {
    const int link = model.find_link(name);
    if (link < 0) throw std::runtime_error(fmt::format("held.touch: robot {} has no link '{}'", model.name, name));
    if (model.rigid_root(link) == hand) continue;
    for (std::size_t i = 0; i < model.shapes.size(); ++i) {
      if (model.shapes[i].link != link) continue;
      if (count == touch.size())
        throw std::runtime_error(
            fmt::format("held.touch: expected links with {} collision shapes at most, beside those "
                        "that are rigid with the hand",
                        touch.size()));
      touch[count++] = static_cast<double>(i);
    }
  }
  return touch;
}

}  // namespace

double gap_between(const World& world, std::span<const ObjectState> states, int object, int support) {
  const auto at = static_cast<std::size_t>(object), k = static_cast<std::size_t>(support);
  const Shape& shape = world.objects[at].shape;
  if (support == kFloorSupport) return lowest_point(shape, states[at].X_WO);
  return shape_distance(shape, states[at].X_WO, world.objects[k].shape, states[k].X_WO).d;
}

int support_of(const World& world, std::span<const ObjectState> states, int object) {
  int support = kNoSupport;
  double least = kStands;
  const auto take = [&](int other) {
    const double d = gap_between(world, states, object, other);
    if (d >= least || d <= -kPressed) return;
    least = d;
    support = other;
  };
  take(kFloorSupport);
  for (int i = 0; i < static_cast<int>(world.objects.size()); ++i)
    if (i != object) take(i);
  return support;
}

std::optional<Carried> held_at_start(const World& world, const Kinematics& at_start) {
  if (!world.held) return {};
  std::vector<ObjectState> states(world.objects.size());
  object_states(world, 0.0, states);
  const int object = find_object(world, world.held->object);
  return Carried{object, at_start.X_WE().inverse() * states[static_cast<std::size_t>(object)].X_WO,
                 support_of(world, states, object), touchable(*world.held, at_start.model())};
}

std::shared_ptr<const RobotModel> robot_at_start(const std::shared_ptr<const RobotModel>& model, const World& world) {
  if (!world.held) return model;
  Kinematics kinematics(model);
  kinematics.update(world.start.base, world.start.q);
  const auto carried = held_at_start(world, kinematics);
  auto out = with_spare_shape(*model);
  carry(*out, carried, &world.objects[static_cast<std::size_t>(carried->object)].shape);
  return out;
}

void start_from(World& world, const Configuration& start, const std::shared_ptr<const RobotModel>& model) {
  Kinematics kinematics(model);
  kinematics.update(world.start.base, world.start.q);
  const auto carried = held_at_start(world, kinematics);
  world.start = start;
  if (!carried) return;
  kinematics.update(start.base, start.q);
  set_pose(world.objects[static_cast<std::size_t>(carried->object)], kinematics.X_WE() * carried->X_EO);
}

}  // namespace moma
