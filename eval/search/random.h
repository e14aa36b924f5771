#pragma once

#include <cstdint>
#include <vector>

namespace moma::tune {

/// Draws of a search: pure functions of (seed, stream, position), by Philox 4x64 (Random123).
enum class SearchStream : std::uint64_t { kShuffle = 1, kNlopt = 2, kStarts = 3, kNeighbours = 4 };

std::uint64_t bits(std::uint64_t seed, SearchStream stream, std::uint64_t position) noexcept;
/// Uniform in [0, 1), 53 bits.
double uniform(std::uint64_t seed, SearchStream stream, std::uint64_t position) noexcept;
/// Shuffles `values` (Fisher-Yates); `part` distinguishes several shuffles of one search.
void shuffle(std::vector<std::uint64_t>& values, std::uint64_t seed, std::uint64_t part);

}  // namespace moma::tune
