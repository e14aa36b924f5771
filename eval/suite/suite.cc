#include "eval/suite/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "controller/config/json_node.h"
#include "controller/config/reader.h"
#include "eval/suite/keys.h"
#include "eval/suite/resolve.h"
#include "eval/suite/sections.h"
#include "eval/suite/sweep.h"
#include "eval/trial/key.h"
#include "eval/trial/trial.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;

bool is_library_key(const std::string& key) {
  return key.starts_with("controllers.") && key.ends_with(".path") && key.find('.', 12) == key.size() - 5;
}

// The suite as written, with the files of robots and controllers opened if keys inside them are set.
class Draft {
 public:
  Draft(Node root, const fs::path& file) : root_(std::move(root)), directory_(file.parent_path()) {}

  const Node& root() const { return root_; }
  Node& root() { return root_; }

  void set(const std::string& key, const Node& value) {
    if (key == "controller" || key.starts_with("controller.")) {
      const std::string rest = key == "controller" ? "" : key.substr(10);
      for (const std::string& name : controller_names(value)) set("controllers." + name + rest, value);
      return;
    }
    if (key.starts_with("controllers.")) {
      const std::string name = key.substr(12, key.find('.', 12) - 12);
      if (key.size() > 12 + name.size()) {
        Node* controller = find("controllers", name);
        if (controller == nullptr && !is_library_key(key)) refuse_controller(value, key, name);
        open(controller);
      }
    }
    if (key.starts_with("robot.")) open(root_.find("robot"));
    if (key.starts_with("disturbances.")) open(root_.find("disturbances"));
    const bool names_file = key == "robot" || key == "worlds.frozen" || key == "worlds.scenes" ||
                            (key == "disturbances" && value.scalar.ends_with(".yaml")) ||
                            (key.starts_with("controllers.") && key.find('.', 12) == std::string::npos) ||
                            is_library_key(key);
    Node placed = value;
    if (names_file && value.kind == Node::Kind::kScalar) placed.scalar = fs::absolute(path_of(value)).string();
    config::set_value(root_, key, std::move(placed));
  }

 private:
  std::vector<std::string> controller_names(const Node& value) const {
    const Node* controllers = root_.find("controllers");
    std::vector<std::string> names;
    if (controllers != nullptr)
      for (const auto& [name, node] : controllers->entries) names.push_back(name);
    if (names.empty()) config::fail(value.mark, "controller", "the suite names no controllers");
    return names;
  }

  [[noreturn]] void refuse_controller(const Node& value, const std::string& key, const std::string& name) const {
    const std::vector<std::string> names = controller_names(value);
    config::fail(value.mark, key,
                 fmt::format("the suite has no controller {}{}; it has {}", name, config::suggestion(name, names),
                             fmt::join(names, ", ")));
  }

  Node* find(const char* map, const std::string& name) {
    Node* node = root_.find(map);
    return node != nullptr ? node->find(name) : nullptr;
  }

  // Resolves a value that names a file: relative to the file with the value; for an option relative to the working
  // folder, or else to the suite.
  fs::path path_of(const Node& node) const {
    const fs::path path(node.scalar);
    if (!node.mark.file.starts_with("--set ")) return config::directory_of(node.mark) / path;
    std::error_code error;
    return fs::exists(path, error) ? path : directory_ / path;
  }

  // Replaces a file's path by its map, so that single keys can be set.
  void open(Node* node) const {
    if (node == nullptr || node->kind != Node::Kind::kScalar) return;
    if (node == root_.find("disturbances") && node->scalar == "none") {
      *node = config::parse_yaml("{}", node->mark.file);
      return;
    }
    *node = config::load_yaml(path_of(*node));
  }

  Node root_;
  fs::path directory_;
};

std::string short_value(const Node& node) {
  if (node.kind != Node::Kind::kScalar) {
    // A column of a table has no room for a whole robot. The digest tells two of one name apart.
    constexpr std::size_t kLongest = 60;
    const Json value = config::node_to_json(node);
    const std::string text = value.dump();
    if (text.size() <= kLongest) return text;
    const bool named = value.is_object() && value.contains("name") && value["name"].is_string();
    return fmt::format("{}#{}", named ? value["name"].get<std::string>() : "", digest_hex(text).substr(0, 6));
  }
  const bool file = node.scalar.ends_with(".yaml") || node.scalar.ends_with(".yml");
  return file ? fs::path(node.scalar).stem().string() : node.scalar;
}

