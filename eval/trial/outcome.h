#pragma once

#include <array>
#include <string_view>

#include "controller/describe/enumeration.h"

namespace moma {

enum class Outcome { kSuccess, kCollision, kTimeout, kStuck, kJointLimit, kTipped, kInfeasible, kDiverged, kError };
constexpr auto words(Of<Outcome>) {
  return std::to_array<std::string_view>(
      {"success", "collision", "timeout", "stuck", "joint_limit", "tipped", "infeasible", "diverged", "error"});
}
static_assert(all_worded<Outcome>());

}  // namespace moma
