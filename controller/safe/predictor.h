#pragma once

#include <span>
#include <string>
#include <vector>

#include "controller/model/robot_model.h"
#include "controller/params.h"
#include "controller/safe/base_ramp.h"
#include "controller/safe/object_memory.h"
#include "controller/safe/params.h"
#include "controller/safe/pose_track.h"
#include "controller/safe/prediction_memory.h"
#include "controller/safe/uncertainty.h"
#include "controller/step.h"

namespace moma {

/// Predictor feedback for known delays (Jankovic, Automatica 96, 2018; Molnar & Ames, IEEE L-CSS 6, 2022; after Smith,
/// 1957, and Artstein, 1982): the controller acts on the state in which its command takes effect. Latencies of sensing
/// and drives are known, and so are the commands on their way, so that this state is the measured one moved on by them.
///
/// All times are whole control periods. A command computed at step k is sent to the base H_b periods later and to the
/// joints H_j later, so that both begin to act after L = max(D_b, D_j), with D the drives' latencies: velocities
/// computed together act together. With S the age of measurements, the predicted state at t + L is
///   base    the pose measured at t - S_b, filtered, then moved through the periods of the commands sent D_b + S_b ago
///           and later, and of the H_b that still wait; velocities by the drive's ramp (base_ramp.h),
///   joints  q + T x the sum of the same,
///   qdot    the velocity that the latest command leads to: acceleration bounds hold around it, and not around an old
///           and noisy measurement,
///   objects and goal, filtered (pose_track.h) and, if they move, moved on by (S + L) T.
/// The only approximation is the base's ramp within a period: the mean velocity is taken along an arc.
///
/// Missed steps: if the time stamp of an observation is n > 1 periods after the last one, n - 1 steps were missed. The
/// command sent last acted through them, and moving objects continued. hold() is the largest recent n, which decays to
/// 1 with a time constant of 5 s: a command may have to act that long. Stamps that stay or go back are ignored (n = 1).
///
/// The drive: with `identify` the predictor also estimates the shares of its accelerations with which the base's drive
/// follows. Ramps at 1, 3/4, 1/2 and 1/3 of them, in both directions or for decreasing speed alone, follow the same
/// commands. The pair of a ramp and a round trip that explains the measured velocity of the last half second clearly
/// better than the present pair replaces it.
///
/// Slip: while a command asks for a hard acceleration, the share of it that the base does not do bounds the believed
/// deceleration, sooner than the misfits of half a second. While the base slips, no gain is estimated.
///
/// Observer: where the base's measured velocity is off from its ramp's by more than noise, the ramp moves towards it,
/// so that commands start from what the base does. Without the observer, commands run ahead of a slow drive until the
/// predictor has identified it.
///
/// Gains: with `identify` it also estimates, for each velocity of the base, the factor g = measured / commanded of a
/// drive that follows its command, by least squares with forgetting and the prior N(1, gain^2) under a measurement
/// noise of 0.01 m/s or rad/s. Commands are sent divided by g, within the base's speeds.
///
/// One per controller; only reset() allocates. A step is predict() or skip(), then send().
class Predictor {
 public:
  Predictor(const RobotModel& model, const PredictionParams& params, const UncertaintyParams& uncertainty,
            double base_share, double control_period, const VectorX& acceleration_limit = {});

  bool on() const noexcept { return params_.enabled; }
  bool identifies() const noexcept { return params_.enabled && params_.identify; }
  /// Clears the memory, for these objects and `more` whose states others set.
  void reset(std::span<const ObjectShape> objects, std::size_t more = 0);
  /// Returns the states of the `more` objects of reset(), which come after the told objects in predict().
  std::span<ObjectState> more() noexcept { return std::span(out_.objects).subspan(memory_.objects.size()); }

