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

/// Predictor feedback for known delays (Jankovic, Automatica 96, 2018; Molnar & Ames, IEEE L-CSS 6, 2022; the idea is
/// Smith's of 1957 and Artstein's of 1982): the controller of this step is given the state that there will be when its
/// command takes effect. Sensing and drives are late by known times, and the commands on their way are known, so that
/// the state is the measured one moved on by them.
///
/// All times are whole control periods. A command computed at step k is sent to the base H_b periods later and to the
/// joints H_j later, so that both begin to act after L = max(D_b, D_j), D the lateness of the drives: what was computed
/// together acts together. With S the age of what is measured, the predicted state at t + L is
///   base    the pose measured at t - S_b, filtered, then moved through the periods of the commands sent D_b + S_b ago
///           and later, and of the H_b that still wait; velocities by the drive's ramp (base_ramp.h),
///   joints  q + T x the sum of the same,
///   qdot    the velocity that the latest command leads to: bounds on accelerations hold around it, and not around
///           a measurement that is old and noisy,
///   objects and goal, filtered (pose_track.h) and, where they move, moved on by (S + L) T.
/// What is not known exactly about the base alone is the ramp within a period: the mean velocity is taken along an arc.
///
/// Missed steps: where an observation is n > 1 periods younger than the last one, by its time stamp, n - 1 steps were
/// missed. The command sent last acted through them, and what moves went on. hold() is the largest n of late, which
/// falls back to 1 with a time constant of 5 s: a command may have to act for so long. Stamps that stay or go back say
/// nothing (n = 1).
///
/// The drive: with `identify` the shares of its accelerations with which the base's drive follows are found as round
/// trips are. Ramps at 1, 3/4, 1/2 and 1/3 of them follow the same commands, of both or where the speed falls alone;
/// that which explains the measured velocity of the last half second clearly better than the one in use takes its
/// place.
///
/// One per controller; only reset() takes memory. A step is predict() or skip(), then send().
class Predictor {
 public:
  Predictor(const RobotModel& model, const PredictionParams& params, const UncertaintyParams& uncertainty,
            double base_share, double control_period, const VectorX& acceleration_limit = {});

  bool on() const noexcept { return params_.enabled; }
  bool identifies() const noexcept { return params_.enabled && params_.identify; }
  /// Forgets everything, for these objects.
  void reset(std::span<const ObjectShape> objects);

  /// What will be when the command of this step acts. `o` is finite and of the sizes of the robot and reset().
  const Observation& predict(const Observation& o) noexcept;
  /// A step whose observation cannot be used: the commands go on acting.
  void skip() noexcept;
  /// Takes the command of this step (finite), and writes what is to be sent now. Where a wait has become shorter, a
  /// base comes to it no faster than at `base_share` of its accelerations (0: at once), and joints no faster than at
  /// their part of `acceleration_limit` (not given: at once).
  void send(const VectorX& command, VectorX& sent) noexcept;

  /// What the last predict() returned.
  const Observation& predicted() const noexcept { return out_; }
  /// The velocity that the latest command leads to: that of the last predict() or skip().
  const VectorX& velocity() const noexcept { return out_.qdot; }
  /// How well the place of each object is known at the end of the last predict(); empty without `uncertainty`.
  std::span<const PlaceSpread> spreads() const noexcept { return spreads_; }
  /// From now to when the command of this step acts [s].
  double lateness() const noexcept { return late_ * dt_; }
  /// Periods that the command of this step may have to act for; at least 1.
  double hold() const noexcept { return memory_.hold; }
  /// Shares of its accelerations with which the base's drive follows, as far as its motion has shown.
  const BaseRamp::Shares& drive() const noexcept;
  /// From a command to the velocity measured of it, as configured or found [s].
  double base_round_trip() const noexcept { return base_dof_ > 0 ? memory_.base_trip.periods * dt_ : 0.0; }
  double joint_round_trip() const noexcept { return memory_.joint_trip.periods * dt_; }

  const PredictionMemory& memory() const noexcept { return memory_; }
  /// Goes on from such a memory, of the sizes of the present one. Takes no memory.
  void set_memory(const PredictionMemory& memory) noexcept;

 private:
  void miss_steps(double time) noexcept;
  void synchronise() noexcept;
  void identify(const Observation& o) noexcept;
  void follow_drives() noexcept;
  void identify_drive(const Observation& o) noexcept;
  void correct_base(const Vector3& measured) noexcept;
  void predict_object(const ObjectState& seen, std::size_t i) noexcept;
  void predict_joints(const VectorX& q) noexcept;
  void predict_base() noexcept;
  void predict_velocity() noexcept;
  Vector3 mean_velocity(int age) const noexcept;

  const RobotModel* model_;
  PredictionParams params_;
  double dt_;
  int base_dof_, num_joints_;
  BaseRamp ramp_;
  VectorX joint_step_;  // most that a joint's command may change in a period
  double base_share_;
  UncertaintyParams uncertain_;
  Uncertainty uncertainty_;
  PoseFilter filter_;
  ObjectMemory object_memory_;
  int base_age_, joint_age_, object_age_, goal_age_;  // S, in periods
  int tried_;                                         // round trips of 0 .. tried_ - 1 periods
  int periods_;                                       // remembered
  int late_ = 0, hold_base_ = 0, hold_joints_ = 0;    // L and H
  PredictionMemory memory_;
  std::vector<PlaceSpread> spreads_;
  Observation out_;
};

/// Why a memory is not one of such a controller among so many objects; "" where it is.
std::string prediction_mismatch(const PredictionMemory& memory, const RobotModel& model, const ControllerParams& params,
                                double control_period, std::size_t objects);

}  // namespace moma
