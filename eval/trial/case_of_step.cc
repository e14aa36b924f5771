#include "eval/trial/case_of_step.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "controller/controller_core.h"
#include "eval/trial/told_params.h"

namespace moma {
namespace {

/// One of moma's controllers, recorded before a step: its observation and memory.
class Witness final : public StepController {
 public:
  Witness(const TrialSpec& spec, long k, ControlCase& out, bool& found)
      : controller_(spec.robot->model, told_params(spec), spec.simulation.control_period),
        k_(k),
        period_(spec.simulation.control_period),
        out_(out),
        found_(found) {}

  void reset(std::span<const ObjectShape> objects) override {
    controller_.reset(objects);
    out_.objects.assign(objects.begin(), objects.end());
  }
  void step(const Observation& observation, StepResult& result) noexcept override {
    if (std::lround(observation.time / period_) == k_) {
      out_.observation = observation;
      controller_.get_memory(out_.memory);
      found_ = true;
    }
    controller_.step(observation, result);
  }
  void prepare(StepResult& result) const override { controller_.prepare(result); }
  std::string_view failure() const noexcept override { return found_ ? "is where the case was taken" : ""; }

 private:
  ControllerCore controller_;
  long k_;
  double period_;
  ControlCase& out_;
  bool& found_;
};

}  // namespace

ControlCase case_of_step(const TrialSpec& spec, const World& world, long k) {
  if (spec.plugin != nullptr)
    throw std::invalid_argument("a plugin's steps have no cases: what it remembers is its own");
  ControlCase out;
  out.robot = *spec.robot;
  out.controller = told_params(spec);
  out.control_period = spec.simulation.control_period;
  out.has_plan = out.controller.plan.enabled;
  bool found = false;
  TrialParts parts;
  parts.controller = [&](const TrialSpec& p) { return std::make_unique<Witness>(p, k, out, found); };
  const TrialOutput trial = run_trial(spec, world, parts);
  if (!found) {
    throw std::invalid_argument(
        static_cast<std::size_t>(k) < trial.trace.size()
            ? fmt::format("control step {} of the trial was missed (disturbances.control.missed)", k)
            : fmt::format("the trial has no control step {}: it ends after {}", k, trial.trace.size()));
  }
  return out;
}

}  // namespace moma