  /// Returns the state in which this step's command acts. `o` is finite, with the sizes of the robot and reset().
  const Observation& predict(const Observation& o) noexcept;
  /// Handles a step whose observation is unusable: the commands continue to act.
  void skip() noexcept;
  /// Takes the finite command of this step, and writes the command to send now. After a shorter wait a base changes to
  /// it at most at `base_share` of its accelerations (0: at once), and joints at most at their `acceleration_limit`
  /// (default: at once).
  void send(const VectorX& command, VectorX& sent) noexcept;

  /// State that the last predict() returned.
  const Observation& predicted() const noexcept { return out_; }
  /// The velocity that the latest command leads to, as of the last predict() or skip().
  const VectorX& velocity() const noexcept { return out_.qdot; }
  /// Uncertainty of each object's position at the end of the last predict(); empty without `uncertainty`.
  std::span<const PlaceSpread> spreads() const noexcept { return spreads_; }
  /// Time from now until this step's command acts [s].
  double lateness() const noexcept { return late_ * dt_; }
  /// Number of periods that this step's command may have to act; at least 1.
  double hold() const noexcept { return memory_.hold; }
  /// Number of periods that were missed before the last predict().
  int missed() const noexcept { return missed_; }
  /// Returns the estimated shares of the base's accelerations with which its drive follows. The share of the
  /// deceleration is the least estimate since reset(), of drives and of slip: a base that slips during hard braking
  /// does not slip during gentle braking. Both count the share of recent periods that were not missed, in which alone a
  /// command changes.
  BaseRamp::Shares drive() const noexcept;
  /// Time from a command to the measurement of its velocity, configured or identified [s].
  double base_round_trip() const noexcept { return base_dof_ > 0 ? memory_.base_trip.periods * dt_ : 0.0; }
  double joint_round_trip() const noexcept { return memory_.joint_trip.periods * dt_; }

  const PredictionMemory& memory() const noexcept { return memory_; }
  /// Continues from a memory with the sizes of the present one. Does not allocate.
  void set_memory(const PredictionMemory& memory) noexcept;

 private:
  void miss_steps(double time) noexcept;
  void synchronise() noexcept;
  void identify(const Observation& o) noexcept;
  void follow_command() noexcept;
  const Vector3& driven(int drive, int age) const noexcept;
  bool identify_base(const Observation& o) noexcept;
  void identify_gains(const Observation& o) noexcept;
  Vector3 gains() const noexcept;
  Vector3 followed_command(int age) const noexcept;
  void correct_velocity(const Observation& o) noexcept;
  void identify_slip(int i, double command, double corrected) noexcept;
  double slip(int i) const noexcept;
  bool slips() const noexcept;
  void correct_base(const Vector3& measured) noexcept;
  void predict_object(const ObjectState& seen, std::size_t i) noexcept;
  void predict_joints() noexcept;
  void predict_base() noexcept;
  void predict_velocity() noexcept;
  Vector3 mean_velocity(int age) const noexcept;

  const RobotModel* model_;
  PredictionParams params_;
  double dt_;
  int base_dof_, num_joints_;
  BaseRamp ramp_;
  VectorX joint_step_;  // largest change of a joint's command in a period
  double base_share_;
  Vector3 base_speed_ = Vector3::Zero();  // largest velocities
  double gain_prior_ = 0.0;               // weight of a gain of 1 [(m/s)^2, (rad/s)^2]; 0: gains are 1
  UncertaintyParams uncertain_;
  Uncertainty uncertainty_;
  PoseFilter filter_;
  ObjectMemory object_memory_;
  int base_age_, joint_age_, object_age_, goal_age_;  // S, in periods
  int tried_;                                         // round trips of 0 .. tried_ - 1 periods
  int periods_;                                       // number of remembered periods
  int missed_ = 0;                                    // periods before the present one
  int late_ = 0, hold_base_ = 0, hold_joints_ = 0;    // L and H
  PredictionMemory memory_;
  std::vector<PlaceSpread> spreads_;
  Observation out_;
};

/// Returns why a memory does not fit such a controller among so many objects; "" if it fits.
std::string prediction_mismatch(const PredictionMemory& memory, const RobotModel& model, const ControllerParams& params,
                                double control_period, std::size_t objects);

}  // namespace moma
