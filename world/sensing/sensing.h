#pragma once

#include <vector>

#include "controller/model/robot_model.h"
#include "controller/step.h"
#include "world/sensing/delay_line.h"
#include "world/sensing/detection.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/odometry.h"
#include "world/sensing/phantoms.h"
#include "world/sensing/streams.h"

namespace moma {

/// The sensors between the simulated robot and its controller: turn the true state into an observation. Each
/// measurement takes its errors at its control step, in this order: odometry, bias, noise. A delay then passes on the
/// measurement of an earlier step; before the first one arrives, the first. `model` must outlive this object. One
/// object per trial.
class Sensing {
 public:
  Sensing(const Disturbances& disturbances, const RobotModel& model, const World& world, double control_period);

  /// Shapes of the false detections, which a controller gets after the world's objects.
  std::vector<ObjectShape> phantoms(const World& world) const { return phantoms_.shapes(world); }
  /// `seen` is the finite true state at step k = 0, 1, 2, ... (each once, in order), and the observation afterwards. Of
  /// an invisible object only `visible` changes. Appends phantoms to its objects. Allocates only if `seen` has no
  /// capacity for these.
  void sense(long k, Observation& seen);

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

  /// A delay line of measurements, and the draws of their arrival.
  struct Arrival {
    const Irregularity& irregularity;
    DisturbanceSource source;
    long jitter;
  };
  template <class T>
  void arrive(DelayLine<T>& line, long k, T& value, const Arrival& arrival) const;
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
  struct Jitter {
    long joints, base, objects, goal;  // in periods
  };
  Jitter jitter_;
  VectorX joint_bias_;
  Vector3 base_bias_ = Vector3::Zero();
  std::vector<PoseBias> object_bias_;
  PoseBias goal_bias_;
  Vector3 true_base_ = Vector3::Zero();  // at the present step
  Vector3 seen_base_ = Vector3::Zero();  // as measured at the present step, before the delay

  JointReading joints_;
  BaseReading base_;
  DelayLine<JointReading> late_joints_;
  DelayLine<BaseReading> late_base_;
  DelayLine<std::vector<ObjectState>> late_objects_;
  DelayLine<GoalState> late_goal_;

  static const PoseSources kObject, kGoal;
};

}  // namespace moma
