#pragma once

#include <memory>
#include <span>

#include "controller/model/kinematics.h"
#include "controller/params.h"
#include "controller/part_clock.h"
#include "controller/step.h"

namespace moma {

class ControllerCore;

/// moma's controller: the QP of controller.md in all its presets, and the closed-form baselines. Built from a
/// robot, parameters and the control period; one per worker. A step depends on its observations since reset() alone
/// (the solver is started cold), takes no memory with a real-time safe solver, and never returns a command that is not
/// finite or outside its bounds. Accessors describe the last step.
class Controller : public StepController {
 public:
  /// `control_period` [s] > 0. `params` may leave vectors empty for their defaults (see resolved()). Throws
  /// std::invalid_argument naming the keys that are wrong, or a solver that this build lacks.
  Controller(std::shared_ptr<const RobotModel> model, ControllerParams params, double control_period);
  ~Controller() override;
  /// Goes on as the other would have, to which nothing but assignment and the end may happen then.
  Controller(Controller&&) noexcept;
  Controller& operator=(Controller&&) noexcept;

  void reset(std::span<const ObjectShape> objects) override;
  void step(const Observation& observation, StepResult& result) noexcept override;
  void prepare(StepResult& result) const override;

  /// Fills StepResult::solve_seconds from the steady clock; off by default.
  void enable_timing(bool on) noexcept;
  /// Tells `clock`, which outlives the controller or the next call, where a step goes from one part to the next; null
  /// by default.
  void set_clock(StepClock* clock) noexcept;

  const RobotModel& model() const noexcept;
  /// With every vector at its full size.
  const ControllerParams& params() const noexcept;
  double control_period() const noexcept;
  /// Of the configuration that was acted on: the observed one, or a prediction of it.
  const Kinematics& kinematics() const noexcept;
  /// Wheel speeds [rad/s] of the last command: left, right or FL, FR, RL, RR; empty without wheels. Allocates.
  VectorX wheels() const;

 private:
  std::unique_ptr<ControllerCore> core_;
};

}  // namespace moma
