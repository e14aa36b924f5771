#pragma once

#include <cstdint>
#include <vector>

namespace moma {

/// A change of a world's random numbers that keeps their law: each uniform of the streams in `mask` is moved with the
/// probability `fraction`, by a preconditioned Crank-Nicolson step of its normal quantile,
///   z' = sqrt(1 - scale^2) z + scale xi,
/// which is the same as drawing it anew where `scale` is 1. What is moved and by what is a pure function of (id,
/// stream, attempt, item, number of the draw), so that a world after any number of moves is known by its index and
/// their list. Source: Cotter, Roberts, Stuart & White, Statistical Science 28(3), 2013.
struct Move {
  std::uint64_t id = 0;    ///< below 2^53: a number of a JSON file
  double scale = 1.0;      ///< in (0, 1]
  double fraction = 1.0;   ///< in (0, 1]
  std::uint32_t mask = 0;  ///< bits 1 << Stream, and kConstantErrors

  /// In `mask`: of the streams of sensing and disturbance what is drawn at step 0, constant errors among it.
  static constexpr std::uint32_t kConstantErrors = 1U;
};

/// In the order in which they are applied.
using Moves = std::vector<Move>;

}  // namespace moma
