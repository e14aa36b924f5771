#include <cstdint>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "controller/config/read_described.h"
#include "controller/config/robot_build.h"
#include "controller/config/robot_file.h"
#include "controller/config/write_described.h"

namespace moma::config {
namespace {

constexpr std::size_t kMostSensors = 64;

void check_sensor(const Sensor& sensor, MapReader& in, std::set<std::string>& names) {
  in.check(!sensor.name.empty(), "name", "found '', expected a name");
  in.check(names.insert(sensor.name).second, "name", "another sensor is called '" + sensor.name + "'");
  in.check(sensor.field_of_view[0] > 0.0, "field_of_view", "found an azimuth of 0, expected more");
  in.check(sensor.field_of_view[1] <= std::numbers::pi + 1e-9, "field_of_view",
           "found an elevation above pi, expected at most pi");
  in.check(sensor.rows == 1 || sensor.field_of_view[1] > 0.0, "rows",
           "found " + std::to_string(sensor.rows) + " rows for an elevation of 0, expected 1");
  const std::int64_t rays = std::int64_t{sensor.columns} * sensor.rows;
  in.check(
      rays <= kMaxRays, "columns",
      "found " + std::to_string(rays) + " rays (columns times rows), expected at most " + std::to_string(kMaxRays));
}

}  // namespace

void read_sensors(MapReader& robot, RobotBuild& build) {
  const Node* node = robot.get("sensors");
  if (node == nullptr) return;
  const std::string key = robot.key_of("sensors");
  std::set<std::string> names;
  nlohmann::ordered_json& written = build.resolved["sensors"] = nlohmann::ordered_json::array();
  for (const Node& item : description::sequence(*node, key).items) {
    robot.check(written.size() < kMostSensors, "sensors",
                "found more sensors than " + std::to_string(kMostSensors) + ", expected at most so many");
    MapReader in(item, key + "[" + std::to_string(written.size()) + "]");
    Sensor sensor;
    read_members(in, sensor);
    check_sensor(sensor, in, names);
    const int link = sensor.link.empty() ? 0 : build.model.find_link(sensor.link);
    in.check(link >= 0, "link", "found '" + sensor.link + "', which is no link of the robot");
    in.finish();
    Isometry X_LC = Isometry::Identity();
    X_LC.translation() = sensor.position;
    X_LC.linear() = rotation_of(sensor.rpy);
    written.push_back(write_described(sensor));
    build.model.sensors.push_back({std::move(sensor), link, X_LC});
  }
}

}  // namespace moma::config
