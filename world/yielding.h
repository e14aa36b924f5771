#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "world/world.h"

namespace moma {

/// Objects that give way to the robot (WorldObject::yields): decides in each control period whether they go on, wait or
/// go back. Their motions stay as the world has them; only the time of these motions differs.
class Yielding {
 public:
  Yielding(const World& world, double period);
  bool any() const noexcept { return !givers_.empty(); }
  /// The pace of each object of the world.
  std::span<const Pace> paces() const noexcept { return paces_; }
  /// The times of the motions of the objects that give way, in their order, at time t.
  VectorX times(double t) const;
  /// Decides for the period that begins at time t, with robot and objects where they are then. An object waits while a
  /// part of the robot lies ahead of it, nearer than `distance`, and beside its course by less than half its width plus
  /// `side`. It turns round after waiting for `patience`, and when it is back at its start.
  void decide(double t, const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> states);

 private:
  struct Giver {
    int object;
    double direction = 1.0;  // of its time, where it does not wait
    double waited = 0.0;     // [s]
  };
  const World& world_;
  double period_;
  double range_ = 0.0;
  std::vector<Giver> givers_;
  std::vector<Pace> paces_;
};

}  // namespace moma
