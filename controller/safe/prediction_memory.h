#pragma once

#include <vector>

#include "controller/describe/complete.h"
#include "controller/describe/describe.h"
#include "controller/safe/pose_track.h"
#include "controller/safe/round_trip.h"
#include "controller/types.h"

namespace moma {

/// The predictor's memory between steps. Predictor::reset() fixes all sizes: copies among equal sizes do not allocate.
struct PredictionMemory {
  double time = -1.0;  ///< of the last observation [s]; negative: none
  double hold = 1.0;   ///< periods that a command may have to act: 1, more after recent missed steps
  double kept = 1.0;   ///< share of recent control periods that were not missed
  // One for each control period, the latest first.
  std::vector<VectorX> computed;  ///< commands as the steps computed them
  std::vector<VectorX> sent;      ///< commands as sent, to base or joints later than computed
  /// Velocities of the base's ramp at the end of the period in which the command of `sent` acts.
  std::vector<Vector3> base_velocity;
  bool begun = false;              ///< `base` is known
  Vector3 base = Vector3::Zero();  ///< filtered (x, y, phi) as of the last measurement
  bool catching_up = false;        ///< joints still follow commands that had waited longer (Predictor::send)
  int drive = 0;                   ///< index of the drive that the base is taken to have (Predictor)
  double slowing = 1.0;            ///< least share of the deceleration estimated since reset()
  /// Sums of the ramp's changes at hard accelerations, and of the part of them that the base did not do.
  Vector3 asked = Vector3::Zero(), behind = Vector3::Zero();
  /// `base_velocity` by the ramp of each candidate drive: one block per drive, one entry per candidate round trip.
  std::vector<Vector3> driven;
  /// Sums of the base's gains, velocity measured / commanded, for each of its velocities (Predictor).
  Vector3 gain_measured = Vector3::Zero(), gain_commanded = Vector3::Zero();
  RoundTrip base_trip;   ///< from a sent command to the base's measured velocity
  RoundTrip joint_trip;  ///< from a sent command to the joints' measured velocities
  std::vector<PoseTrack> objects;
  PoseTrack goal;
};

constexpr void describe(auto& v, Of<PredictionMemory>) {
  using M = PredictionMemory;
  v.member("time", &M::time, unless_default(quantity("s", "of the last observation")));
  v.member(
      "hold", &M::hold,
      unless_default(positive("", "periods that a command may have to act for, because steps were missed of late")));
  v.member("kept", &M::kept, unless_default(positive_share("share of recent control periods that were not missed")));
  v.member("computed", &M::computed, quantity("rad/s or m/s", "commands of past periods, the latest first"));
  v.member("sent", &M::sent, quantity("rad/s or m/s", "the same as they were sent to the drives"));
  v.member("base_velocity", &M::base_velocity, quantity("m/s or rad/s", "the base's, by its ramp"));
  v.member("begun", &M::begun, {.text = "whether base is known"});
  v.member("base", &M::base, quantity("m or rad", "filtered x, y, phi as of the last measurement"));
  v.member("catching_up", &M::catching_up,
           unless_default({.text = "joints follow commands that waited longer before"}));
  v.member("drive", &M::drive, unless_default({.text = "index of the drive that the base is taken to have"}));
  v.member("slowing", &M::slowing,
           unless_default(positive_share("least share of the base's deceleration that was estimated so far")));
  v.member("asked", &M::asked,
           unless_default(quantity("m/s or rad/s", "sums of the ramp's changes at hard accelerations")));
  v.member("behind", &M::behind,
           unless_default(quantity("m/s or rad/s", "sums of the part of them that the base did not do")));
  v.member("driven", &M::driven, unless_default(quantity("m/s or rad/s", "the base's velocity by each drive")));
  v.member(
      "gain_measured", &M::gain_measured,
      unless_default(quantity("(m/s)^2 or (rad/s)^2", "sums of the base's velocities as measured times as commanded")));
  v.member("gain_commanded", &M::gain_commanded,
           unless_default(quantity("(m/s)^2 or (rad/s)^2", "sums of the squares of those commanded")));
  v.member("base_trip", &M::base_trip, {.text = "from a command to the base's measured velocity"});
  v.member("joint_trip", &M::joint_trip, {.text = "from a command to the joints' measured velocity"});
  v.member("objects", &M::objects, {.text = "one for each object, in their order"});
  v.member("goal", &M::goal, {});
}

static_assert(is_complete<PredictionMemory>());

}  // namespace moma
