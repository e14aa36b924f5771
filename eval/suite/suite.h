#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "eval/trial/spec.h"
#include "world/scenario/worlds.h"

namespace moma {

enum class SamplesKept { kAll, kFailures, kNone };

/// `trials: {until: ...}`: worlds are met in blocks until, at the end of one, every point's Wilson interval (95 %) of
/// the metric's rate is narrow enough, or `max` is reached. See eval/batch/sequential.h.
struct UntilRule {
  std::string metric = "success";  ///< an outcome
  double half_width = 0.02;
  std::uint64_t max = 0;      ///< [worlds]
  std::uint64_t block = 100;  ///< [worlds]
};

/// One column of the evaluation: a controller (at a sweep point) with everything but the world's index resolved.
struct Point : TrialSpec {
  std::string controller;         ///< its name in the suite
  std::string label;              ///< "" without a sweep, else e.g. "lambda_q=0.01 k_epsilon=0.5"
  nlohmann::ordered_json params;  ///< the swept keys and their values; {} without a sweep
  Worlds worlds;
};

/// The key of the point's trial in world `world_index` (eval/trial/key.h).
std::string trial_key(const Point& point, std::uint64_t world_index);

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
