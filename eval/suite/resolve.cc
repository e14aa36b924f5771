#include "eval/suite/resolve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "controller/config/json_node.h"
#include "controller/config/plausible.h"
#include "controller/config/reader.h"
#include "eval/suite/sections.h"
#include "eval/trial/key.h"
#include "eval/trial/spec_file.h"
#include "world/sensing/disturbances_file.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;

/// A missing section is an empty node at its would-be place, so that messages name the file.
Node section(MapReader& in, const char* name) {
  if (const Node* node = in.get(name)) return *node;
  Node nothing;
  nothing.mark = in.mark();
  return nothing;
}

void check_name(const std::string& name, const Node& node, const std::string& key) {
  const auto allowed = [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u > ' ' && u != 0x7f && c != '.' && c != '"' && c != '\'';
  };
  if (name.empty() || name.size() > 64 || !std::ranges::all_of(name, allowed)) {
    config::fail(node.key_place(), key,
                 "a controller's name has 1 to 64 characters, none of them a space, a quote or a dot");
  }
}

// Returns the sections of a point by name, as in the resolved suite.
Json sections_of(const SuitePoint& point) {
  Json sections = sections_json(point);
  sections["worlds"] = point.worlds.to_json();
  sections["disturbances"] = to_json(point.disturbances);
  return sections;
}

// Warns if the base cannot stop from its largest speed between `influence` and `stop` of a velocity damper.
void warn_about_braking(const SuitePoint& point, std::vector<std::string>& warnings) {
  const MobileBase& base = point.robot->model->base;
  const CollisionParams& collision = point.controller_params.collision;
  if (base.max_linear <= 0.0 || !collision.object.enabled || collision.braking.enabled) return;
  const double speed = std::min(base.max_linear, collision.object.gain);
  const double needed = speed * speed / (2.0 * base.max_acceleration.x());
  const double way = collision.object.influence - collision.object.stop;
  if (needed <= way * (1.0 + 1e-9)) return;
  add_warning(
      warnings,
      fmt::format("controllers.{}.collision.influence: rows begin {:.3g} m before they stop the robot, its base "
                  "takes {:.3g} m to brake from {:.3g} m/s ({:.3g} m/s^2) and may run into objects; {:.3g} m or "
                  "more, or collision.braking",
                  point.controller, way, needed, speed, base.max_acceleration.x(), collision.object.stop + needed));
}

/// True if each velocity's acceleration limit is a share of the robot's own, so that limits.acceleration bounds none.
bool bounded_by_shares(const ControllerParams& params, const RobotModel& model) {
  if (model.base_dof() > 0 && !(params.base_share > 0.0)) return false;
  for (int i = 0; i < model.num_joints(); ++i)
    if (!(params.joint_share > 0.0) || !std::isfinite(model.joint(i).acceleration)) return false;
  return true;
}

/// Warns if the suite, an option or the controller's own file sets an acceleration limit that bounds nothing. A preset
/// that includes another knows that its shares replace that one's limit.
void warn_about_acceleration(const std::string& suite_file, const Node& entry, const std::string& key,
                             const SuitePoint& point, std::vector<std::string>& warnings) {
  if (!bounded_by_shares(point.controller_params, *point.robot->model)) return;
  Node opened = entry;
  if (entry.kind == Node::Kind::kScalar) opened = config::load_yaml(config::directory_of(entry.mark) / entry.scalar);
  const Node* limits = opened.find("limits");
  const Node* written = limits != nullptr ? limits->find("acceleration") : nullptr;
  if (written == nullptr) return;
  const std::string& file = written->mark.file;
  if (file != opened.mark.file && file != suite_file && !file.starts_with("--set ")) return;
  add_warning(warnings,
              key +
                  ".limits.acceleration: has no effect: limits.base and limits.joints bound every velocity by "
                  "a share of the robot's own acceleration; change these, or set them to 0");
}

/// Warns about valid values that look like another unit.
void warn_of_units(const TrialSpec& s, std::vector<std::string>& warnings) {
  const Disturbances& d = s.disturbances;
  const char* degrees = ": degrees?";
  const char* millimetres = ": millimetres?";
  const struct {
    const char* key;
    double value;
    config::Usual usual;
  } values[] = {
      {"success.position", s.success.position, {0.0, 0.5, "m", millimetres}},
      {"success.orientation", s.success.orientation, {0.0, 1.0, "rad", degrees}},
      {"disturbances.joints.noise", d.joints.noise, {0.0, 0.2, "rad", degrees}},
      {"disturbances.joints.bias", d.joints.bias, {0.0, 0.2, "rad", degrees}},
      {"disturbances.base.noise.position", d.base.noise.position, {0.0, 0.5, "m", millimetres}},
      {"disturbances.base.noise.rotation", d.base.noise.rotation, {0.0, 0.5, "rad", degrees}},
      {"disturbances.objects.noise.position", d.objects.noise.position, {0.0, 0.5, "m", millimetres}},
      {"disturbances.objects.noise.rotation", d.objects.noise.rotation, {0.0, 0.5, "rad", degrees}},
      {"disturbances.goal.noise.position", d.goal.noise.position, {0.0, 0.5, "m", millimetres}},
      {"disturbances.goal.noise.rotation", d.goal.noise.rotation, {0.0, 0.5, "rad", degrees}},
      {"disturbances.payload.mass", d.payload.mass, {0.0, 50.0, "kg", ": grams?"}},
  };
  for (const auto& v : values)
    if (std::string text = config::unusual(v.key, v.value, v.usual, "suites"); !text.empty())
      add_warning(warnings, std::move(text));
}

}  // namespace

