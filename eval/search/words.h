#pragma once

#include <array>
#include <string_view>

#include "controller/describe/enumeration.h"

// Enumerations of a search in the store's columns, whose checks are generated from these words.

namespace moma::tune {

enum class SearchStatus { kRunning, kFinished, kStopped };
constexpr auto words(Of<SearchStatus>) { return std::to_array<std::string_view>({"running", "finished", "stopped"}); }
static_assert(all_worded<SearchStatus>());

/// Mapping of a variable to the unit interval.
enum class Scale { kLinear, kLog, kInteger };
constexpr auto words(Of<Scale>) { return std::to_array<std::string_view>({"linear", "log", "integer"}); }
static_assert(all_worded<Scale>());

enum class Phase { kStart, kGlobal, kLocal, kConfirm, kNeighbour, kSensitivity };
constexpr auto words(Of<Phase>) {
  return std::to_array<std::string_view>({"start", "global", "local", "confirm", "neighbour", "sensitivity"});
}
static_assert(all_worded<Phase>());

/// Verdict on the found gains against others.
enum class Verdict { kBetter, kNoDifference, kWorse };
constexpr auto words(Of<Verdict>) {
  return std::to_array<std::string_view>({"better", "no difference shown", "worse"});
}
static_assert(all_worded<Verdict>());

}  // namespace moma::tune
