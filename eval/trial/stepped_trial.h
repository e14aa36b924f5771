#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "eval/trial/clock.h"
#include "eval/trial/trial.h"

namespace moma {

/// A trial whose controller is somewhere else: whoever holds it looks at what is seen and answers with commands, one a
/// control period, whenever it likes. The trial is that of run_trial() with a controller that answers the same, bit for
/// bit; what only moma's own controllers have to say (slack, rows of the QP, latencies) is absent in its row, as it is
/// with a plugin.
class SteppedTrial {
 public:
  /// The motion begins. An exception of the plant ends the trial at once as Outcome::kError.
  SteppedTrial(std::shared_ptr<const TrialSpec> spec, World world);
  SteppedTrial(const SteppedTrial&) = delete;
  SteppedTrial& operator=(const SteppedTrial&) = delete;

  const TrialSpec& spec() const noexcept { return *spec_; }
  const World& world() const noexcept { return world_; }
  /// What a controller is told of: the world's objects, then those that are not there. Empty after an error at the
  /// start.
  std::span<const ObjectShape> objects() const noexcept;
  /// No further step is taken.
  bool ended() const noexcept { return row_.has_value(); }
  /// What is sensed now; the state in which the trial ended included, but where that is not finite or an exception
  /// ended it: then the one before.
  const Observation& seen() const noexcept;
  /// The truth now; left alone after an error at the start.
  void truth(Observation& out) const;
  /// What is measured of the true state now; nullptr where there was none that is finite.
  const StateRecord* state() const noexcept;
  /// Least distance to an object so far [m]; NaN without objects.
  double clearance() const noexcept { return recording_.clearance; }

  /// Takes a control step; without effect where the trial has ended. Of `answer`, the command is scaled into the
  /// robot's speeds as a whole; status, fallback, slack, least_distance and active_rows are recorded. A command of the
  /// wrong size or with a number that is not finite, and exceptions of the plant, end the trial as Outcome::kError.
  void step(const StepResult& answer);

  /// Of a trial that has ended, both. Throws std::logic_error before.
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
  std::unique_ptr<TickClock> clock_;
  Observation nothing_;
  std::optional<TrialRow> row_;
};

}  // namespace moma
