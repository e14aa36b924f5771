#pragma once

#include <span>
#include <vector>

#include "controller/model/robot_model.h"
#include "controller/types.h"

namespace moma {

/// Place at which a sensor should look.
struct Sight {
  Vector3 p_W = Vector3::Zero();
  double worth = 0.0;
};

/// True if a point of the sensor's frame lies in its field of view and range.
bool in_view(const Sensor& sensor, const Vector3& p_C) noexcept;

/// True if a camera of the robot has the space behind the base in view while the arm is `ready`, with some gaze of its
/// head: a point 1 m behind the base and 0.5 m above the floor. Whatever hides it does not count. Allocates.
bool looks_behind(const RobotModel& model);

/// Chooses the next view of a sensor on a head: the one with the largest worth x (time since its last frame) / (time of
/// the turn and a frame). A view that the arm hides thus gives way to others and is tried again later. Views are half a
/// field of view apart; a new one is chosen once the last was taken, or if the head is not there a second after it
/// could be. Only the constructor allocates.
class GazeChoice {
 public:
  explicit GazeChoice(const MountedSensor& mounted);

  bool on() const noexcept { return !views_.empty(); }
  const Gaze& wanted() const noexcept { return wanted_; }
  /// Notes a frame that was taken with this gaze, and chooses the next view if it was the one that was wanted, or if
  /// that one does not come: it is then left out for a while.
  /// `X_WL`: pose of the sensor's link; cost: views x sights.
  void saw(const Gaze& gaze, double time, const Isometry& X_WL, std::span<const Sight> sights) noexcept;

 private:
  struct View {
    Gaze gaze;
    double seen_at;  // [s]
  };
  double worth(const View& view, const Isometry& X_WL, std::span<const Sight> sights) const noexcept;

  const MountedSensor* mounted_;
  Gaze apart_;  // half a field of view
  std::vector<View> views_;
  Gaze wanted_;
  double due_ = 0.0;  // time after which the wanted view is given up [s]
};

}  // namespace moma
