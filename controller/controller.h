#pragma once

#include <memory>
#include <span>

#include "controller/model/kinematics.h"
#include "controller/params.h"
#include "controller/part_clock.h"
#include "controller/step.h"

namespace moma {

class ControllerCore;

/// moma's controller: the QP of controller.md in all its presets, and the closed-form baselines. Built from a robot,
/// parameters and the control period; one per worker. A step depends on its observations since reset() alone (the
/// solver has no warm start), does not allocate with a real-time safe solver, and always returns a finite command
/// within its bounds. Accessors describe the last step.
class Controller : public StepController {
 public:
  /// `control_period` [s] > 0. `params` may leave vectors empty for their defaults (see resolved()). Throws
  /// std::invalid_argument with the wrong keys, or for a solver that this build lacks.
  Controller(std::shared_ptr<const RobotModel> model, ControllerParams params, double control_period);
  ~Controller() override;
  /// Continues as the other would have. The other may then only be assigned or destroyed.
  Controller(Controller&&) noexcept;
  Controller& operator=(Controller&&) noexcept;

  void reset(std::span<const ObjectShape> objects) override;
  void see(const DepthFrame& frame) noexcept override;
  Gaze gaze(int sensor) const noexcept override;
  void step(const Observation& observation, StepResult& result) noexcept override;
  void prepare(StepResult& result) const override;

  /// Fills StepResult::solve_seconds from the steady clock; off by default.
  void enable_timing(bool on) noexcept;
  /// Notifies `clock`, which must outlive the controller or the next call, of the parts of a step; null by default.
  void set_clock(StepClock* clock) noexcept;

  /// The robot with a spare shape for an object in its hand (with_spare_shape()).
  const RobotModel& model() const noexcept;
  /// Parameters with every vector at its full size.
  const ControllerParams& params() const noexcept;
  double control_period() const noexcept;
  /// Kinematics of the configuration in which the command acts: the observed one, or its prediction.
  const Kinematics& kinematics() const noexcept;
  /// Wheel speeds [rad/s] of the last command: left, right or FL, FR, RL, RR; empty without wheels. Allocates.
  VectorX wheels() const;

 private:
  std::unique_ptr<ControllerCore> core_;
};

}  // namespace moma
