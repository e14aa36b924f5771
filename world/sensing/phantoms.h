#pragma once

#include <string>
#include <vector>

#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"
#include "world/world.h"

namespace moma {

/// False detections: balls that a trial's sensors see now and then where nothing is. Time is cut into spans; in each, a
/// ball is there with its probability, at rest, at a place that is drawn in a ring about where the base is as the span
/// begins. The controller is told of their shapes after those of the world's objects.
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

}  // namespace moma
