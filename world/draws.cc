#include "world/draws.h"

#include <Random123/philox.h>

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

namespace moma {
namespace {

double to_unit(std::uint64_t word) { return static_cast<double>(word >> 11) * 0x1p-53; }

/// In (0, 1).
double open_unit(std::uint64_t word) { return (static_cast<double>(word >> 11) + 0.5) * 0x1p-53; }

double normal_of(std::uint64_t word) { return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * open_unit(word)); }

std::uint64_t step(std::uint64_t word, double scale, std::uint64_t noise) {
  const double z = std::sqrt(1.0 - scale * scale) * normal_of(word) + scale * normal_of(noise);
  const double u = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  return static_cast<std::uint64_t>(std::min(u, 1.0 - 0x1p-53) * 0x1p53) << 11;
}

using Generator = r123::Philox4x64;

/// Beside any stream: the draws of moves.
constexpr std::uint64_t kOfMoves = 0x6d6f766500ULL;

}  // namespace

Draws::Draws(std::uint64_t seed, std::uint64_t index, Stream stream, std::uint64_t attempt, std::uint64_t item,
             const Moves* moves)
    : seed_(seed),
      index_(index),
      stream_(static_cast<std::uint64_t>(stream)),
      attempt_(attempt),
      item_(item),
      moves_(moves) {}

Draws::Block Draws::next() {
  const Block block = after(moves_ == nullptr ? 0 : moves_->size());
  ++draw_;
  return block;
}

/// The block after the first `moves` moves. Looked at from the last one: what is drawn anew needs none before it.
Draws::Block Draws::after(std::size_t moves) const {
  const bool error = stream_ == static_cast<std::uint64_t>(Stream::kSensing) ||
                     stream_ == static_cast<std::uint64_t>(Stream::kDisturbance);
  const std::uint64_t bits = 1ULL << stream_ | (error && attempt_ == 0 ? Move::kConstantErrors : 0ULL);
  while (moves > 0) {
    const Move& move = (*moves_)[--moves];
    if ((move.mask & bits) == 0) continue;
    const Generator::ctr_type fresh = Generator()({{draw_, 0, attempt_, item_}}, {{move.id, kOfMoves + stream_}});
    if (open_unit(fresh[0]) >= move.fraction) continue;
    if (move.scale >= 1.0) return {{fresh[1], fresh[2], 0, 0}};
    const Block before = after(moves);
    return {{step(before.word[0], move.scale, fresh[1]), step(before.word[1], move.scale, fresh[2]), 0, 0}};
  }
  const Generator::ctr_type out = Generator()({{draw_, index_, attempt_, item_}}, {{seed_, stream_}});
  return {{out[0], out[1], out[2], out[3]}};
}

std::uint64_t Draws::bits() { return next().word[0]; }

double Draws::uniform() { return to_unit(next().word[0]); }

double Draws::uniform(double low, double high) { return std::min(low + (high - low) * uniform(), high); }

double Draws::log_uniform(double low, double high) {
  const double u = uniform();
  return std::clamp(low * std::exp(u * std::log(high / low)), low, high);
}

double Draws::normal(double mean, double sigma) {
  const Block block = next();
  // 1 - u is in (0, 1], so that the logarithm is finite.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - to_unit(block.word[0])));
  return mean + sigma * radius * std::cos(2.0 * std::numbers::pi * to_unit(block.word[1]));
}

std::size_t Draws::choice(std::size_t count) {
  const auto picked = static_cast<std::size_t>(uniform() * static_cast<double>(count));
  return std::min(picked, count - 1);
}

}  // namespace moma
