#pragma once

#include <span>
#include <vector>

#include "controller/model/proximity.h"
#include "controller/plan/edge.h"
#include "controller/safe/goal_clearance.h"

namespace moma {

/// Distances that a configuration has to keep [m].
struct Clearances {
  double object = 0.0;
  double floor = 0.0;
  double self = 0.0;
};

/// What configurations have to keep: distances, and room to the joints' limits.
struct Keeps {
  Clearances clearances;
  KeptDistance at_goal;          ///< from objects, near the goal
  WholeConfiguration low, high;  ///< of the joints, margins kept; one value each

  /// Whether all that keeps `other`, near the same goal, keeps this.
  bool follows_from(const Keeps& other) const noexcept {
    const Clearances &a = clearances, &b = other.clearances;
    return a.object <= b.object && a.floor <= b.floor && a.self <= b.self && low.size() == other.low.size() &&
           (low.array() <= other.low.array()).all() && (high.array() >= other.high.array()).all();
  }
};

/// Which configurations and edges keep clear of objects at rest, the floor and the robot itself, and inside the joints'
/// limits. Counts what it does in checks, each one configuration's distances. One per worker; set_objects() may take
/// memory, nothing else does.
class FreeSpace {
 public:
  FreeSpace(std::shared_ptr<const RobotModel> model, const MotionLimits& limits);

  void set_objects(std::span<const ObjectShape> objects);
  /// Where the objects are while the work lasts; a copy is kept. Those that move or are not seen are left out. As many
  /// as set_objects() was given.
  void set_states(std::span<const ObjectState> states) noexcept;
  std::span<const ObjectState> states() const noexcept { return states_; }

  /// Margins to limits and clearances from here on. Where `start` is nearer than that to a limit or to something, as
  /// near is near enough everywhere: else no way would lead out. Joints that wind keep to one turn, about that of
  /// `turn` as far as their limits let it, which is less than half a turn from the start. `room`: the part of the
  /// joints' margins that is kept.
  void set_clearances(const Clearances& clearances, const WholeConfiguration& start, const WholeConfiguration& turn,
                      double room) noexcept;
  void set_clearances(const Clearances& clearances, const WholeConfiguration& start, double room = 1.0) noexcept {
    set_clearances(clearances, start, start, room);
  }
  /// Near the goal less is kept from objects from here on.
  void keep_near(const KeptDistance& kept) noexcept { keeps_.at_goal = kept; }
  /// All of that; keep() goes back to what was kept then.
  const Keeps& keeps() const noexcept { return keeps_; }
  void keep(const Keeps& keeps) noexcept { keeps_ = keeps; }
  const KeptDistance& kept() const noexcept { return keeps_.at_goal; }
  const Clearances& clearances() const noexcept { return keeps_.clearances; }
  const WholeConfiguration& lower() const noexcept { return keeps_.low; }  ///< of the joints, margins kept
  const WholeConfiguration& upper() const noexcept { return keeps_.high; }

  /// Turns joints that wind, as often as need be, into the turn that they keep to.
  void unwind(WholeConfiguration& c) const noexcept;

  /// The hand's least distance to an object with E at X_WG, `range` at most [m]. `c` is any configuration.
  double least_at_goal(GoalClearance& hand, const WholeConfiguration& c, const Isometry& X_WG, double range) noexcept {
    return hand.least(place(c), X_WG, states_, range, proximity_);
  }

  bool free(const WholeConfiguration& c) noexcept;
  /// The same with other clearances, whatever the joints are.
  bool clear(const WholeConfiguration& c, const Clearances& clearances) noexcept;
  /// The edge's end first, then its middle, its quarters ... until no point of the robot goes farther than `step`
  /// between two checks, less where little is kept, or it has been cut into kMostParts.
  bool free(const Edge& edge, double step) noexcept;
  /// From the edge's start on, in the same steps: the part of its time up to which it is free, 1 for all of it.
  double free_part(const Edge& edge, double step) noexcept;

  static constexpr int kMostParts = 128;

  long checks() const noexcept { return checks_; }
  /// Work of other kinds, in units of a check.
  void charge(long checks) noexcept { checks_ += checks; }

  /// Of the last configuration that was looked at.
  const Kinematics& kinematics() const noexcept { return kinematics_; }
  /// That of any other, for those who need one.
  Kinematics& place(const WholeConfiguration& c) noexcept;
  const MotionLimits& limits() const noexcept { return *limits_; }

 private:
  Vector3 hand() const noexcept;
  double step_near(const WholeConfiguration& c, double step) noexcept;

  const MotionLimits* limits_;
  Kinematics kinematics_;
  Proximity proximity_;
  std::vector<ObjectState> states_;
  Keeps keeps_;
  WholeConfiguration point_;
  long checks_ = 0;
};

}  // namespace moma
