#include "eval/trial/profile.h"

#include <numeric>

namespace moma {
namespace {

TrialPart part_of(StepPart part) noexcept {
  switch (part) {
    case StepPart::kRest:
      return TrialPart::kController;
    case StepPart::kKinematics:
      return TrialPart::kKinematics;
    case StepPart::kDistances:
      return TrialPart::kDistances;
    case StepPart::kRows:
      return TrialPart::kRows;
    case StepPart::kSolve:
      return TrialPart::kSolve;
    case StepPart::kSafety:
      return TrialPart::kSafety;
    case StepPart::kAhead:
      return TrialPart::kAhead;
  }
  return TrialPart::kController;
}

TrialPart part_of(PlantPart part) noexcept {
  switch (part) {
    case PlantPart::kRest:
      return TrialPart::kPlant;
    case PlantPart::kCollide:
      return TrialPart::kCollide;
    case PlantPart::kStep:
      return TrialPart::kStep;
  }
  return TrialPart::kPlant;
}

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

void ProfileClock::enter(StepPart part) noexcept { enter(part_of(part)); }
void ProfileClock::enter(PlantPart part) noexcept { enter(part_of(part)); }

const Profile& ProfileClock::stop() noexcept {
  const Clock::time_point now = Clock::now();
  profile_[part_].nanoseconds += std::chrono::duration_cast<std::chrono::nanoseconds>(now - since_).count();
  since_ = now;
  return profile_;
}

}  // namespace moma
