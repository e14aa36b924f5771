#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/sensor_frames.h"
#include "controller/safe/params.h"
#include "controller/safe/pose_track.h"
#include "controller/step.h"

namespace moma {

/// Memory with evidence: an object at rest that is no longer told of stays where it was until the robot's own sensors
/// look through the place. A frame is evidence where MemoryParams::rays of its rays or more would have ended on the
/// object if it were there, behind what is believed to stand before it. Evidence of MemoryParams::gone removes the
/// object, or of the time for which it had been told of, if that is less: what was seen for a moment goes in a moment.
/// What moves, and what rests where the robot has no sensors, is believed in for MemoryParams::keep. Where every object
/// is told of, nothing is done.
///
/// The idea is that of occupancy with free space from rays (Moravec & Elfes, 1985), of whole objects instead of cells.
/// Evidence is kept in PoseTrack; frames fall due by the observation's time, so that the memory has no state of its
/// own.
class ObjectMemory {
 public:
  ObjectMemory(const RobotModel& model, const MemoryParams& params, double control_period);

  bool on() const noexcept { return params_.enabled; }
  /// Takes memory.
  void set_objects(std::span<const ObjectShape> objects);

  /// Whether an object that is not told of is believed to be there still.
  bool believes(const PoseTrack& track) const noexcept;
  /// Looks where objects are remembered: `told` is the measured state, `believed` all that is believed to be there, of
  /// which some are told of. Adds to the evidence against the others.
  void look(const Observation& told, std::span<const ObjectState> believed, std::span<PoseTrack> tracks) noexcept;

 private:
  MemoryParams params_;
  double dt_;
  Kinematics robot_;
  SensorFrames frames_;
};

}  // namespace moma
