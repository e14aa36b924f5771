#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "eval/run/named_point.h"
#include "eval/stats/comparison.h"

namespace moma::run {

/// A metric that two sides are compared in.
struct ComparedMetric {
  std::string name;
  std::string a;  ///< SQL over a row `ta` of trial
  std::string b;  ///< the same over `tb`
};

/// B against A on the worlds that both met.
struct ComparedPoints {
  std::string suite;
  std::vector<std::pair<NamedPoint, NamedPoint>> pairs;  ///< more than one where controllers were named
  bool same_conditions = true;  ///< of each pair: params beside gains are equal (disturbances, robot, worlds)
  stats::Comparison comparison;
};

/// Compares what two names stand for. A name of one point (named_points()) is that point. A controller's name of which
/// no point goes by it alone means all its points, each paired with the other side's point under the same conditions.
/// Throws StoreError{kNotFound}: no such point; no suite or several that have both; several points of a controller
/// under the same conditions, of which one has to be chosen; no world that both met.
ComparedPoints compare_points(const std::filesystem::path& store, const std::string& a, const std::string& b,
                              const std::string& suite, const std::vector<ComparedMetric>& metrics);

}  // namespace moma::run
