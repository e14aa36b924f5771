#pragma once

#include <memory>

#include "controller/step.h"
#include "eval/suite/suite.h"
#include "eval/trial/row.h"
#include "world/world.h"

namespace moma {

struct TrialOutput {
  TrialRow row;
  Trace trace;   ///< one sample per control step
};

/// Simulates one trial of `point` in `world` and measures it. Deterministic but for row.timing. Never throws:
/// an exception from any part becomes Outcome::kError with its text.
TrialOutput run_trial(const Point& point, const World& world);

/// 32 hex digits: XXH3-128 of everything resolved that decides the row (see kSimulationVersion).
std::string trial_key(const Point& point, std::uint64_t world_index);

/// Raised by hand whenever rows change for the same inputs; a golden test notices.
inline constexpr int kSimulationVersion = 1;

}  // namespace moma
