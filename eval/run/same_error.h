#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "eval/trial/row.h"

namespace moma::run {

/// Finds points of a suite that cannot work: all of their trials end by the same error.
class SameError {
 public:
  /// Number of a point's first trials that suffice as evidence.
  static constexpr int kEnough = 20;

  /// Takes rows in the order of the jobs, so that the answer is the same for any number of threads.
  void look(std::size_t point, const TrialRow& row);
  struct Found {
    std::size_t point = 0;
    int trials = 0;
    std::string reason;
  };
  /// Returns the point with most such trials; nothing if there is none.
  const Found* found() const;
  /// True if a point has enough such trials.
  bool enough() const { return found() != nullptr && found()->trials >= kEnough; }

 private:
  std::map<std::size_t, Found> failing_;  // points without another outcome or reason so far
  std::set<std::size_t> working_;
};

}  // namespace moma::run
