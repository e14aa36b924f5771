#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/controller_file.h"
#include "controller/config/robot_file.h"
#include "plugin/host/plugin.h"
#include "world/plant/plant.h"
#include "world/scenario/worlds.h"
#include "world/sensing/disturbances.h"

namespace moma {

struct SuccessRule {
  double position = 0.02;     ///< [m]
  double orientation = 0.05;  ///< [rad]
  double dwell = 0.2;         ///< [s]
};

struct StuckRule {
  double time = 2.0;       ///< [s]
  double motion = 0.0005;  ///< [m or rad]
};

struct InfeasibleRule {
  double time = 0.5;  ///< [s]
};

enum class SamplesKept { kAll, kFailures, kNone };
constexpr auto words(Of<SamplesKept>) { return std::to_array<std::string_view>({"all", "failures", "none"}); }
static_assert(all_worded<SamplesKept>());

/// `trials: {until: ...}`: worlds are met in blocks until, at the end of one, every point's Wilson interval (95 %) of
/// the metric's rate is narrow enough, or `max` is reached. See eval/batch/sequential.h.
struct UntilRule {
  std::string metric = "success";  ///< an outcome
  double half_width = 0.02;
  std::uint64_t max = 0;      ///< [worlds]
  std::uint64_t block = 100;  ///< [worlds]
};

/// One column of the evaluation: a controller (at a sweep point) with everything but the world's index resolved.
struct Point {
  std::string controller;         ///< its name in the suite
  std::string label;              ///< "" without a sweep, else e.g. "lambda_q=0.01 k_epsilon=0.5"
  nlohmann::ordered_json params;  ///< the swept keys and their values; {} without a sweep
  std::shared_ptr<const config::LoadedRobot> robot;
  std::string robot_digest;  ///< XXH3-128 of robot->resolved, 32 hex digits; shared by all points of a robot
  ControllerParams controller_params;
  std::shared_ptr<const Plugin> plugin;  ///< with `method: plugin`: stands in for controller_params
  /// All of its parameters. Of a plugin: the digest of its library and the parameters handed over, not the path, so
  /// that trials are known again wherever the library lies.
  nlohmann::ordered_json controller_resolved;
  Worlds worlds;
  SimulationConfig simulation;
  SuccessRule success;
  StuckRule stuck;
  InfeasibleRule infeasible;
  Disturbances disturbances;  ///< all off by default
};

/// Whether the point's controller is one of moma's QPs.
inline bool has_qp(const Point& point) noexcept {
  return point.plugin == nullptr && point.controller_params.method == Method::kQp;
}

struct Suite {
  std::string name;
  std::vector<Point> points;
  std::uint64_t trials = 0;  ///< worlds per point; the most there can be where `until` is set
  std::optional<UntilRule> until;
  SamplesKept samples = SamplesKept::kFailures;
  /// The suite's own metrics, `metrics: {NAME: EXPRESSION}`: aggregate SQL expressions over a trial's samples
  /// (eval/store/user_metrics.h).
  std::vector<std::pair<std::string, std::string>> metrics;
  nlohmann::ordered_json resolved;  ///< the whole suite: suite_from_resolved() gives it back
  std::vector<std::string> warnings;
};

/// Key and text of each --set option.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// Reads and resolves a suite. Throws config::ConfigError naming file, line, column, key.
Suite load_suite(const std::filesystem::path& file, const Overrides& overrides = {});
Suite suite_from_resolved(const nlohmann::ordered_json& resolved);

}  // namespace moma
