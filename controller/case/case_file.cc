#include "controller/case/case_file.h"

#include <set>
#include <utility>

#include "controller/case/plan_case.h"
#include "controller/case/sensed.h"
#include "controller/config/controller_file.h"
#include "controller/config/object_file.h"
#include "controller/config/read_described.h"
#include "controller/config/write_described.h"
#include "controller/safe/predictor.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;

void read_objects(const Node& node, ControlCase& out) {
  std::set<std::string> names;
  config::for_items(node, "objects", "a list of objects", [&](const Node& item, const std::string& key) {
    const int index = static_cast<int>(out.objects.size());
    ObjectShape& shape = out.objects.emplace_back();
    read_object(item, key, index, *out.robot.model, shape, out.observation.objects.emplace_back());
    if (!names.insert(shape.name).second)
      config::fail(item.mark, key + ".name", "'" + shape.name + "' is the name of an earlier object");
  });
}

template <class T>
void read_map(const Node& node, const std::string& key, const RobotModel& model, T& value) {
  MapReader in(node, key);
  read_sensed(in, model, value);
  in.finish();
}

void read_remembered(MapReader& in, const RobotModel& model, ControllerMemory& memory) {
  if (const Node* escape = in.get("escape")) config::read_described(*escape, in.key_of("escape"), memory.escape.state);
  if (const Node* goal = in.get("last_goal")) {
    read_map(*goal, in.key_of("last_goal"), model, memory.escape.last_goal);
    memory.escape.has_goal = true;
  }
  if (const Node* prediction = in.get("prediction"))
    config::read_described(*prediction, in.key_of("prediction"), memory.prediction);
}

// Rejects a memory whose sizes differ from the controller's: its numbers have no meaning.
void check_prediction(const ControlCase& c, const Node& state) {
  if (c.memory.prediction.computed.empty()) return;
  const Node* node = state.find("prediction");
  const auto wrong = [&](const std::string& what) { config::fail(node->mark, "state.prediction", what); };
  if (!c.controller.prediction.enabled) wrong("the controller has no `prediction`");
  const std::string mismatch =
      prediction_mismatch(c.memory.prediction, *c.robot.model, c.controller, c.control_period, c.objects.size());
  if (!mismatch.empty()) wrong(mismatch);
}

// Boxes are those that a map with the controller's parameters can have.
void read_boxes(const Node& node, const std::string& key, const MapParams& params, std::vector<MapBox>& boxes) {
  if (!params.enabled) config::fail(node.mark, key, "the controller has no map: its `map` is off");
  config::description::read_any(node, key, boxes, {}, {});
  const int count = params.num_objects();
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].object >= count)
      config::fail(node.items[i].mark, key + "[" + std::to_string(i) + "].object",
                   "found " + std::to_string(boxes[i].object) + ", but the controller's map has " +
                       std::to_string(count) + " objects");
}

void read_state(const Node& node, const RobotModel& model, ControlCase& c) {
  MapReader in(node, "state");
  if (const Node* remembered = in.get("plan")) {
    in.check(c.controller.plan.enabled, "plan", "the controller does not look ahead: its `plan` is off");
    c.memory.plan = read_plan_state(*remembered, in.key_of("plan"), model);
    c.has_plan = true;
  }
  read_remembered(in, model, c.memory);
  if (const Node* boxes = in.get("map")) read_boxes(*boxes, in.key_of("map"), c.controller.map, c.memory.map);
  // A fixed base may have a pose too.
  if (model.mobile()) in.require("base", "[x, y, phi] of the base in metres and radians");
  read_sensed(in, model, c.observation);
  in.finish();
}

}  // namespace

void read_object(const Node& node, const std::string& key, int index, const RobotModel& model, ObjectShape& shape,
                 ObjectState& state) {
  MapReader in(node, key);
  shape.name = "object" + std::to_string(index);
  in.read("name", shape.name);
  in.check(!shape.name.empty(), "name", "expected a name that is not empty");
  shape.shape = config::read_shape(in);
  read_sensed(in, model, state);
  if (const Node* twist = in.get("velocity")) {  // as worlds and earlier cases call it
    in.check(in.get("twist") == nullptr, "velocity", "is the same as `twist`: give one of them");
    config::description::read_any(*twist, in.key_of("velocity"), state.V_WO_W, {}, {});
  }
  in.finish();
}

ControlCase read_case(const Node& root) {
  ControlCase out;
  MapReader in(root, "");
  out.robot = config::read_robot(in.require("robot", "the path of a robot file"), "robot");
  const RobotModel& model = *out.robot.model;
  out.warnings = out.robot.warnings;
  in.read("control_period", out.control_period, Range::positive());
  const Node& controller = in.require("controller", "the path of a controller file, or its parameters");
  out.controller = config::read_controller(controller, "controller", model, out.control_period, out.warnings);
  read_state(in.require("state", "{base, q, qdot}"), model, out);
  read_map(in.require("goal", "{position, quaternion, twist}"), "goal", model, out.observation.goal);
  if (const Node* next = in.get("next_goal")) read_map(*next, "next_goal", model, out.observation.next.emplace());
  if (const Node* held = in.get("carried")) read_map(*held, "carried", model, out.observation.carried.emplace());
  if (const Node* objects = in.get("objects")) read_objects(*objects, out);
  check_prediction(out, in.require("state", ""));
  in.finish();
  return out;
}

ControlCase read_case(const fs::path& file) { return read_case(config::load_yaml(file)); }

Json case_to_json(const ControlCase& c) {
  Json state = sensed_to_json(c.observation);
  state["escape"] = config::write_described(c.memory.escape.state);
  if (c.memory.escape.has_goal) state["last_goal"] = sensed_to_json(c.memory.escape.last_goal);
  if (!c.memory.prediction.computed.empty()) state["prediction"] = config::write_described(c.memory.prediction);
  if (!c.memory.map.empty()) state["map"] = config::description::any_to_json(c.memory.map, {}, {});
  if (c.has_plan) state["plan"] = to_json(c.memory.plan);
  Json objects = Json::array();
  for (std::size_t i = 0; i < c.objects.size(); ++i) {
    Json object = {{"name", c.objects[i].name}};
    config::write_shape(c.objects[i].shape, object);
    object.update(sensed_to_json(c.observation.objects[i]));
    objects.push_back(std::move(object));
  }
  Json out = {
      {"robot", c.robot.resolved}, {"controller", config::to_json(c.controller)}, {"control_period", c.control_period},
      {"state", std::move(state)}, {"goal", sensed_to_json(c.observation.goal)},  {"objects", std::move(objects)}};
  if (c.observation.next) out["next_goal"] = sensed_to_json(*c.observation.next);
  if (c.observation.carried) out["carried"] = sensed_to_json(*c.observation.carried);
  return out;
}

}  // namespace moma
