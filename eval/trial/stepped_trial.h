#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "eval/trial/loop.h"
#include "eval/trial/trial.h"

namespace moma {

/// A trial that its caller steps: the caller reads the observation and gives one command per control period, at any
/// time. The result equals that of run_trial() with a controller of the same commands, bit for bit. The row lacks the
/// quantities of moma's own controllers (slack, rows of the QP, latencies), as with a plugin.
class SteppedTrial {
 public:
  /// Starts the motion. An exception of the plant ends the trial at once as Outcome::kError.
  SteppedTrial(std::shared_ptr<const TrialSpec> spec, World world);
  SteppedTrial(const SteppedTrial&) = delete;
  SteppedTrial& operator=(const SteppedTrial&) = delete;

  const TrialSpec& spec() const noexcept { return *spec_; }
  const World& world() const noexcept { return world_; }
  /// The objects that a controller knows: the world's objects, then false ones. Empty after an error at the start.
  std::span<const ObjectShape> objects() const noexcept;
  bool ended() const noexcept { return row_.has_value(); }
  /// The present observation, including that of the final state. If the final state is not finite, or after an
  /// exception: the one before.
  const Observation& seen() const noexcept;
  /// The present true state; unchanged after an error at the start.
  void truth(Observation& out) const;
  /// Measurements of the present true state; nullptr if it is not finite.
  const StateRecord* state() const noexcept;
  /// Least distance to an object so far [m]; NaN without objects.
  double clearance() const noexcept { return recording_.row.clearance_min_m; }

  /// Takes a control step; no effect after the end. The command of `answer` is scaled into the robot's velocity limits
  /// as a whole; status, fallback, slack, least_distance and active_rows are recorded. A command of the wrong size or
  /// with a number that is not finite, and exceptions of the plant, end the trial as Outcome::kError.
  void step(const StepResult& answer);

  /// Outcome of a trial that has ended. Throws std::logic_error before.
  Outcome outcome() const;
  TrialOutput output() const;

 private:
  void guarded(const std::function<void()>& part);
  void go_on();

  std::shared_ptr<const TrialSpec> spec_;
  World world_;
  VectorX limits_;
  Recording recording_;
  std::unique_ptr<Plant> plant_;
  std::unique_ptr<TrialLoop> loop_;
  Observation nothing_;
  std::optional<TrialRow> row_;
};

}  // namespace moma
