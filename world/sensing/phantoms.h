#pragma once

#include <string>
#include <vector>

#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"
#include "world/world.h"

namespace moma {

/// False detections: balls that a trial's sensors report where nothing is. Time is divided into spans. In each span a
/// ball exists with its probability, at rest, at a position drawn in a ring around the base at the span's start. The
/// controller gets their shapes after those of the world's objects.
class Phantoms {
 public:
  Phantoms(const FalseDetections& rule, const DisturbanceStreams& streams, double control_period);

  std::size_t count() const noexcept { return static_cast<std::size_t>(rule_.count); }
  /// Named "phantom0", "phantom1", ..., with a longer name if an object of the world has the same.
  std::vector<ObjectShape> shapes(const World& world) const;
  /// Appends their states at step k = 0, 1, 2, ... (each once, in order) to `objects`; `base` is the true pose.
  void append(long k, const Vector3& base, std::vector<ObjectState>& objects);

 private:
  FalseDetections rule_;
  DisturbanceStreams streams_;
  long span_;  // in control periods
  std::vector<ObjectState> states_;
};

}  // namespace moma
