#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/run/published.h"
#include "eval/stats/intervals.h"
#include "eval/suite/suite.h"

namespace moma::run {

struct Measured {
  std::int64_t n = 0;          ///< number of trials
  double value = 0.0;          ///< NaN where n = 0
  stats::Interval interval;    ///< 95 %: Wilson's interval of a rate, otherwise mean -+ 1.96 standard errors
  std::optional<bool> agrees;  ///< agreement with the published figure, if there is one
};

/// A robot with a method: ours, the published row, or both.
struct ReproducedRow {
  std::string robot;
  std::string method;
  std::string label;   ///< the sweep's label except for the robot; ""
  std::int64_t n = 0;  ///< our trials; 0: a published row alone
  std::map<const Figure*, Measured> ours;
  const PublishedRow* published = nullptr;  ///< owned by the experiment
};

/// A - b on the same worlds, in the figure's unit; means over the worlds in which both have a value.
struct PairedDifference {
  std::string robot;
  std::string a, b;
  const Figure* figure = nullptr;
  std::int64_t n = 0;
  double difference = 0.0;
  stats::Interval interval;  ///< 95 %; NaN for too few worlds
};

struct Reproduction {
  std::vector<ReproducedRow> rows;
  std::vector<PairedDifference> differences;
};

/// Reads the trials of the suite `suite_name` from a store filled by run::evaluate(), and compares them with the
/// published figures. A rate agrees if Newcombe's 95 % interval of the difference of the two rates contains 0; a mean
/// if it is nearer than 1.96 standard errors of the difference, where the published trials are assumed to scatter as
/// ours. The experiment must outlive the result. Throws store::StoreError.
Reproduction compare_with_published(const fs::path& store, const std::string& suite_name, const Suite& suite,
                                    const Experiment& experiment);

}  // namespace moma::run
