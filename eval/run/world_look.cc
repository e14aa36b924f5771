#include "eval/run/world_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/safe/goal_clearance.h"

namespace moma::run {
namespace {

constexpr double kFar = 0.5;  // larger gaps do not matter [m]

std::string pair_text(const World& world, const RobotModel& model, const ProximityPair& pair) {
  const std::string second = pair.kind == PairKind::kObject  ? world.objects[static_cast<std::size_t>(pair.second)].name
                             : pair.kind == PairKind::kFloor ? "the floor"
                                                             : model.shapes[static_cast<std::size_t>(pair.second)].name;
  return fmt::format("world {}, {} and {}", world.index, model.shapes[static_cast<std::size_t>(pair.first)].name,
                     second);
}

/// The goals whose gaps are in [low, high).
struct Within {
  Within(const WorldLook& look, double low, double high) {
    for (const WorldLook::Gap& gap : look.goals) {
      if (gap.d < low || !(gap.d < high)) continue;
      ++count;
      if (nearest == nullptr || gap.d < nearest->d) nearest = &gap;
    }
  }
  std::size_t count = 0;
  const WorldLook::Gap* nearest = nullptr;
};

/// True if rows of one of moma's controllers keep a distance from objects.
bool keeps(const SuitePoint& point) {
  return point.plugin == nullptr && point.controller_params.method == Method::kQp &&
         point.controller_params.collision.object.enabled;
}

}  // namespace

void look_at(const World& world, const std::shared_ptr<const RobotModel>& model, WorldLook& look) {
  Kinematics kinematics(model);
  Proximity proximity(model);
  proximity.set_objects(object_shapes(world));
  std::vector<ObjectState> states(world.objects.size());
  object_states(world, 0.0, states);

  kinematics.update(world.start.base, world.start.q);
  const auto touching = proximity.query(kinematics, states, {0.0, 0.0, 0.0});
  if (!touching.empty() && look.in_touch++ == 0) look.first_touch = pair_text(world, *model, touching.front());

  // Moves the objects instead of the robot to put E at the goal, whatever the arm's configuration.
  const Isometry move = kinematics.X_WE() * goal_state(world, 0.0).X_WG.inverse();
  for (ObjectState& state : states) state.X_WO = move * state.X_WO;
  ProximityPair nearest;
  nearest.distance.d = kFar;
  (void)proximity.place(kinematics);
  for (const int shape : hand_shapes(*model)) {
    for (std::size_t k = 0; k < states.size(); ++k) {
      if (in_motion(states[k])) continue;
      const auto distance = proximity.within(PairKind::kObject, shape, static_cast<int>(k), states, nearest.distance.d);
      if (distance) nearest = {PairKind::kObject, shape, static_cast<int>(k), *distance};
    }
  }
  const bool near = nearest.distance.d < kFar;
  look.goals.push_back({near ? nearest.distance.d : kInfinity, near ? pair_text(world, *model, nearest) : ""});
}

std::vector<std::string> touching_goals(const WorldLook& look) {
  const Within within(look, -kInfinity, 0.0);
  if (within.count == 0) return {};
  return {
      fmt::format("at the goal of {} of {} worlds the tool touches an object: no configuration reaches it (deepest: "
                  "{:.1f} mm in {})",
                  within.count, look.goals.size(), -1e3 * within.nearest->d, within.nearest->where)};
}

std::vector<std::string> goal_warnings(const std::vector<const SuitePoint*>& points, const WorldLook& look) {
  std::vector<std::string> out;
  std::set<std::pair<std::string, double>> seen;
  for (const SuitePoint* point : points) {
    if (!keeps(*point)) continue;
    const CollisionParams& collision = point->controller_params.collision;
    const double stop = collision.at_goal.enabled ? collision.at_goal.least : collision.object.stop;
    const Within within(look, 0.0, stop);
    if (within.count == 0 || !seen.emplace(point->controller, stop).second) continue;
    out.push_back(fmt::format(
        "controller {}: at the goal of {} of {} worlds the tool is nearer to an object than the {:.1f} mm that "
        "its rows keep there (nearest: {:.1f} mm in {})",
        point->controller, within.count, look.goals.size(), 1e3 * stop, 1e3 * within.nearest->d,
        within.nearest->where));
  }
  return out;
}

}  // namespace moma::run
