#pragma once

#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/sensor_frames.h"
#include "controller/step.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"

namespace moma {

/// The frames of a robot's sensors, with errors (RangeErrors): a ray ends on the nearest of the true objects, the
/// robot's own shapes and the floor. A frame arrives after the delay of objects, with their jitter and dropout; the
/// first one arrives at once. One per trial; only the constructor allocates.
class DepthSensing {
 public:
  DepthSensing(const Disturbances& disturbances, const RobotModel& model, std::span<const Shape> objects,
               const DisturbanceStreams& streams, double control_period);

  /// Takes the frames that are due at step k = 0, 1, 2, ... (each once, in order), by the true state.
  void sense(long k, const Vector3& base, const VectorX& q, std::span<const ObjectState> objects);
  /// Hands over the frames that have arrived by the last step and that nobody was shown, of each sensor the newest.
  /// Heads turn where the controller looks.
  void show(StepController& controller);

 private:
  struct Sent {
    DepthFrame frame;
    long due = kNone;  // step at which it arrives
  };
  static constexpr long kNone = -1;

  void measure(const RayView& view, Draws draws, VectorX& ranges) const;

  RangeErrors errors_;
  Irregularity irregularity_;
  DisturbanceStreams streams_;
  double dt_;
  long delay_, jitter_, k_ = 0;
  Kinematics robot_;
  SensorFrames frames_;
  std::vector<double> range_;            // of each sensor
  std::vector<std::vector<Sent>> sent_;  // of each sensor, a ring
  std::vector<Gaze> wanted_;             // of each sensor
  std::vector<std::size_t> taken_;       // number of frames of each sensor
};

}  // namespace moma
