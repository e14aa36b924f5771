#include "eval/search/random.h"

#include <Random123/philox.h>

#include <utility>

namespace moma::tune {

std::uint64_t bits(std::uint64_t seed, SearchStream stream, std::uint64_t position) noexcept {
  r123::Philox4x64 generator;
  // The second key word separates these draws from those of the worlds, which use the same generator.
  const r123::Philox4x64::key_type key{{seed, 0x74756e65ULL}};
  const r123::Philox4x64::ctr_type counter{{position, static_cast<std::uint64_t>(stream), 0, 0}};
  return generator(counter, key)[0];
}

double uniform(std::uint64_t seed, SearchStream stream, std::uint64_t position) noexcept {
  return static_cast<double>(bits(seed, stream, position) >> 11) * 0x1p-53;
}

void shuffle(std::vector<std::uint64_t>& values, std::uint64_t seed, std::uint64_t part) {
  for (std::size_t i = values.size(); i > 1; --i) {
    const double u = uniform(seed, SearchStream::kShuffle, (part << 32) | i);
    std::swap(values[i - 1], values[static_cast<std::size_t>(u * static_cast<double>(i))]);
  }
}

}  // namespace moma::tune
