#include <stdexcept>
#include <string>
#include <utility>

#include "controller/case/case_file.h"
#include "controller/case/plan_case.h"
#include "controller/config/controller_file.h"
#include "controller/config/write_described.h"

namespace moma {
namespace {

using Json = nlohmann::ordered_json;

template <class Vector>
Json numbers(const Vector& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(value);
  return out;
}

Json goal_json(const GoalState& goal) {
  return {{"position", numbers(goal.X_WG.translation())},
          {"rotation", numbers(Matrix3(goal.X_WG.linear()).reshaped())},
          {"twist", numbers(goal.V_WG_W)}};
}

Json object_json(const ObjectShape& object, const ObjectState& state) {
  const int sizes = num_sizes(object.shape.kind);
  if (object.shape.kind == ShapeKind::kConvex)
    throw std::invalid_argument("object " + object.name + " is a mesh: a case file has no word for it");
  Json json = {{"name", object.name},
               {"shape", std::string(to_string(object.shape.kind))},
               {"size", numbers(object.shape.size.head(sizes))},
               {"position", numbers(state.X_WO.translation())},
               {"rotation", numbers(Matrix3(state.X_WO.linear()).reshaped())},
               {"velocity", numbers(state.V_WO_W)}};
  if (!state.visible) json["visible"] = false;
  if (state.covariance)
    json["covariance"] = {{"position", numbers(state.covariance->position_W.reshaped())},
                          {"velocity", numbers(state.covariance->velocity_W.reshaped())}};
  return json;
}

}  // namespace

nlohmann::ordered_json case_to_json(const ControlCase& c) {
  Json state = {
      {"base", numbers(c.observation.base)}, {"q", numbers(c.observation.q)}, {"qdot", numbers(c.observation.qdot)}};
  state["escape"] = config::write_described(c.memory.escape.state);
  if (c.memory.escape.has_goal) state["last_goal"] = goal_json(c.memory.escape.last_goal);
  if (!c.memory.prediction.computed.empty()) state["prediction"] = config::write_described(c.memory.prediction);
  if (c.has_plan) state["plan"] = to_json(c.memory.plan);
  Json objects = Json::array();
  for (std::size_t i = 0; i < c.objects.size(); ++i)
    objects.push_back(object_json(c.objects[i], c.observation.objects[i]));
  return {
      {"robot", c.robot.resolved}, {"controller", config::to_json(c.controller)}, {"control_period", c.control_period},
      {"state", std::move(state)}, {"goal", goal_json(c.observation.goal)},       {"objects", std::move(objects)}};
}

}  // namespace moma
