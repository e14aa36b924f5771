#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>

#include "controller/describe/enumeration.h"
#include "controller/part_clock.h"
#include "world/plant/plant_clock.h"

namespace moma {

/// Parts that the time of a trial is told apart by, in the order of tables. A controller that is not moma's own is
/// kController as a whole.
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
static_assert(all_worded<TrialPart>());

/// Where the wall time of trials went. Never part of a row, a key or a comparison.
struct Profile {
  static constexpr std::size_t kParts = words(Of<TrialPart>{}).size();
  struct Share {
    std::int64_t nanoseconds = 0;
    std::int64_t entries = 0;  ///< how often the part began: the same in every run
  };
  std::array<Share, kParts> parts{};
  std::int64_t trials = 0;
  std::int64_t steps = 0;  ///< of control

  Share& operator[](TrialPart part) { return parts[static_cast<std::size_t>(part)]; }
  const Share& operator[](TrialPart part) const { return parts[static_cast<std::size_t>(part)]; }
  Profile& operator+=(const Profile& more);
  std::int64_t nanoseconds() const;  ///< of all parts
};

/// Tells the time of one thread's work apart by its parts: every moment from construction to stop() belongs to exactly
/// one. One look at the steady clock (some 40 ns) for each border.
class ProfileClock final : public StepClock, public PlantClock {
 public:
  explicit ProfileClock(TrialPart first);

  void enter(TrialPart part) noexcept;
  void enter(StepPart part) noexcept override;
  void enter(PlantPart part) noexcept override;

  /// The last part ends; the times so far. Trials and steps are for whoever knows them to fill in.
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
