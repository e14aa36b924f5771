#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/run/published.h"
#include "eval/stats/comparison.h"
#include "eval/stats/intervals.h"
#include "eval/suite/suite.h"

namespace moma::run {

/// One figure of ours, in the figure's unit.
struct Measured {
  std::int64_t n = 0;          ///< trials that it is of
  double value = 0.0;          ///< NaN where n = 0
  stats::Interval interval;    ///< 95 %: Wilson's of a rate, mean -+ 1.96 standard errors otherwise
  std::optional<bool> agrees;  ///< with the published one, where there is one to compare
};

/// A robot with a method: ours, the published row, or both.
struct ReproducedRow {
  std::string robot;
  std::string method;
  std::string label;   ///< of a sweep beyond the robot; ""
  std::int64_t n = 0;  ///< trials of ours; 0: a published row alone
  std::map<const Figure*, Measured> ours;
  const PublishedRow* published = nullptr;  ///< of the experiment
};

/// a - b on the same worlds, in the figure's unit; means over the worlds that both have it of.
struct PairedDifference {
  std::string robot;
  std::string a, b;
  const Figure* figure = nullptr;
  std::int64_t n = 0;
  double difference = 0.0;
  stats::Interval interval;  ///< 95 %; NaN of too few worlds
};

struct Reproduction {
  std::vector<ReproducedRow> rows;
  std::vector<PairedDifference> differences;
};

/// Reads the suite's trials from a store that run::evaluate() filled, `suite_name` as it is called there, and puts the
/// published figures beside them. A rate agrees where Newcombe's 95 % interval of the difference of the two rates holds
/// 0; a mean where it is nearer than 1.96 standard errors of the difference, the published trials taken to scatter as
/// ours. The experiment has to outlive the result. Throws store::StoreError.
Reproduction compare_with_published(const std::filesystem::path& store, const std::string& suite_name,
                                    const Suite& suite, const Experiment& experiment);

}  // namespace moma::run
