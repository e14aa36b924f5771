#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "controller/model/kinematics.h"
#include "controller/step.h"
#include "world/plant/plant.h"

namespace moma::test {

/// Integrates commands exactly; `fault` may change state and report after each advance (and once at the start).
class FakePlant : public Plant {
 public:
  using Fault = std::function<void(double time, PlantState& state, PlantReport& report)>;

  FakePlant(std::shared_ptr<const RobotModel> model, const World& world, Fault fault = {})
      : Plant(*model, world), model_(std::move(model)), fault_(std::move(fault)) {}

  void check_start(PlantReport& report) override {
    report = {};
    if (fault_) fault_(0.0, state_, report);
  }

  void advance(const VectorX& command, double duration, PlantReport& report) override {
    report = {};
    integrate(*model_, state_.base, state_.q, command, duration);
    state_.qdot = command;
    time_ += duration;
    if (fault_) fault_(time_, state_, report);
  }

 private:
  std::shared_ptr<const RobotModel> model_;
  Fault fault_;
};

/// Says what it is told to say.
class ScriptedController : public StepController {
 public:
  using Script = std::function<void(const Observation& observation, StepResult& result)>;

  ScriptedController(int velocities, Script script) : velocities_(velocities), script_(std::move(script)) {}

  void reset(std::span<const ObjectShape>) override {}
  void prepare(StepResult& result) const override { result.command = VectorX::Zero(velocities_); }
  void step(const Observation& observation, StepResult& result) noexcept override {
    result.command.setZero(velocities_);
    if (script_) script_(observation, result);
  }

 private:
  int velocities_;
  Script script_;
};

}  // namespace moma::test
