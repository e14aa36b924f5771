#pragma once

#include <string>
#include <utility>
#include <vector>

#include "eval/run/named_point.h"
#include "eval/stats/comparison.h"

namespace moma::run {

struct ComparedMetric {
  std::string name;
  std::string a;  ///< SQL over a row `ta` of trial
  std::string b;  ///< the same over `tb`
};

/// Side B against side A on the worlds that both met.
struct ComparedPoints {
  std::string suite;
  std::vector<std::pair<NamedPoint, NamedPoint>> pairs;  ///< several if controllers were named
  bool same_conditions = true;  ///< the params of each pair are equal except for gains (disturbances, robot, worlds)
  stats::Comparison comparison;
};

/// Compares two sides by name. A name of one point (named_points()) is that point. A controller's name that belongs to
/// no point alone stands for all its points, each paired with the other side's point under the same conditions. Throws
/// StoreError{kNotFound} if there is no such point; no suite or several suites with both; several points of a
/// controller under the same conditions, so that the name is ambiguous; or no common world.
ComparedPoints compare_points(const fs::path& store, const std::string& a, const std::string& b,
                              const std::string& suite, const std::vector<ComparedMetric>& metrics);

}  // namespace moma::run
