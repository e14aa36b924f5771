#include "eval/trial/profile.h"

#include <numeric>

namespace moma {
namespace {

// In the order of StepPart and of PlantPart.
constexpr std::array kPartsOfStep{TrialPart::kController, TrialPart::kKinematics, TrialPart::kDistances,
                                  TrialPart::kRows,       TrialPart::kSolve,      TrialPart::kSafety,
                                  TrialPart::kAhead};
constexpr std::array kPartsOfPlant{TrialPart::kPlant, TrialPart::kCollide, TrialPart::kStep};

}  // namespace

Profile& Profile::operator+=(const Profile& more) {
  for (std::size_t i = 0; i < kParts; ++i) {
    parts[i].nanoseconds += more.parts[i].nanoseconds;
    parts[i].entries += more.parts[i].entries;
  }
  trials += more.trials;
  steps += more.steps;
  return *this;
}

std::int64_t Profile::nanoseconds() const {
  return std::accumulate(parts.begin(), parts.end(), std::int64_t{0},
                         [](std::int64_t sum, const Share& share) { return sum + share.nanoseconds; });
}

ProfileClock::ProfileClock(TrialPart first) : part_(first), since_(Clock::now()) { profile_[first].entries = 1; }

void ProfileClock::enter(TrialPart part) noexcept {
  stop();
  part_ = part;
  ++profile_[part].entries;
}

void ProfileClock::enter(StepPart part) noexcept { enter(kPartsOfStep[static_cast<std::size_t>(part)]); }
void ProfileClock::enter(PlantPart part) noexcept { enter(kPartsOfPlant[static_cast<std::size_t>(part)]); }

const Profile& ProfileClock::stop() noexcept {
  const Clock::time_point now = Clock::now();
  profile_[part_].nanoseconds += std::chrono::duration_cast<std::chrono::nanoseconds>(now - since_).count();
  since_ = now;
  return profile_;
}

}  // namespace moma
