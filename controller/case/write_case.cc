#include <utility>

#include "controller/case/case_file.h"
#include "controller/case/plan_case.h"
#include "controller/case/sensed.h"
#include "controller/config/controller_file.h"
#include "controller/config/object_file.h"
#include "controller/config/write_described.h"

namespace moma {

using Json = nlohmann::ordered_json;

nlohmann::ordered_json case_to_json(const ControlCase& c) {
  Json state = sensed_to_json(c.observation);
  state["escape"] = config::write_described(c.memory.escape.state);
  if (c.memory.escape.has_goal) state["last_goal"] = sensed_to_json(c.memory.escape.last_goal);
  if (!c.memory.prediction.computed.empty()) state["prediction"] = config::write_described(c.memory.prediction);
  if (c.has_plan) state["plan"] = to_json(c.memory.plan);
  Json objects = Json::array();
  for (std::size_t i = 0; i < c.objects.size(); ++i) {
    Json object = {{"name", c.objects[i].name}};
    config::write_shape(c.objects[i].shape, object);
    object.update(sensed_to_json(c.observation.objects[i]));
    objects.push_back(std::move(object));
  }
  return {
      {"robot", c.robot.resolved}, {"controller", config::to_json(c.controller)}, {"control_period", c.control_period},
      {"state", std::move(state)}, {"goal", sensed_to_json(c.observation.goal)},  {"objects", std::move(objects)}};
}

}  // namespace moma
