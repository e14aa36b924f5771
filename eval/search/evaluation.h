#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "eval/search/variables.h"

namespace moma::tune {

/// The evaluation of one candidate, in the search's order.
struct Evaluation {
  std::uint64_t index = 0;
  Phase phase = Phase::kStart;
  int run = 0;  ///< number of the NLopt run, from 0
  Candidate candidate;
  std::size_t first = 0;            ///< number of worlds known before, in the search's shuffled order
  std::vector<double> measured;     ///< new measurements: worlds x (cost, constraints)
  std::size_t worlds = 0;           ///< number of worlds known afterwards
  bool cut = false;                 ///< stopped before the last world, because clearly worse than the best
  bool valid = true;                ///< false: contradictory values; not measured, cut with no world
  double cost = 0.0;                ///< mean over the known worlds
  std::vector<double> constraints;  ///< means over the known worlds
  /// Cost plus penalty for violated constraints. For a cut candidate: the best's cost plus the mean difference to it on
  /// the common worlds, plus the penalty. For an invalid candidate: the worst merit so far.
  double merit = 0.0;

  /// False for measurements around what was found.
  bool searching() const { return phase == Phase::kStart || phase == Phase::kGlobal || phase == Phase::kLocal; }
  bool operator==(const Evaluation&) const = default;
};

/// A log of evaluations for resumption. NLopt has no checkpoint: a resumed search runs NLopt again from its start and
/// answers from the log until it reaches new candidates.
class EvaluationLog {
 public:
  virtual ~EvaluationLog() = default;
  /// Returns the stored evaluation with this index, or nothing.
  virtual std::optional<Evaluation> find(std::uint64_t index) = 0;
  virtual void append(const Evaluation& evaluation) = 0;
};

/// A stored evaluation differs from the search's: another version of the program or of NLopt wrote it.
class ReplayError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace moma::tune
