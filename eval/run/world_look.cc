#include "eval/run/world_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "controller/ahead/rollout.h"
#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"

namespace moma::run {
namespace {

constexpr double kFar = 0.5;  // gaps beyond are of no interest [m]

std::string pair_text(const World& world, const RobotModel& model, const ProximityPair& pair) {
  const std::string second = pair.kind == PairKind::kObject  ? world.objects[static_cast<std::size_t>(pair.second)].name
                             : pair.kind == PairKind::kFloor ? "the floor"
                                                             : model.shapes[static_cast<std::size_t>(pair.second)].name;
  return fmt::format("world {}, {} and {}", world.index, model.shapes[static_cast<std::size_t>(pair.first)].name,
                     second);
}

/// The link nearest to the root that no controlled joint separates from `link`.
int rigid_root(const RobotModel& model, int link) {
  const auto at = [&](int i) -> const Link& { return model.links[static_cast<std::size_t>(i)]; };
  while (at(link).controlled < 0 && at(link).parent >= 0) link = at(link).parent;
  return link;
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

/// Whether rows of a controller of moma's keep it from objects.
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

  // Objects are moved instead of the robot, so that E is at the goal: its arm does not matter.
  const Isometry move = kinematics.X_WE() * goal_state(world, 0.0).X_WG.inverse();
  for (ObjectState& state : states) state.X_WO = move * state.X_WO;
  const int hand = rigid_root(*model, model->tip);
  ProximityPair nearest;
  nearest.distance.d = kFar;
  (void)proximity.place(kinematics);
  for (std::size_t i = 0; i < model->shapes.size(); ++i) {
    if (rigid_root(*model, model->shapes[i].link) != hand) continue;
    for (std::size_t k = 0; k < states.size(); ++k) {
      if (in_motion(states[k])) continue;
      const auto distance =
          proximity.within(PairKind::kObject, static_cast<int>(i), static_cast<int>(k), states, nearest.distance.d);
      if (distance) nearest = {PairKind::kObject, static_cast<int>(i), static_cast<int>(k), *distance};
    }
  }
  const bool near = nearest.distance.d < kFar;
  look.goals.push_back({near ? nearest.distance.d : kInfinity, near ? pair_text(world, *model, nearest) : ""});
}

std::vector<std::string> touching_goals(const WorldLook& look) {
  const Within within(look, -kInfinity, 0.0);
  if (within.count == 0) return {};
  return {
      fmt::format("at the goal of {} of {} worlds the tool is in touch with an object: no configuration reaches it "
                  "(deepest: {:.1f} mm in {})",
                  within.count, look.goals.size(), -1e3 * within.nearest->d, within.nearest->where)};
}

std::vector<std::string> goal_warnings(const std::vector<const SuitePoint*>& points, const WorldLook& look) {
  std::vector<std::string> out;
  std::set<std::pair<std::string, double>> seen;
  for (const SuitePoint* point : points) {
    if (!keeps(*point)) continue;
    const double stop = point->controller_params.collision.object.stop;
    const Within within(look, 0.0, stop);
    if (within.count == 0 || !seen.emplace(point->controller, stop).second) continue;
    out.push_back(fmt::format(
        "controller {}: at the goal of {} of {} worlds the tool is nearer to an object than collision.stop, {:.1f} mm, "
        "which its rows keep (nearest: {:.1f} mm in {})",
        point->controller, within.count, look.goals.size(), 1e3 * stop, 1e3 * within.nearest->d,
        within.nearest->where));
  }
  return out;
}

std::vector<std::string> arrival_warnings(const std::vector<SuitePoint>& points) {
  struct Finer {
    std::size_t finer = 0, all = 0;
    std::string what;  // of the first
  };
  std::map<std::string, Finer> controllers;
  for (const SuitePoint& point : points) {
    const ControllerParams& params = point.controller_params;
    Finer& now = controllers[point.controller];
    ++now.all;
    if (point.plugin != nullptr || params.method != Method::kQp || !params.plan.enabled) continue;
    const RolloutLimits arrived = prediction_limits(params.plan, params.escape, params.plan.horizon);
    const bool position = point.success.position < arrived.position;
    if (!position && !(point.success.orientation < arrived.orientation)) continue;
    if (now.finer++ > 0) continue;
    now.what = position ? fmt::format(
                              "success.position, {:.4g} mm, is finer than the {:.4g} mm at which its look-ahead "
                              "takes the goal for reached: give it an escape.position of {:.4g} mm or less",
                              1e3 * point.success.position, 1e3 * arrived.position,
                              1e3 * params.escape.position * point.success.position / arrived.position)
                        : fmt::format(
                              "success.orientation, {:.4g} rad, is finer than the {:.4g} rad at which its "
                              "look-ahead takes the goal for reached: give it an escape.orientation of {:.4g} "
                              "rad or less",
                              point.success.orientation, arrived.orientation,
                              params.escape.orientation * point.success.orientation / arrived.orientation);
  }
  std::vector<std::string> out;
  for (const auto& [name, now] : controllers)
    if (now.finer > 0)
      out.push_back(fmt::format("controller {}: in {} of {} point{} {}", name, now.finer, now.all,
                                now.all == 1 ? "" : "s", now.what));
  return out;
}

}  // namespace moma::run
