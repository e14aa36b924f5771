#pragma once

#include <array>
#include <string_view>

#include "controller/describe/enumeration.h"

namespace moma {

/// Is told where the work goes from one part to the next, and may look at a clock then. Whoever works holds a pointer
/// to one, null by default: a border of parts costs a branch then. Nothing that is computed depends on it.
template <class Part>
class PartClock {
 public:
  virtual ~PartClock() = default;
  /// What follows is of this part, until the next call. Takes no memory, locks nothing.
  virtual void enter(Part part) noexcept = 0;
};

/// Parts of moma's own control step.
enum class StepPart {
  kRest,        ///< observations checked, predicted, results written
  kKinematics,  ///< poses, Jacobian, error, manipulability
  kDistances,   ///< to objects, the floor and the robot itself
  kRows,        ///< the QP posed, with detours; bounds
  kSolve,       ///< the QP with its fallbacks, or the closed form
  kSafety,      ///< whether the robot can still brake or get out of the way
  kAhead,       ///< predictions and plans
};
constexpr auto words(Of<StepPart>) {
  return std::to_array<std::string_view>({"rest", "kinematics", "distances", "rows", "solve", "safety", "ahead"});
}
static_assert(all_worded<StepPart>());

using StepClock = PartClock<StepPart>;

template <class Part>
void enter(PartClock<Part>* clock, Part part) noexcept {
  if (clock != nullptr) clock->enter(part);
}

}  // namespace moma
