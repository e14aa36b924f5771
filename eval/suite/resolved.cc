#include <fmt/format.h>

#include "controller/config/json_node.h"
#include "controller/config/reader.h"
#include "eval/suite/controller_entry.h"
#include "eval/suite/resolve.h"
#include "eval/suite/sections.h"
#include "eval/suite/suite.h"
#include "eval/trial/key.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;

constexpr const char* kSource = "resolved suite";

SuiteRobot robot_of(const Json& resolved) {
  return {std::make_shared<config::LoadedRobot>(config::robot_from_resolved(resolved)), canonical_digest(resolved)};
}

}  // namespace

Suite suite_from_resolved(const Json& resolved, Plugins plugins) {
  // Robots, by far the largest part, have a reader of their own.
  Json small = resolved;
  if (!small.is_object()) config::fail({kSource, 0, 0}, "", "expected a map");
  if (small.contains("robot")) small["robot"] = true;
  if (small.contains("more_robots")) small["more_robots"] = true;
  const Node root = config::node_from_json(small, kSource);

  Suite suite;
  MapReader in(root, "");
  in.require("name", "a name");
  in.require("samples", "all, failures or none");
  read_whole(in, suite);
  in.require("robot", "a resolved robot");
  for (const char* key : kSectionKeys) in.get(key);
  in.get("controllers");
  in.get("more_robots");
  const Node* points = in.get("points");
  in.finish();

  std::vector<SuiteRobot> robots{robot_of(resolved.at("robot"))};
  if (resolved.contains("more_robots"))
    for (const Json& robot : resolved.at("more_robots")) robots.push_back(robot_of(robot));

  if (points == nullptr) {
    suite.points = read_points(root, robots[0], suite.warnings, plugins);
  } else {
    for (const Node& entry : points->items) {
      const std::string key = fmt::format("points[{}]", suite.points.size());
      MapReader point_in(entry, key);
      const std::string controller = config::read_string(point_in.require("controller", "a name"), key + ".controller");
      int robot = 0;
      point_in.read("robot", robot, 0, static_cast<int>(robots.size()) - 1);
      // The suite at this point alone: its differing sections over those at the top.
      Node at = root;
      for (const char* name : kSectionKeys)
        if (const Node* section = point_in.get(name)) {
          if (Node* top = at.find(name); top != nullptr)
            *top = *section;
          else
            at.entries.emplace_back(name, *section);
        }
      const Node* all = root.find("controllers");
      const Node* params = point_in.get("controller_params");
      if (params == nullptr && all != nullptr) params = all->find(controller);
      if (params == nullptr) point_in.fail_at("controller", "no such controller: " + controller);
      Node only = *params;
      at.find("controllers")->entries = {{controller, std::move(only)}};
      SuitePoint point = read_points(at, robots[static_cast<std::size_t>(robot)], suite.warnings, plugins).front();
      point.label = config::read_string(point_in.require("label", "text"), key + ".label");
      point.params = config::node_to_json(point_in.require("params", "a map"));
      point_in.finish();
      suite.points.push_back(std::move(point));
    }
  }
  if (suite.points.empty()) config::fail({kSource, 0, 0}, "points", "expected at least one point");
  check_suite(suite, {kSource, 0, 0});
  suite.resolved = resolved;
  return suite;
}

}  // namespace moma
