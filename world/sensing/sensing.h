#pragma once

#include <optional>
#include <vector>

#include "controller/model/robot_model.h"
#include "controller/step.h"
#include "controller/types.h"
#include "world/plant/plant.h"
#include "world/sensing/delay_line.h"
#include "world/sensing/depth.h"
#include "world/sensing/detection.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/odometry.h"
#include "world/sensing/streams.h"
#include "world/world.h"

namespace moma {

/// False detections: balls that a trial's sensors see where nothing is. Time is cut into spans. In each span a ball
/// exists with its probability; it rests at a place that is drawn in a ring about the base's place at the beginning of
/// the span. The controller is told of their shapes after those of the world's objects.
class Phantoms {
 public:
  Phantoms(const FalseDetections& rule, const DisturbanceStreams& streams, double control_period);

  std::size_t count() const noexcept { return static_cast<std::size_t>(rule_.count); }
  /// "phantom0", "phantom1", ..., longer where an object of the world has that name.
  std::vector<ObjectShape> shapes(const World& world) const;
  /// Their states at step k = 0, 1, 2, ... (each once, in order), appended to `objects`; `base` is the true one.
  void append(long k, const Vector3& base, std::vector<ObjectState>& objects);

 private:
  FalseDetections rule_;
  DisturbanceStreams streams_;
  long span_;  // in control periods
  std::vector<ObjectState> states_;
};

/// The sensors between the simulated robot and its controller: turns the truth into what is sensed. Each measurement is
/// made at a control step and takes its errors there: odometry, bias, noise, in this order. A delay returns the
/// measurement of an earlier step unchanged; until the first one is due, it returns the first. `model` outlives it. One
/// per trial.
class Sensing {
 public:
  Sensing(const Disturbances& disturbances, const RobotModel& model, const World& world, double control_period);

  /// Shapes of the false detections, which a controller gets after the world's objects.
  std::vector<ObjectShape> phantoms(const World& world) const { return phantoms_.shapes(world); }
  /// `seen` is the finite true state at step k = 0, 1, 2, ... (each once, in order), and the observation afterwards. Of
  /// an invisible object only `visible` changes. Appends phantoms to its objects. Allocates only if `seen` has no
  /// capacity for these.
  void sense(long k, Observation& seen);
  /// Hands over frames that have arrived (SeenBy::kDepth): then no object is told.
  void show(StepController& controller) {
    if (depth_) depth_->show(controller);
  }

 private:
  struct JointReading {
    VectorX q, qdot;
  };
  struct BaseReading {
    Vector3 pose = Vector3::Zero();
    Vector3 velocity = Vector3::Zero();  // its first base_dof coordinates
  };
  /// Sources of a measured pose's errors, and its constant offset.
  struct PoseSources {
    DisturbanceSource position, rotation, linear, angular, bias_position, bias_rotation;
  };
  struct PoseBias {
    Vector3 position = Vector3::Zero();
    Vector3 rotation = Vector3::Zero();
  };

  PoseBias draw_bias(const PoseSensing& config, const PoseSources& sources, std::size_t object) const;
  void measure_base(long k, Observation& seen);
  void measure_joints(long k, Observation& seen) const;
  void measure_pose(const PoseSensing& config, const PoseSources& sources, const PoseBias& bias, long k,
                    std::size_t object, Isometry& X_W, Vector6& V_W) const;
  double noise_factor(const PoseSensing& config, const Vector3& p_W) const;
  void late(long k, Observation& seen);

  Disturbances config_;
  DisturbanceStreams streams_;
  int base_dof_;
  Odometry odometry_;
  Detection detection_;
  Phantoms phantoms_;
  std::optional<DepthSensing> depth_;
  VectorX joint_bias_;
  Vector3 base_bias_ = Vector3::Zero();
  std::vector<PoseBias> object_bias_;
  PoseBias goal_bias_;
  Vector3 true_base_ = Vector3::Zero();  // at the present step
  Vector3 seen_base_ = Vector3::Zero();  // as measured at the present step, before the delay

  JointReading joints_;
  BaseReading base_;
  LateLine<JointReading> late_joints_;
  LateLine<BaseReading> late_base_;
  LateLine<std::vector<ObjectState>> late_objects_;
  struct GoalReading {
    GoalState goal;
    std::optional<GoalState> next;
  };
  LateLine<GoalReading> late_goal_;

  static const PoseSources kObject, kGoal;
};

/// The physics of one trial: what `disturbances` say, drawn from the world's own streams.
PlantConditions plant_conditions(const Disturbances& disturbances, const RobotModel& model, const World& world);

}  // namespace moma
