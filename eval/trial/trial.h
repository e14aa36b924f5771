#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "controller/step.h"
#include "eval/suite/suite.h"
#include "eval/trial/row.h"
#include "world/world.h"

namespace moma {

struct TrialOutput {
  TrialRow row;
  Trace trace;  ///< one sample per control step
};

/// Parts that stand in for the usual ones: another plant, a user's own controller. Empty: make_plant(),
/// make_controller().
struct TrialParts {
  std::function<std::unique_ptr<Plant>(const Point&, const World&)> plant;
  std::function<std::unique_ptr<StepController>(const Point&)> controller;
};

/// Simulates one trial of `point` in `world` and measures it. Deterministic but for row.timing. Never throws:
/// an exception from any part becomes Outcome::kError with its text.
TrialOutput run_trial(const Point& point, const World& world, const TrialParts& parts = {});

/// 32 hex digits: XXH3-128 of everything resolved that decides the row (see kSimulationVersion).
std::string trial_key(const Point& point, std::uint64_t world_index);

/// Raised by hand whenever rows change for the same inputs; a golden test notices.
inline constexpr int kSimulationVersion = 3;

}  // namespace moma
