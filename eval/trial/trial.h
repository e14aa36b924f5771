#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "eval/trial/metrics.h"
#include "eval/trial/profile.h"
#include "eval/trial/row.h"
#include "eval/trial/spec.h"
#include "plugin/host/plugin.h"
#include "world/world.h"

namespace moma {

struct TrialOutput {
  TrialRow row;
  Trace trace;  ///< one sample per control step
};

/// Replacements of parts: another plant, a user's own controller. Empty: make_plant(), make_controller().
struct TrialParts {
  std::function<std::unique_ptr<Plant>(const TrialSpec&, const World&)> plant;
  std::function<std::unique_ptr<StepController>(const TrialSpec&)> controller;
};

/// Simulates one trial of `spec` in `world` and measures it. Deterministic except for row.timing. Throws only
/// std::bad_alloc: other exceptions of any part become Outcome::kError with their text. `clock`, if not null, is
/// notified of the parts, kSetUp first and kMetrics last.
TrialOutput run_trial(const TrialSpec& spec, const World& world, const TrialParts& parts = {},
                      ProfileClock* clock = nullptr);

/// Makes the controller of `spec`, timed by `clock`.
std::unique_ptr<StepController> usual_controller(const TrialSpec& spec, StepClock* clock = nullptr);

/// Makes the plant of `spec`. Throws as make_plant().
std::unique_ptr<Plant> usual_plant(const TrialSpec& spec, const World& world);

/// Runs a part of a trial. Returns the row of an error if it throws anything but std::bad_alloc, which passes; earlier
/// measurements are kept.
std::optional<TrialRow> error_of(const TrialSpec& spec, const Recording& recording, const std::function<void()>& part);

/// Makes the plant of `spec` to find errors: a robot that lacks data for its simulation mode fails in every world with
/// the same words.
void check_plant(const TrialSpec& spec);

/// Raised by hand whenever rows change for the same inputs; a golden test notices.
inline constexpr int kSimulationVersion = 39;

/// Returns the controller's parameters for a trial: the controller counts a goal as reached no further away than the
/// success rule does.
ControllerParams told_params(const TrialSpec& spec);

/// True if a trial ended because real time ran out. Such a row is not stored, and the trial is tried again.
inline bool is_late(const TrialRow& row) noexcept { return row.outcome == Outcome::kError && is_late(row.reason); }

}  // namespace moma
