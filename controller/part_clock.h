#pragma once

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

using StepClock = PartClock<StepPart>;

template <class Part>
void enter(PartClock<Part>* clock, Part part) noexcept {
  if (clock != nullptr) clock->enter(part);
}

}  // namespace moma
