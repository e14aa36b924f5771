#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "eval/search/variables.h"

namespace moma::tune {

/// What is minimised: a candidate measured in chosen worlds. Must be a pure function of (candidate, world).
class Objective {
 public:
  virtual ~Objective() = default;
  /// Numbers per world: the cost, then one value per constraint.
  virtual std::size_t width() const = 0;
  /// False where the values contradict each other (a stop distance beyond the influence distance): such a candidate
  /// is not measured and counts as worse than all.
  virtual bool valid(const Candidate& /*candidate*/) { return true; }
  /// worlds.size() x width() finite numbers, world by world. May throw Interrupted.
  virtual std::vector<double> measure(const Candidate& candidate, std::span<const std::uint64_t> worlds) = 0;
};

/// Thrown by an objective that was asked to stop (Ctrl-C), or with a text that could not measure now. What was logged
/// stays; the search can be resumed.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The mean over worlds of value k must be at most `at_most`; or at most what the start has in the same worlds. What
/// breaks the latter counts as no better than the start, whatever its cost.
struct Constraint {
  std::string name;
  double at_most = 0.0;
  bool of_start = false;  ///< Evaluation::constraints has the mean difference to the start, `at_most` is 0
};

}  // namespace moma::tune
