#include "eval/trial/stepped_trial.h"

#include <stdexcept>
#include <utility>

#include "controller/closed_form/closed_form.h"

namespace moma {

SteppedTrial::SteppedTrial(std::shared_ptr<const TrialSpec> spec, World world)
    : spec_(std::move(spec)), world_(std::move(world)), limits_(spec_->robot->model->velocity_limits()) {
  guarded([&] {
    plant_ = usual_plant(*spec_, world_);
    loop_ = std::make_unique<TrialLoop>(*spec_, world_, *plant_, recording_);
    go_on();
  });
}

void SteppedTrial::guarded(const std::function<void()>& part) {
  if (std::optional<TrialRow> error = error_of(*spec_, recording_, part)) row_ = std::move(error);
}

void SteppedTrial::go_on() {
  if (loop_->sense()) return;
  row_ = loop_->finish();
  loop_->look_last();
}

std::span<const ObjectShape> SteppedTrial::objects() const noexcept {
  return loop_ ? loop_->objects() : std::span<const ObjectShape>();
}

const Observation& SteppedTrial::seen() const noexcept { return loop_ ? loop_->seen() : nothing_; }

void SteppedTrial::truth(Observation& out) const {
  if (loop_) loop_->truth(out);
}

const StateRecord* SteppedTrial::state() const noexcept {
  return recording_.states.empty() ? nullptr : &recording_.states.back();
}

void SteppedTrial::step(const StepResult& answer) {
  if (ended()) return;
  guarded([&] {
    StepResult& taken = loop_->answer();
    taken = answer;
    if (taken.command.size() == limits_.size() && taken.command.allFinite())
      scale_into_limits(*spec_->robot->model, limits_, taken.command);
    loop_->act(0.0);
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
