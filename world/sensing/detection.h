#pragma once

#include <vector>

#include "world/sensing/disturbances.h"
#include "world/world.h"

namespace moma {

/// Which objects have been found so far (DetectionRule), by the true poses.
class Detection {
 public:
  Detection(const DetectionRule& rule, const World& world, double control_period);

  bool on() const noexcept { return on_; }
  /// Takes the true base pose and the true states of step k = 0, 1, 2, ... (each once, in order) and sets `visible`
  /// of those that have not been found to false. Does not allocate.
  void update(const Vector3& base, std::vector<ObjectState>& objects);

 private:
  DetectionRule rule_;
  std::vector<Shape> shapes_;
  long steps_;
  bool on_;
  bool first_ = true;           // the next update is of step 0
  std::vector<long> in_range_;  // consecutive steps; once found it no longer changes
};

}  // namespace moma
