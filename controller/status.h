#pragma once

#include <array>
#include <string_view>

#include "controller/describe/enumeration.h"

namespace moma {

enum class StepStatus { kSolved, kInfeasible, kMaxIterations, kInvalidInput };
constexpr auto words(Of<StepStatus>) {
  return std::to_array<std::string_view>({"solved", "infeasible", "max_iterations", "invalid_input"});
}

enum class Fallback { kNone, kNoAcceleration, kRelaxed, kBrake };
constexpr auto words(Of<Fallback>) {
  return std::to_array<std::string_view>({"none", "no_acceleration", "relaxed", "brake"});
}

}  // namespace moma
