#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/describe/enumeration.h"

namespace moma::run {

/// A figure of the published tables, and how a store has it.
struct Figure {
  enum class Kind {
    kRate,  ///< part of the trials for which `sql` is 1 and not 0 [%]
    kMean,  ///< of `sql` over trials as Averaging says
    kClock  ///< as kMean, but of the wall clock: not the same at every run, and never compared
  };
  std::string_view name;   ///< as in files: failure_rate
  std::string_view label;  ///< for tables: "failures %"
  Kind kind;
  std::string_view sql;  ///< over a row `t` of trial and `e` of execution
  double scale = 1.0;    ///< on what `sql` gives
  int decimals = 1;
};
/// All of them.
std::span<const Figure> figures();

/// Which trials a mean is over; the papers do not say.
enum class Averaging {
  kArrived,  ///< each trial's own mean, over those that arrived
  kAll,      ///< over all of them
  kSteps     ///< over all steps of those that arrived: long trials count more
};
constexpr auto words(Of<Averaging>) { return std::to_array<std::string_view>({"arrived", "all", "steps"}); }

/// A line of a published table.
struct PublishedRow {
  std::string robot;
  std::string method;
  int problems = 0;
  std::map<const Figure*, double> values;
};

/// An experiment: the suite that repeats it, and what was published of it. One entry of configs/published.yaml:
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
  std::filesystem::path suite;
  std::string source;
  Averaging averaging = Averaging::kArrived;
  std::vector<const Figure*> figures;
  std::vector<std::pair<std::string, std::string>> pairs;
  std::vector<PublishedRow> rows;

  const PublishedRow* find(const std::string& robot, const std::string& method) const;
};

/// The experiment of that name. Throws config::ConfigError: the file, or a name that it does not have.
Experiment read_experiment(const std::filesystem::path& file, const std::string& name);

/// configs/published.yaml in the working folder or above it, beside or above the program, or where it is installed.
/// Throws RunError that says where it was looked for.
std::filesystem::path find_published();

}  // namespace moma::run