// Returns the part of an assignment that concerns a controller: all but other controllers' keys.
Assignment part_for(const Assignment& assignment, const std::string& controller) {
  Assignment part;
  for (const auto& [key, value] : assignment) {
    const bool others = key.starts_with("controllers.") && key.substr(12, key.find('.', 12) - 12) != controller;
    if (!others) part.emplace_back(key, value);
  }
  return part;
}

void describe(SuitePoint& point, const Assignment& assignment) {
  for (const auto& [key, value] : assignment) {
    config::as_object(point.params)[key] = config::node_to_json(value);
    point.label += fmt::format("{}{}={}", point.label.empty() ? "" : " ", short_key(key), short_value(value));
  }
}

constexpr const char* kContentKeys[] = {"robot", "controllers"};

bool of_the_whole(std::string_view key) {
  return std::ranges::find(kKeysOfTheWhole, key.substr(0, key.find('.'))) != kKeysOfTheWhole.end();
}

bool is_section(const std::string& key) {
  const auto has = [&key](const auto& keys) {
    return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
  };
  return of_the_whole(key) || has(kContentKeys) || has(kSectionKeys);
}

MapReader known_keys(const Node& root) {
  MapReader in(root, "");
  for (const std::string_view key : kKeysOfTheWhole) in.get(std::string(key));
  for (const char* key : kContentKeys) in.get(key);
  for (const char* key : kSectionKeys) in.get(key);
  return in;
}

// A robot that lacks data for its simulation mode would fail in every trial.
void check_plants(const Suite& suite, const Node& root) {
  std::set<std::string> seen;
  for (const SuitePoint& point : suite.points) {
    if (!seen.insert(point.robot_digest + std::string(to_string(point.simulation.mode))).second) continue;
    try {
      check_plant(point);
    } catch (const std::runtime_error& error) {
      const Node* robot = root.find("robot");
      config::fail(robot != nullptr ? robot->mark : root.mark, "robot",
                   fmt::format("cannot be simulated in {} mode: {}", to_string(point.simulation.mode), error.what()));
    }
  }
}

// A robot without sensors would see no object, nor would a controller that is told by depth and makes no map.
void check_sensors(Suite& suite, const Node& root) {
  const auto at = [&](const char* key) {
    const Node* node = root.find(key);
    return node != nullptr ? node->mark : root.mark;
  };
  for (const SuitePoint& point : suite.points) {
    const SeenBy by = point.disturbances.detection.seen_by;
    if (by != SeenBy::kRule && point.robot->model->sensors.empty())
      config::fail(at("robot"), "robot",
                   fmt::format("has no sensors, and disturbances.objects.seen_by is {}; give the robot file `sensors`, "
                               "or take seen_by: rule",
                               to_string(by)));
    if (by != SeenBy::kDepth) continue;
    const MapParams& map = point.controller_params.map;
    if (point.plugin != nullptr || !map.enabled)
      config::fail(
          at("controllers"), "controllers." + point.controller,
          fmt::format("{}, and disturbances.objects.seen_by is depth: it would know of no object; take seen_by: "
                      "rule or sensors, or a controller of moma's with `map`",
                      point.plugin != nullptr ? "is a plugin, which gets no ranges" : "has no `map`"));
    if (map.unseen.enabled && map.unseen.start > point.worlds.start_room())
      add_warning(suite.warnings,
                  fmt::format("controllers.{}: map.unseen.start: space {:g} m about the start counts as free, and "
                              "worlds.start_room promises {:g} m",
                              point.controller, map.unseen.start, point.worlds.start_room()));
  }
}

