#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "eval/search/variables.h"

namespace moma::tune {

/// The objective to minimise: measures a candidate in chosen worlds. Must be a pure function of (candidate, world).
class Objective {
 public:
  virtual ~Objective() = default;
  /// Number of values per world: the cost, then one value per constraint.
  virtual std::size_t width() const = 0;
  /// False if the candidate's values contradict each other (a stop distance beyond the influence distance). Such a
  /// candidate is not measured and counts as worse than all others.
  virtual bool valid(const Candidate& /*candidate*/) { return true; }
  /// Returns worlds.size() x width() finite numbers, world by world. An exception ends the search; the log is kept, and
  /// the search can be resumed.
  virtual std::vector<double> measure(const Candidate& candidate, std::span<const std::uint64_t> worlds) = 0;
};

/// A bound on the mean over worlds of value k: at most `at_most`, or at most the start's mean on the same worlds. A
/// candidate that violates the latter counts as no better than the start, whatever its cost.
struct Constraint {
  std::string name;
  double at_most = 0.0;
  bool of_start = false;  ///< Evaluation::constraints has the mean difference to the start, and `at_most` is 0
};

}  // namespace moma::tune
