#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/config/node.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "eval/trial/spec.h"
#include "world/scenario/worlds.h"

namespace moma {

/// Permission to load foreign code that a text names.
enum class Plugins {
  kOfSuite,  ///< a suite file of the user's: any path
  kOfStore,  ///< stored text with the user's permission: absolute path and digest only
  kRefused,  ///< stored text of unknown origin
};

enum class SamplesKept { kAll, kFailures, kNone };
constexpr auto words(Of<SamplesKept>) { return std::to_array<std::string_view>({"all", "failures", "none"}); }

/// `trials: {until: ...}`: worlds come in blocks until every point's Wilson interval (95 %) of the metric's rate is
/// narrow enough at the end of a block, or until `max`. See eval/batch/sequential.h.
struct UntilRule {
  std::string metric = "success";
  double half_width = 0.02;
  std::uint64_t max = 0;
  std::uint64_t block = 100;
};

inline constexpr std::uint64_t kMaxTrials = 100'000'000;

constexpr void describe(auto& v, Of<UntilRule>) {
  using T = UntilRule;
  v.member("metric", &T::metric, {.text = "outcome whose rate is estimated"});
  v.member(
      "half_width", &T::half_width,
      {.range = {1e-4, 0.5, false, true}, .required = true, .text = "half the width of the 95 % interval to reach"});
  v.member("max", &T::max, {.range = {1, kMaxTrials}, .required = true, .text = "largest number of worlds"});
  v.member("block", &T::block,
           in_range({1, kMaxTrials}, "", "number of worlds between two evaluations of the interval"));
}

/// One column of the evaluation: a controller at a sweep point, with everything resolved except the world's index.
struct SuitePoint : TrialSpec {
  std::string controller;  ///< its name in the suite
  std::string label;       ///< "" without a sweep, else e.g. "lambda_q=0.01 k_epsilon=0.5"
  Json params;             ///< swept keys and values; {} without a sweep
  Worlds worlds;
};

/// Returns the key of the point's trial in world `world_index` (eval/trial/key.h).
std::string trial_key(const SuitePoint& point, std::uint64_t world_index);

struct Suite {
  std::string name;
  std::vector<SuitePoint> points;
  std::uint64_t trials = 0;  ///< worlds per point; the maximum if `until` is set
  std::optional<UntilRule> until;
  SamplesKept samples = SamplesKept::kFailures;
  /// The suite's own metrics, `metrics: {NAME: EXPRESSION}`: aggregate SQL expressions over a trial's samples
  /// (eval/store/user_metrics.h).
  std::vector<std::pair<std::string, std::string>> metrics;
  std::vector<config::Mark> metric_marks;  ///< place of each metric
  std::string notes;                       ///< Markdown for the head of the report page; part of no key
  Json resolved;                           ///< the whole suite; suite_from_resolved() restores it
  std::vector<std::string> warnings;
};

/// Keys that concern the suite as a whole and determine no trial. They cannot be swept, and are no part of the sections
/// that points share.
inline constexpr std::array kKeysOfTheWhole =
    std::to_array<std::string_view>({"name", "trials", "samples", "metrics", "notes", "sweep", "tune"});

/// Key and text of each --set option.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// Reads and resolves a suite. Throws config::ConfigError with file, line, column, key.
Suite load_suite(const fs::path& file, const Overrides& overrides = {});
/// Restores a suite from Suite::resolved. Throws config::ConfigError, PluginRefused (eval/suite/controller_entry.h).
Suite suite_from_resolved(const Json& resolved, Plugins plugins = Plugins::kRefused);

}  // namespace moma