// Reads the robot once for all assignments with the same robot.
class Robots {
 public:
  SuiteRobot get(const Node& root, std::vector<std::string>& warnings) {
    MapReader in(root, "");
    const Node& node = in.require("robot", "the path of a robot file, or a map as in one");
    const std::string text = node.mark.file + "\n" + config::node_to_json(node).dump();
    if (known_.robot != nullptr && text == text_) return known_;
    auto robot = std::make_shared<config::LoadedRobot>(config::read_robot(node, "robot"));
    for (const std::string& warning : robot->warnings) add_warning(warnings, "robot: " + warning);
    known_.digest = canonical_digest(robot->resolved);
    known_.robot = std::move(robot);
    text_ = text;
    return known_;
  }

 private:
  SuiteRobot known_;
  std::string text_;
};

}  // namespace

Suite load_suite(const fs::path& file, const Overrides& overrides) {
  Draft draft(config::load_yaml(file), file);
  if (draft.root().kind != Node::Kind::kMap) {
    config::fail({file.string(), 0, 0}, "",
                 "the suite is empty; expected a map with robot, controllers, worlds and trials");
  }
  std::optional<Node> lenient;  // an option about files also holds for the robots of a sweep
  for (const auto& [key, text] : overrides) {
    Node value = config::parse_yaml(text, "--set " + key + "=" + text);
    value.mark = {"--set " + key + "=" + text, 0, 0};
    const std::string first = key.substr(0, key.find('.'));
    if (first != "controller" && !is_section(first)) {
      if (const std::string meant = meant_key(key); !meant.empty())
        config::fail(value.mark, key, "unknown key (did you mean " + meant + "?)");
    }
    draft.set(key, value);
    if (key == "robot.lenient") lenient = value;
  }

  Suite suite;
  suite.name = file.stem().string();
  MapReader in = known_keys(draft.root());
  in.finish();
  read_whole(in, suite);
  if (const Node* metrics = in.get("metrics")) {
    for (const auto& [name, expression] : metrics->entries) {
      const std::string outcome = name.ends_with("_rate") ? name.substr(0, name.size() - 5) : name;
      if (from_string<Outcome>(outcome) || name == "success_without_errors")
        config::fail(expression.mark, "metrics." + name, "is the name of moma's own rate of outcomes; take another");
    }
  }
  const Node* sweep = in.get("sweep");
  if (sweep != nullptr && sweep->kind == Node::Kind::kScalar && sweep->scalar == "none") sweep = nullptr;
  std::vector<Assignment> assignments(1);
  if (sweep != nullptr) assignments = read_sweep(*sweep, "sweep");
  Robots robots;
  std::vector<std::vector<SuitePoint>> by_controller;
  std::set<std::string> seen;
  for (const Assignment& assignment : assignments) {
    Draft assigned = draft;
    for (const auto& [key, value] : assignment) {
      if (of_the_whole(key))
        config::fail(value.mark, "sweep",
                     fmt::format("'{}' cannot be swept: it has one value for the whole suite", key));
      assigned.set(key, value);
      if (key == "robot" && lenient) assigned.set("robot.lenient", *lenient);
    }
    known_keys(assigned.root()).finish();
    const SuiteRobot robot = robots.get(assigned.root(), suite.warnings);
    std::vector<SuitePoint> points = read_points(assigned.root(), robot, suite.warnings);
    by_controller.resize(std::max(by_controller.size(), points.size()));
    for (std::size_t c = 0; c < points.size(); ++c) {
      SuitePoint& point = points[c];
      describe(point, part_for(assignment, point.controller));
      // An axis of another controller's key repeats the same point of this one.
      if (seen.insert(point.controller + "\n" + point.params.dump()).second)
        by_controller[c].push_back(std::move(point));
    }
  }
  for (auto& points : by_controller)
    for (SuitePoint& point : points) suite.points.push_back(std::move(point));
  check_suite(suite, in.require("trials", "").mark);
  check_plants(suite, draft.root());
  check_sensors(suite, draft.root());
  suite.resolved = resolved_json(suite, sweep != nullptr);
  return suite;
}

std::string trial_key(const SuitePoint& point, std::uint64_t world_index) {
  return TrialKeys(point).key(point.worlds.identity(world_index));
}

}  // namespace moma
