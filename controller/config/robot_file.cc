#include "controller/config/robot_file.h"

#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <utility>

#include "controller/config/json_node.h"
#include "controller/config/plausible.h"
#include "controller/config/read_described.h"
#include "controller/config/reader.h"
#include "controller/config/robot_build.h"
#include "controller/config/text_file.h"
#include "controller/config/urdf_collision.h"
#include "controller/config/write_described.h"
#include "controller/describe/accepted.h"
#include "controller/model/urdf.h"

namespace moma::config {
namespace {

void read_packages(MapReader& robot, std::map<std::string, fs::path>& named) {
  MapReader in(robot, "packages");
  for (const auto& [name, value] : in.entries()) {
    std::string folder;
    in.read(name, folder);
    std::error_code error;
    const fs::path path = directory_of(value.mark) / folder;
    in.check(fs::is_directory(path, error), name, "found '" + folder + "', which is no folder");
    named[name] = path;
  }
  in.finish();
}

LoadedRobot build_robot(const Node& node, const std::string& key, MeshSolids& meshes) {
  MapReader robot(node, key);
  RobotBuild build;
  build.meshes = &meshes;
  build.resolved["name"] = "";
  read_urdf_of(robot, build);
  build.model.name = build.tree.name;
  robot.read("name", build.model.name);
  robot.check(!build.model.name.empty(), "name", "the URDF gives no name, so give one");
  build.resolved["name"] = build.model.name;
  read_base(robot, build);
  read_arm(robot, build);
  read_collision(robot, build);
  read_sensors(robot, build);
  robot.finish();
  for (std::string& warning : implausible(build.model, build.resolved)) build.warnings.push_back(std::move(warning));
  return {std::make_shared<const RobotModel>(std::move(build.model)), std::move(build.resolved),
          std::move(build.warnings), std::move(build.notes)};
}

constexpr std::size_t kMostSensors = 64;

void check_sensor(const Sensor& sensor, MapReader& in, std::set<std::string>& names) {
  in.check(!sensor.name.empty(), "name", "found '', expected a name");
  in.check(names.insert(sensor.name).second, "name", "another sensor is called '" + sensor.name + "'");
  in.check(sensor.field_of_view[0] > 0.0, "field_of_view", "found an azimuth of 0, expected more");
  in.check(sensor.field_of_view[1] <= std::numbers::pi + 1e-9, "field_of_view",
           "found an elevation above pi, expected at most pi");
  for (const auto& [name, range] : {std::pair{"pan", sensor.head.pan}, std::pair{"tilt", sensor.head.tilt}})
    in.check(range[0] <= 0.0 && range[1] >= 0.0, "head",
             std::string("has a ") + name + " of [" + number_text(range[0]) + ", " + number_text(range[1]) +
                 "], expected a lower and an upper angle with 0 between them");
  in.check(sensor.rows == 1 || sensor.field_of_view[1] > 0.0, "rows",
           "found " + std::to_string(sensor.rows) + " rows for an elevation of 0, expected 1");
  const std::int64_t rays = std::int64_t{sensor.columns} * sensor.rows;
  in.check(
      rays <= kMaxRays, "columns",
      "found " + std::to_string(rays) + " rays (columns times rows), expected at most " + std::to_string(kMaxRays));
}

}  // namespace

void read_urdf_of(MapReader& robot, RobotBuild& build) {
  read_packages(robot, build.packages.named);
  const Node* text_node = robot.get("urdf_text");  // only in resolved robots
  const Node* path_node = robot.get("urdf");
  std::string text;
  std::string name = "the resolved robot's URDF";
  const Node& node = text_node != nullptr ? *text_node : robot.require("urdf", "the path of a URDF file");
  robot.check(text_node == nullptr || path_node == nullptr, "urdf", "give `urdf` or `urdf_text`, not both");
  if (text_node != nullptr) {
    text = read_string(node, robot.key_of("urdf_text"));
  } else {
    const std::string uri = read_string(node, robot.key_of("urdf"));
    try {
      build.packages.directory = directory_of(node.mark);
      const fs::path file = build.packages.resolve(uri);
      build.packages.directory = file.parent_path();
      name = file.string();
      text = read_text_file(file);
    } catch (const std::runtime_error& e) {
      robot.fail_at("urdf", e.what());
    }
  }
  bool lenient = false;
  robot.read("lenient", lenient);
  try {
    build.tree = read_urdf(text, lenient ? UrdfReading::kLenient : UrdfReading::kStrict);
  } catch (const UrdfError& e) {
    robot.fail_at(text_node != nullptr ? "urdf_text" : "urdf", name + ": " + e.what());
  }
  for (const std::string& what : build.tree.left_out)
    build.warnings.push_back("left out, since `lenient` is set: " + name + ": " + what);
  build.resolved["urdf_text"] = text;
  if (robot.get("left_out") != nullptr) robot.check(text_node != nullptr, "left_out", "belongs to resolved robots");
  if (lenient) {
    build.resolved["lenient"] = true;
    build.resolved["left_out"] = build.tree.left_out;
  }
}

LoadedRobot load_robot(const fs::path& file) { return read_robot(load_yaml(file), ""); }

LoadedRobot read_robot(const Node& node, const std::string& key) {
  MeshSolids meshes;
  return read_robot(node, key, meshes);
}

LoadedRobot read_robot(const Node& node, const std::string& key, MeshSolids& meshes) {
  if (node.kind != Node::Kind::kScalar) return build_robot(node, key, meshes);
  const fs::path file = directory_of(node.mark) / node.scalar;
  std::error_code error;
  if (node.scalar.empty() || !fs::is_regular_file(file, error)) {
    fail(node.mark, key,
         "found '" + node.scalar + "', expected the path of a robot file; no such file: " + file.string());
  }
  return build_robot(load_yaml(file), "", meshes);
}

LoadedRobot robot_from_resolved(const Json& resolved) {
  return read_robot(node_from_json(resolved, "resolved robot"), "robot");
}

void read_sensors(MapReader& robot, RobotBuild& build) {
  const Node* node = robot.get("sensors");
  if (node == nullptr) return;
  std::set<std::string> names;
  Json& written = build.resolved["sensors"] = Json::array();
  for_items(*node, robot.key_of("sensors"), "a list of sensors", [&](const Node& item, const std::string& key) {
    robot.check(written.size() < kMostSensors, "sensors",
                "found more sensors than " + std::to_string(kMostSensors) + ", expected at most so many");
    MapReader in(item, key);
    Sensor sensor;
    read_members(in, sensor);
    check_sensor(sensor, in, names);
    const int link = sensor.link.empty() ? 0 : build.model.find_link(sensor.link);
    in.check(link >= 0, "link", "found '" + sensor.link + "', which is no link of the robot");
    in.finish();
    const Isometry X_LC = pose_of(rotation_of(sensor.rpy), sensor.position);
    written.push_back(write_described(sensor));
    build.model.sensors.push_back({std::move(sensor), link, X_LC});
  });
}

std::vector<UrdfCollision> load_urdf_collision(const fs::path& robot_file, UrdfPart part) {
  const Node node = load_yaml(robot_file);
  MapReader robot(node, "");
  RobotBuild build;
  read_urdf_of(robot, build);
  std::vector<UrdfCollision> all;
  const auto add = [&](const std::string& link, const UrdfGeometry& geometry) {
    UrdfCollision element{geometry, link, {}};
    if (!geometry.mesh.empty()) {
      try {
        element.surface = read_mesh(build.packages.resolve(geometry.mesh), geometry.scale);
      } catch (const std::runtime_error& e) {
        robot.fail_at("urdf", "link " + link + ": " + e.what());
      }
    }
    all.push_back(std::move(element));
  };
  if (part == UrdfPart::kVisual) {
    for (const UrdfVisual& visual : read_urdf_visuals(build.resolved.at("urdf_text").get<std::string>()))
      add(visual.link, visual.geometry);
  } else {
    for (const UrdfLink& link : build.tree.links)
      for (const UrdfGeometry& geometry : link.collision) add(link.name, geometry);
  }
  return all;
}

}  // namespace moma::config
