#include "eval/trial/stepped_trial.h"

#include <stdexcept>
#include <utility>

#include "controller/closed_form/closed_form.h"

namespace moma {

SteppedTrial::SteppedTrial(std::shared_ptr<const TrialSpec> spec, World world)
    : spec_(std::move(spec)), world_(std::move(world)), limits_(spec_->robot->model->velocity_limits()) {
  guarded([&] {
    plant_ = usual_plant(*spec_, world_);
    clock_ = std::make_unique<TickClock>(*spec_, world_, *plant_, recording_);
    go_on();
  });
}

void SteppedTrial::guarded(const std::function<void()>& part) {
  if (std::optional<TrialRow> error = error_of(*spec_, recording_, part)) row_ = std::move(error);
}

void SteppedTrial::go_on() {
  if (clock_->sense()) return;
  row_ = clock_->finish();
  clock_->look_last();
}

std::span<const ObjectShape> SteppedTrial::objects() const noexcept {
  return clock_ ? clock_->objects() : std::span<const ObjectShape>();
}

const Observation& SteppedTrial::seen() const noexcept { return clock_ ? clock_->seen() : nothing_; }

void SteppedTrial::truth(Observation& out) const {
  if (clock_) clock_->truth(out);
}

const StateRecord* SteppedTrial::state() const noexcept {
  return recording_.states.empty() ? nullptr : &recording_.states.back();
}

void SteppedTrial::step(const StepResult& answer) {
  if (ended()) return;
  guarded([&] {
    StepResult& taken = clock_->answer();
    taken = answer;
    if (taken.command.size() == limits_.size() && taken.command.allFinite())
      scale_into_limits(*spec_->robot->model, limits_, taken.command);
    clock_->act(0.0);
    go_on();
  });
}

Outcome SteppedTrial::outcome() const {
  if (!ended()) throw std::logic_error("the trial has not ended");
  return row_->outcome;
}

TrialOutput SteppedTrial::output() const {
  (void)outcome();
  return {*row_, recording_.trace};
}

}  // namespace moma
