#pragma once

#include <cstddef>
#include <cstdint>

namespace moma {

/// Random numbers as a pure function of key and number of the draw: SplitMix64, whose state is a counter (Steele, Lea &
/// Flood, OOPSLA 2014).
struct CountedDraws {
  std::uint64_t key = 0;
  std::uint64_t drawn = 0;

  std::uint64_t bits() noexcept {
    constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15u;
    std::uint64_t z = (key + 1) * 0xd1342543de82ef95u + ++drawn * kGolden;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() noexcept { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  /// Uniform in 0 .. count - 1; count >= 1.
  std::size_t choice(std::size_t count) noexcept {
    return static_cast<std::size_t>(uniform() * static_cast<double>(count));
  }
};

}  // namespace moma
