#pragma once

#include <array>
#include <string_view>

#include "controller/describe/enumeration.h"

// Words of a search that stand in columns of the store, whose checks are made from them.

namespace moma::tune {

/// Of a search.
enum class SearchStatus { kRunning, kFinished, kStopped };
constexpr auto words(Of<SearchStatus>) { return std::to_array<std::string_view>({"running", "finished", "stopped"}); }
static_assert(all_worded<SearchStatus>());

/// How a variable is spread over the unit interval.
enum class Scale { kLinear, kLog, kInteger };
constexpr auto words(Of<Scale>) { return std::to_array<std::string_view>({"linear", "log", "integer"}); }
static_assert(all_worded<Scale>());

/// What a candidate was measured for.
enum class Phase { kStart, kGlobal, kLocal, kConfirm, kNeighbour, kSensitivity };
constexpr auto words(Of<Phase>) {
  return std::to_array<std::string_view>({"start", "global", "local", "confirm", "neighbour", "sensitivity"});
}
static_assert(all_worded<Phase>());

/// Of the found gains against other ones.
enum class Verdict { kBetter, kNoDifference, kWorse };
constexpr auto words(Of<Verdict>) {
  return std::to_array<std::string_view>({"better", "no difference shown", "worse"});
}
static_assert(all_worded<Verdict>());

}  // namespace moma::tune
