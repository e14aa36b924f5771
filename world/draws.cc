#include "world/draws.h"

#include <Random123/philox.h>

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

namespace moma {
namespace {

double to_unit(std::uint64_t word) { return static_cast<double>(word >> 11) * 0x1p-53; }

/// Uniform in (0, 1).
double open_unit(std::uint64_t word) { return (static_cast<double>(word >> 11) + 0.5) * 0x1p-53; }

double normal_of(std::uint64_t word) { return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * open_unit(word)); }

std::uint64_t step(std::uint64_t word, double scale, std::uint64_t noise) {
  const double z = std::sqrt(1.0 - scale * scale) * normal_of(word) + scale * normal_of(noise);
  const double u = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  return static_cast<std::uint64_t>(std::min(u, 1.0 - 0x1p-53) * 0x1p53) << 11;
}

using Generator = r123::Philox4x64;

/// Key of the draws of moves, apart from all streams.
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

/// Returns the block after the first `moves` moves. Searches backwards for the last move that replaces the draw:
/// earlier moves do not matter then.
Draws::Block Draws::after(std::size_t moves) const {
  const auto original = [this] {
    const Generator::ctr_type out = Generator()({{draw_, index_, attempt_, item_}}, {{seed_, stream_}});
    return Block{{out[0], out[1], out[2], out[3]}};
  };
  if (moves == 0) return original();
  const bool error = stream_ == static_cast<std::uint64_t>(Stream::kSensing) ||
                     stream_ == static_cast<std::uint64_t>(Stream::kDisturbance);
  const std::uint64_t bits = 1ULL << stream_ | (error && attempt_ == 0 ? Move::kConstantErrors : 0ULL);
  // The move's own block for this draw; its first word decides whether the move applies.
  const auto of = [&](const Move& move) {
    return Generator()({{draw_, 0, attempt_, item_}}, {{move.id, kOfMoves + stream_}});
  };
  const auto moved = [&](const Move& move, const Generator::ctr_type& fresh) {
    return open_unit(fresh[0]) < move.fraction;
  };
  Generator::ctr_type out{};
  std::size_t first = moves;
  for (; first > 0; --first) {
    const Move& move = (*moves_)[first - 1];
    if (move.scale < 1.0 || (move.mask & bits) == 0) continue;
    out = of(move);
    if (moved(move, out)) break;
  }
  Block block = first > 0 ? Block{{out[1], out[2], 0, 0}} : Block{};
  if (first == 0) block = original();
  for (std::size_t i = first; i < moves; ++i) {
    const Move& move = (*moves_)[i];
    if (move.scale >= 1.0 || (move.mask & bits) == 0) continue;
    const Generator::ctr_type fresh = of(move);
    if (!moved(move, fresh)) continue;
    for (std::size_t w = 0; w < 2; ++w) block.word[w] = step(block.word[w], move.scale, fresh[w + 1]);
  }
  return block;
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
