#pragma once

#include <memory>
#include <span>

#include "controller/model/kinematics.h"
#include "controller/params.h"
#include "controller/part_clock.h"
#include "controller/safe/base_ramp.h"
#include "controller/safe/uncertainty.h"
#include "controller/step.h"
#include "controller/task/servo.h"

namespace moma {

/// Execution of commands, as identified from motion and time stamps (Predictor).
struct Execution {
  double hold = 1.0;       ///< number of control periods that the command may have to act, at least 1
  int missed = 0;          ///< number of control periods that were missed since the last step
  BaseRamp::Shares drive;  ///< shares of its accelerations with which the base's drive follows
};

/// Input of a control step's policy, problem and guards: the state in which the step's command takes effect, and
/// quantities that follow from that state alone. References are to the buffers of Assessment and of the predictor; they
/// are valid until the next step.
struct Situation {
  const Observation& o;                  ///< predicted, or measured without prediction
  std::span<const PlaceSpread> spreads;  ///< uncertainty of each object's position; empty if exact
  const Kinematics& kinematics;          ///< of o
  Task servo;                            ///< error of E, and the servo's twist
  double manipulability;
  const VectorX& J_m;  ///< gradient of the manipulability per joint; zero where its weight is zero
  Execution execution;
  StepClock* clock;  ///< clock of the step's parts, or null
};

/// Computes Situation: forward kinematics, pose error, servo twist and manipulability. One per controller; assess()
/// does not allocate.
class Assessment {
 public:
  Assessment(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void allocate(std::size_t num_objects) { aimed_.objects.assign(num_objects, ObjectState{}); }
  /// Where the goal leaves directions free, its pose in the situation is the one that is nearest to E.
  Situation assess(const Observation& o, std::span<const PlaceSpread> spreads, const Execution& execution,
                   StepClock* clock) noexcept;

  const Kinematics& kinematics() const noexcept { return kinematics_; }
  /// Gradient of the manipulability at the last assess(), for any weight. Allocates.
  VectorX J_m() const;

 private:
  const ControllerParams& params_;
  int base_dof_;
  Eigen::VectorXi prismatic_;  // 1 for prismatic joints
  Kinematics kinematics_;
  VectorX J_m_;
  Observation aimed_;  // with the goal's nearest pose, if it is not whole
};

}  // namespace moma
