#pragma once

#include <cstdint>
#include <vector>

namespace moma {

/// A change of a world's random numbers that preserves their distribution. Each uniform of the streams in `mask` moves
/// with the probability `fraction`, by a preconditioned Crank-Nicolson step of its normal quantile,
///   z' = sqrt(1 - scale^2) z + scale xi,
/// which draws it anew if `scale` is 1. All choices are a pure function of (id, stream, attempt, item, number of the
/// draw), so that index and list of moves identify a moved world. Source: Cotter, Roberts, Stuart & White, Statistical
/// Science 28(3), 2013.
struct Move {
  std::uint64_t id = 0;    ///< below 2^53, the exact integers of a JSON file
  double scale = 1.0;      ///< in (0, 1]
  double fraction = 1.0;   ///< in (0, 1]
  std::uint32_t mask = 0;  ///< bits 1 << Stream, and kConstantErrors

  /// Bit of `mask`: the draws of sensing and disturbance streams at step 0, which include constant errors.
  static constexpr std::uint32_t kConstantErrors = 1U;
};

/// In the order of application.
using Moves = std::vector<Move>;

}  // namespace moma
