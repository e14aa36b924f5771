#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "eval/search/variables.h"
#include "eval/search/words.h"

namespace moma::tune {

/// One candidate met by the search, in order.
struct Evaluation {
  std::uint64_t index = 0;
  Phase phase = Phase::kStart;
  int run = 0;  ///< number of the NLopt run, from 0
  Candidate candidate;
  std::size_t first = 0;            ///< worlds already known before, of the search's shuffled order
  std::vector<double> measured;     ///< what was new: worlds x (cost, constraints)
  std::size_t worlds = 0;           ///< known after it
  bool cut = false;                 ///< clearly worse than the best: stopped before the last world
  bool valid = true;                ///< false: its values contradict each other; not measured, cut with no world
  double cost = 0.0;                ///< mean over the known worlds
  std::vector<double> constraints;  ///< means likewise
  /// Cost plus penalty for violated constraints. Of a cut candidate: the best's cost plus the mean difference to it
  /// on the worlds met, plus the penalty. Of one that is not valid: the worst merit so far.
  double merit = 0.0;
  bool operator==(const Evaluation&) const = default;
};

/// What a log keeps of an evaluation, and gives back when a search is resumed: NLopt has no checkpoint, so a
/// resumed search runs NLopt again from its start and answers from here until it comes to new ground.
class EvaluationLog {
 public:
  virtual ~EvaluationLog() = default;
  /// The evaluation stored under this index, or none.
  virtual std::optional<Evaluation> find(std::uint64_t index) = 0;
  virtual void append(const Evaluation& evaluation) = 0;
};

/// A stored evaluation is not the one that the search comes to: another version of the program or of NLopt.
class ReplayError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace moma::tune
