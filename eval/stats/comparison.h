#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "eval/stats/intervals.h"

// The comparison of B with A on the same worlds. `moma compare`, the verdict of a search, `moma reproduce` and Python
// use it; the report page computes the same (reports/web/src/compare.ts).
namespace moma::stats {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// A rate of one side.
struct Share {
  std::int64_t count = 0;
  double rate = kUnknown;  ///< of n trials; NaN if n = 0
  Interval interval;       ///< Wilson, 95 %
};

/// A rate of both sides in the same n worlds.
struct PairedRate {
  std::string name;
  std::int64_t n = 0;
  Share a, b;
  std::int64_t only_a = 0, only_b = 0;  ///< hits of one side alone
  double difference = kUnknown;         ///< B - A
  Interval interval{-1.0, 1.0};         ///< Bonett and Price's interval of the difference, 95 %
  double p = 1.0;                       ///< exact McNemar test
  double p_holm = kUnknown;             ///< set by correct_by_holm(); NaN: no part of a correction

  /// +1: B's rate is significantly higher (p_holm < 0.05), -1: lower, 0: no difference shown.
  int shown() const;
};

/// A metric of both sides in the n worlds in which both have it.
struct PairedMean {
  std::string name;
  std::int64_t n = 0;
  double a = kUnknown, b = kUnknown;  ///< means
  Interval of_a{kUnknown, kUnknown};  ///< of the means, 95 %; NaN for too few worlds
  Interval of_b{kUnknown, kUnknown};
  double difference = kUnknown;  ///< mean of B - A
  Interval interval{kUnknown, kUnknown};

  /// +1: the interval lies above zero, -1: below, 0: no difference shown.
  int shown() const;
};

/// The end of one trial, for rates. An error is neither success nor collision.
struct Ending {
  bool success = false;
  bool collision = false;
  bool error = false;
};

struct Comparison {
  std::int64_t n = 0;                     ///< worlds that both met
  std::int64_t errors_a = 0;              ///< trials that ended by an error; they did not succeed
  std::int64_t errors_b = 0;              //
  std::int64_t worlds_with_errors = 0;    ///< errors of one side at least
  std::vector<PairedRate> rates;          ///< success, collision
  std::optional<PairedRate> sans_errors;  ///< success in the worlds without an error; set if there are errors
  std::vector<PairedMean> means;

  /// Finds an entry of `rates` or `means`; throws std::out_of_range.
  const PairedRate& rate(const std::string& name) const;
  const PairedMean& mean(const std::string& name) const;
};

/// Values of one metric, world by world; NaN if a trial has none.
struct PairedValues {
  std::string name;
  std::vector<double> a, b;
};

/// Compares hits of A and B, world by world.
PairedRate paired_rate(std::string name, std::span<const std::pair<bool, bool>> hits);
/// Throws std::invalid_argument for sizes that differ.
PairedMean paired_mean(const PairedValues& values);

/// Compares endings of A and B, world by world, with Holm's correction over the two rates. O(metrics * n * replicates).
Comparison compare(std::span<const std::pair<Ending, Ending>> endings, std::span<const PairedValues> metrics);

/// Applies Holm's correction to the rates of one table.
void correct_by_holm(std::span<PairedRate* const> rates);

}  // namespace moma::stats
