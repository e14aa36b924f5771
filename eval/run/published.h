#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/config/paths.h"
#include "controller/describe/enumeration.h"

namespace moma::run {

/// A figure of the published tables, and its SQL over a store.
struct Figure {
  enum class Kind {
    kRate,  ///< share of trials with `sql` = 1 instead of 0 [%]
    kMean,  ///< mean of `sql` over trials, according to Averaging
    kClock  ///< as kMean, of the wall clock: it varies between runs and is never compared
  };
  std::string_view name;   ///< key in files: failure_rate
  std::string_view label;  ///< label in tables: "failures %"
  Kind kind;
  std::string_view sql;  ///< expression over a row `t` of trial and `e` of execution
  double scale = 1.0;    ///< factor on the result of `sql`
  int decimals = 1;
};
std::span<const Figure> figures();

/// The trials of a mean; the papers do not specify them.
enum class Averaging {
  kArrived,  ///< mean of each trial, over the trials that arrived
  kAll,      ///< over all trials
  kSteps     ///< over all steps of the trials that arrived: long trials count more
};
constexpr auto words(Of<Averaging>) { return std::to_array<std::string_view>({"arrived", "all", "steps"}); }

struct PublishedRow {
  std::string robot;
  std::string method;
  int problems = 0;
  std::map<const Figure*, double> values;
};

/// An experiment: the suite that repeats it, and its published results. One entry of configs/published.yaml:
///
///   NAME:
///     suite: suites/reproduce-NAME.yaml       # relative to the file
///     source: ...
///     averaging: arrived
///     figures: [failure_rate, mean_manipulability]      # of the table
///     pairs: [[mmc, rrmc]]                              # methods whose differences are shown
///     rows: [{robot: panda, method: rrmc, problems: 1000, failure_rate: 12.4}]
struct Experiment {
  std::string name;
  fs::path suite;
  std::string source;
  Averaging averaging = Averaging::kArrived;
  std::vector<const Figure*> figures;
  std::vector<std::pair<std::string, std::string>> pairs;
  std::vector<PublishedRow> rows;

  const PublishedRow* find(const std::string& robot, const std::string& method) const;
};

/// Reads the experiment of that name. Throws config::ConfigError for the file, or if it has no such name.
Experiment read_experiment(const fs::path& file, const std::string& name);

/// Finds configs/published.yaml in the working folder or above it, beside or above the program, or in the installation.
/// Throws RunError with the searched folders.
fs::path find_published();

}  // namespace moma::run
