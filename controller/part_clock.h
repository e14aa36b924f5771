#pragma once

namespace moma {

/// Interface of a profile: it is called at the changes between parts of work, and may read a clock then. The worker
/// holds a pointer, null by default, which costs a branch per change. No result depends on it.
template <class Part>
class PartClock {
 public:
  virtual ~PartClock() = default;
  /// Starts a part, which lasts until the next call. Must neither allocate nor lock.
  virtual void enter(Part part) noexcept = 0;
};

/// Parts of moma's own control step.
enum class StepPart {
  kRest,        ///< checking and predicting observations, writing results
  kKinematics,  ///< poses, Jacobian, error, manipulability
  kDistances,   ///< distances to objects, the floor and the robot itself
  kRows,        ///< posing the QP, with detours; bounds
  kSolve,       ///< the QP with its fallbacks, or the closed form
  kSafety,      ///< check ahead and evasion
  kAhead,       ///< predictions and plans
};

using StepClock = PartClock<StepPart>;

template <class Part>
void enter(PartClock<Part>* clock, Part part) noexcept {
  if (clock != nullptr) clock->enter(part);
}

}  // namespace moma
