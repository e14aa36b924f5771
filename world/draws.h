#pragma once

#include <cstddef>
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

/// Moves in the order of application.
using Moves = std::vector<Move>;

/// Purpose of a stream of draws. A new draw in one stream never shifts another. The values are part of a seed's
/// meaning: never renumber them.
enum class Stream : std::uint64_t {
  kStart = 1,
  kGoal = 2,
  kObjects = 3,
  kMotion = 4,
  kSensing = 5,
  kDisturbance = 6,
  kDesign = 7,
  kCrossCheck = 8,
  kTimeBound = 9
};

/// Random numbers as a pure function of (seed, index, stream, attempt, item, number of the draw): Philox4x64-10 of
/// Random123 (Salmon et al., SC 2011) with key (seed, stream) and counter (draw, index, attempt, item). Every call
/// consumes exactly one block: replacing a fixed number by a distribution shifts no other draw. Uniforms are exact on
/// every machine; log_uniform() and normal() use libm and are the same for the same libm.
class Draws {
 public:
  /// `moves` change the numbers and must outlive this object; null equals empty.
  Draws(std::uint64_t seed, std::uint64_t index, Stream stream, std::uint64_t attempt = 0, std::uint64_t item = 0,
        const Moves* moves = nullptr);

  std::uint64_t bits();
  /// Uniform in [0, 1): a multiple of 2^-53.
  double uniform();
  /// Uniform in [low, high]; low <= high.
  double uniform(double low, double high);
  /// Log-uniform: the logarithm is uniform in [log low, log high]; 0 < low <= high. Result inside [low, high].
  double log_uniform(double low, double high);
  /// Normal, by Box-Muller of the block's first two words; sigma >= 0.
  double normal(double mean, double sigma);
  /// Uniform in 0 .. count - 1; count >= 1.
  std::size_t choice(std::size_t count);

 private:
  struct Block {
    std::uint64_t word[4];
  };
  Block next();
  Block after(std::size_t moves) const;

  std::uint64_t seed_, index_, stream_, attempt_, item_;
  const Moves* moves_;
  std::uint64_t draw_ = 0;
};

}  // namespace moma
