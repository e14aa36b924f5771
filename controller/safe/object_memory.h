#pragma once

#include <span>

#include "controller/model/kinematics.h"
#include "controller/model/sensor_frames.h"
#include "controller/safe/params.h"
#include "controller/safe/pose_track.h"
#include "controller/step.h"

namespace moma {

/// Memory of objects with evidence. An object at rest that is no longer reported stays where it was until the robot's
/// own sensors see through its place. A frame is evidence if at least MemoryParams::rays of its rays would end on the
/// object, behind the objects believed to stand before it. Evidence of duration MemoryParams::gone removes the object,
/// or of the time for which it had been reported if that is shorter: brief detections disappear quickly. Moving
/// objects, and all objects of a robot without sensors, are kept for MemoryParams::keep. Nothing happens if every
/// object is reported.
///
/// The idea is occupancy with free space from rays (Moravec & Elfes, 1985), for whole objects instead of cells.
/// PoseTrack holds the evidence; frames are due by the observation's time, so that the memory has no state of its own.
class ObjectMemory {
 public:
  ObjectMemory(const RobotModel& model, const MemoryParams& params, double control_period);

  bool on() const noexcept { return params_.enabled; }
  /// Allocates.
  void set_objects(std::span<const ObjectShape> objects);

  /// True if an unreported object is believed to be still there.
  bool believes(const PoseTrack& track) const noexcept;
  /// Adds evidence against remembered objects: `told` is the measured state, `believed` has all objects believed to be
  /// there, reported or not.
  void look(const Observation& told, std::span<const ObjectState> believed, std::span<PoseTrack> tracks) noexcept;

 private:
  MemoryParams params_;
  double dt_;
  Kinematics robot_;
  SensorFrames frames_;
};

}  // namespace moma
