#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>

#include "controller/describe/enumeration.h"
#include "controller/part_clock.h"
#include "world/plant/plant.h"

namespace moma {

/// Parts of a trial's time, in the order of tables. A foreign controller is kController as a whole.
enum class TrialPart {
  kWorld,
  kSetUp,
  kSensing,
  kController,
  kKinematics,
  kDistances,
  kRows,
  kSolve,
  kSafety,
  kAhead,
  kPlant,
  kCollide,
  kStep,
  kMetrics,
  kStore
};
constexpr auto words(Of<TrialPart>) {
  return std::to_array<std::string_view>({"world", "set-up", "sensing", "controller, rest", "kinematics", "distances",
                                          "rows", "solve", "safety", "look-ahead", "plant, rest", "ODE collide",
                                          "ODE step", "metrics", "store"});
}

/// Wall time of trials by parts. Never a part of a row, a key or a comparison.
struct Profile {
  static constexpr std::size_t kParts = words(Of<TrialPart>{}).size();
  struct Share {
    std::int64_t nanoseconds = 0;
    std::int64_t entries = 0;  ///< number of times that the part began: the same in every run
  };
  std::array<Share, kParts> parts{};
  std::int64_t trials = 0;
  std::int64_t steps = 0;  ///< control steps

  Share& operator[](TrialPart part) { return parts[static_cast<std::size_t>(part)]; }
  const Share& operator[](TrialPart part) const { return parts[static_cast<std::size_t>(part)]; }
  Profile& operator+=(const Profile& more);
  std::int64_t nanoseconds() const;  ///< sum of all parts
};

/// Measures the parts of one thread's work: every moment from construction to stop() belongs to exactly one part. Reads
/// the steady clock once (some 40 ns) per change of parts.
class ProfileClock final : public StepClock, public PlantClock {
 public:
  explicit ProfileClock(TrialPart first);

  void enter(TrialPart part) noexcept;
  void enter(StepPart part) noexcept override;
  void enter(PlantPart part) noexcept override;

  /// Ends the last part and returns the times so far. The caller fills in trials and steps.
  const Profile& stop() noexcept;

 private:
  using Clock = std::chrono::steady_clock;
  Profile profile_;
  TrialPart part_;
  Clock::time_point since_;
};

inline void enter(ProfileClock* clock, TrialPart part) noexcept {
  if (clock != nullptr) clock->enter(part);
}

}  // namespace moma
