#include "world/draws.h"

#include <Random123/philox.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moma {
namespace {

double to_unit(std::uint64_t word) { return static_cast<double>(word >> 11) * 0x1p-53; }

}  // namespace

Draws::Draws(std::uint64_t seed, std::uint64_t index, Stream stream, std::uint64_t attempt, std::uint64_t item)
    : seed_(seed), index_(index), stream_(static_cast<std::uint64_t>(stream)), attempt_(attempt), item_(item) {}

Draws::Block Draws::next() {
  using Generator = r123::Philox4x64;
  const Generator::ctr_type counter = {{draw_++, index_, attempt_, item_}};
  const Generator::key_type key = {{seed_, stream_}};
  const Generator::ctr_type out = Generator()(counter, key);
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
