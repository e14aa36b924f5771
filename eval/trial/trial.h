#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "controller/step.h"
#include "eval/trial/metrics.h"
#include "eval/trial/profile.h"
#include "eval/trial/row.h"
#include "eval/trial/spec.h"
#include "world/world.h"

namespace moma {

struct TrialOutput {
  TrialRow row;
  Trace trace;  ///< one sample per control step
};

/// Parts that stand in for the usual ones: another plant, a user's own controller. Empty: make_plant(),
/// make_controller().
struct TrialParts {
  std::function<std::unique_ptr<Plant>(const TrialSpec&, const World&)> plant;
  std::function<std::unique_ptr<StepController>(const TrialSpec&)> controller;
};

/// Simulates one trial of `spec` in `world` and measures it. Deterministic but for row.timing. Throws no more
/// than std::bad_alloc: other exceptions of any part become Outcome::kError with their text. `clock`, where there is
/// one, is told of its parts, kSetUp first and kMetrics last.
TrialOutput run_trial(const TrialSpec& spec, const World& world, const TrialParts& parts = {},
                      ProfileClock* clock = nullptr);

/// The plant that `spec` asks for. Throws what make_plant() throws.
std::unique_ptr<Plant> usual_plant(const TrialSpec& spec, const World& world);

/// Runs a part of a trial. The row of an error where it throws anything but std::bad_alloc, which passes: what was
/// measured until then is kept.
std::optional<TrialRow> error_of(const TrialSpec& spec, const Recording& recording, const std::function<void()>& part);

/// Makes the plant that `spec` asks for and throws what that throws: a robot that lacks what its mode of simulation
/// needs fails in every world by the same words.
void check_plant(const TrialSpec& spec);

/// Raised by hand whenever rows change for the same inputs; a golden test notices.
inline constexpr int kSimulationVersion = 10;

}  // namespace moma