void add_warning(std::vector<std::string>& warnings, std::string text) {
  if (std::ranges::find(warnings, text) == warnings.end()) warnings.push_back(std::move(text));
}

std::vector<SuitePoint> read_points(const Node& root, const SuiteRobot& robot, std::vector<std::string>& warnings,
                                    Plugins plugins) {
  SuitePoint common;
  common.params = Json::object();
  common.robot = robot.robot;
  common.robot_digest = robot.digest;
  MapReader in(root, "");
  common.simulation = read_simulation(section(in, "simulation"), "simulation");
  common.success = read_success(section(in, "success"), "success", common.simulation);
  common.stuck = read_stuck(section(in, "stuck"), "stuck", common.simulation);
  common.infeasible = read_infeasible(section(in, "infeasible"), "infeasible");
  if (const Node* disturbances = in.get("disturbances"))
    common.disturbances = read_disturbances(*disturbances, "disturbances");
  warn_of_units(common, warnings);
  common.worlds =
      Worlds::read(in.require("worlds", "a map such as {seed: 1, families: {open: {weight: 1}}}"), "worlds");

  const Node& controllers =
      in.require("controllers", "a map {NAME: FILE.yaml, ...} or {NAME: {include: FILE.yaml, ...}, ...}");
  if (controllers.kind != Node::Kind::kMap || controllers.entries.empty()) {
    config::fail(controllers.mark, "controllers",
                 "expected at least one controller, {NAME: FILE.yaml, ...} or {NAME: {include: FILE.yaml, ...}, ...}");
  }
  std::vector<SuitePoint> points;
  for (const auto& [name, node] : controllers.entries) {
    const std::string key = "controllers." + name;
    check_name(name, node, key);
    if (node.kind == Node::Kind::kNull)
      config::fail(node.mark, key, "found nothing, expected a file or a map ({} takes every default)");
    SuitePoint& point = points.emplace_back(common);
    point.controller = name;
    std::vector<std::string> of_it;
    set_controller(point,
                   read_suite_controller(node, key, robot.robot, point.simulation.control_period, of_it, plugins));
    for (const std::string& warning : of_it)
      add_warning(warnings, warning.find(key) == std::string::npos ? key + ": " + warning : warning);
    warn_about_acceleration(root.mark.file, node, key, point, warnings);
  }
  return points;
}

void check_suite(Suite& suite, const config::Mark& mark) {
  std::map<std::string, std::string> contents;
  for (const SuitePoint& point : suite.points) {
    const long long frozen = point.worlds.size();
    if (frozen >= 0 && suite.trials > static_cast<std::uint64_t>(frozen)) {
      config::fail(mark, "trials",
                   fmt::format("found {}, but the frozen set has only {} worlds", suite.trials, frozen));
    }
    const std::string name = point.label.empty() ? point.controller : point.controller + " " + point.label;
    const ControllerParams& params = point.controller_params;
    if (has_qp(point) && params.collision.object.enabled && params.collision.object.stop > point.worlds.clearance()) {
      add_warning(suite.warnings,
                  fmt::format("controllers.{}.collision.stop: {} m is more than worlds.clearance ({} m): goals may lie "
                              "where this controller refuses to go",
                              point.controller, params.collision.object.stop, point.worlds.clearance()));
    }
    if (has_qp(point)) warn_about_braking(point, suite.warnings);
    Json content = {{"robot", point.robot_digest}, {"controller", point.controller_resolved}};
    content.update(sections_of(point));
    const auto [same, fresh] = contents.emplace(canonical_digest(content), name);
    if (!fresh) {
      add_warning(suite.warnings,
                  fmt::format("{} and {} are the same in every value: they share their trials", same->second, name));
    }
  }
}

Json resolved_json(const Suite& suite, bool swept) {
  const SuitePoint& first = suite.points.front();
  Json json = {{"name", suite.name}, {"robot", first.robot->resolved}, {"controllers", Json::object()}};
  for (const SuitePoint& point : suite.points)
    if (!json["controllers"].contains(point.controller))
      json["controllers"][point.controller] = stored_controller(point);
  const Json base = sections_of(first);
  for (const char* key : kSectionKeys)
    if (!base.at(key).empty()) json[key] = base.at(key);
  json["trials"] = trials_json(suite);
  json["samples"] = to_string(suite.samples);
  for (const auto& [name, expression] : suite.metrics) config::as_object(json["metrics"])[name] = expression;
  if (!suite.notes.empty()) json["notes"] = suite.notes;
  if (!swept) return json;

  // Robots are large: each is stored once.
  std::vector<std::string> robots{first.robot_digest};
  Json more_robots = Json::array();
  Json points = Json::array();
  for (const SuitePoint& point : suite.points) {
    Json entry = {{"controller", point.controller}, {"label", point.label}, {"params", point.params}};
    const auto found = std::ranges::find(robots, point.robot_digest);
    if (found != robots.begin()) entry["robot"] = found - robots.begin();
    if (found == robots.end()) {
      robots.push_back(point.robot_digest);
      more_robots.push_back(point.robot->resolved);
    }
    if (Json controller = stored_controller(point); controller != json["controllers"][point.controller])
      entry["controller_params"] = std::move(controller);
    const Json sections = sections_of(point);
    for (const char* key : kSectionKeys)
      if (sections.at(key) != base.at(key)) entry[key] = sections.at(key);
    points.push_back(std::move(entry));
  }
  if (!more_robots.empty()) json["more_robots"] = std::move(more_robots);
  json["points"] = std::move(points);
  return json;
}

}  // namespace moma
