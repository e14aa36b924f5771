#pragma once

#include <optional>
#include <span>
#include <vector>

#include "controller/model/proximity.h"
#include "controller/model/upright.h"
#include "controller/plan/counted_draws.h"
#include "controller/plan/edge.h"
#include "controller/safe/goal_clearance.h"

namespace moma {

/// True for the objects of which plans keep clear: visible ones at rest.
inline bool counts_for_plans(const ObjectState& object) noexcept { return object.visible && !in_motion(object); }

/// True if an object is where it was, within `moved` [m] and `turned` [rad], and its box as large.
inline bool stays(const ObjectState& now, const ObjectState& then, double moved, double turned) noexcept {
  return (now.X_WO.translation() - then.X_WO.translation()).squaredNorm() <= moved * moved &&
         (now.box - then.box).squaredNorm() <= moved * moved &&
         (now.X_WO.linear() - then.X_WO.linear()).squaredNorm() <= 2.0 * turned * turned;
}

/// Distances that a configuration has to keep [m].
struct Clearances {
  double object = 0.0;
  double floor = 0.0;
  double self = 0.0;
};

/// Distances and joint ranges that configurations have to keep.
struct Keeps {
  Clearances clearances;
  KeptDistance at_goal;            ///< distance of the hand's shapes from objects near the goal
  WholeConfiguration low, high;    ///< joint limits with their margins, one value per joint
  double arm_at_goal = kInfinity;  ///< least distance of the other shapes near the goal [m]

  /// True if every configuration near the same goal that keeps `other` also keeps this.
  bool follows_from(const Keeps& other) const noexcept {
    const Clearances &a = clearances, &b = other.clearances;
    return a.object <= b.object && a.floor <= b.floor && a.self <= b.self && low.size() == other.low.size() &&
           (low.array() <= other.low.array()).all() && (high.array() >= other.high.array()).all();
  }
};

/// Checks that configurations and edges stay clear of objects at rest, the floor and the robot itself, inside the joint
/// limits, and upright if that is asked for. It counts its work in checks; one check computes one configuration's
/// distances. One per worker. Only set_objects() allocates.
class FreeSpace {
 public:
  FreeSpace(std::shared_ptr<const RobotModel> model, const MotionLimits& limits);

  void set_objects(std::span<const ObjectShape> objects);
  /// Copies the objects' states, as many as set_objects() was given. Moving and invisible objects are left out. Space
  /// that no sensor has seen must not be entered; its distance does not count.
  void set_states(std::span<const ObjectState> states) noexcept;
  std::span<const ObjectState> states() const noexcept { return states_; }

  /// Sets clearances and joint ranges. A `start` that is nearer to an object or a joint limit lowers them to its own
  /// distance, for all configurations; otherwise no way leads out of it. A joint that winds keeps to one turn around
  /// `turn`, less than half a turn from the start. `room`: kept share of the joints' margins.
  void set_clearances(const Clearances& clearances, const WholeConfiguration& start, const WholeConfiguration& turn,
                      double room) noexcept;
  void set_clearances(const Clearances& clearances, const WholeConfiguration& start, double room = 1.0) noexcept {
    set_clearances(clearances, start, start, room);
  }
  /// Sets the distances of hand and arm from objects near the goal.
  void keep_near(const KeptDistance& hand, double arm = kInfinity) noexcept {
    keeps_.at_goal = hand;
    keeps_.arm_at_goal = arm;
  }
  /// Keeps the tool upright with `share` of the angle, or what start and goal need; or not at all.
  void keep_upright(const std::optional<Upright>& upright, double share, const WholeConfiguration& start,
                    const Isometry& X_WG) noexcept;
  bool keeps_upright() const noexcept { return upright_.has_value(); }
  /// Moves the arm until the tool is upright if it has to be. False if that fails.
  bool bring_upright(WholeConfiguration& c) noexcept;
  /// All of these settings; keep() restores them.
  const Keeps& keeps() const noexcept { return keeps_; }
  void keep(const Keeps& keeps) noexcept { keeps_ = keeps; }
  const KeptDistance& kept() const noexcept { return keeps_.at_goal; }
  /// True if the hand may be nearer to objects at its goal than elsewhere.
  bool narrow() const noexcept { return keeps_.at_goal.at_goal < keeps_.clearances.object; }
  const Clearances& clearances() const noexcept { return keeps_.clearances; }
  const WholeConfiguration& lower() const noexcept { return keeps_.low; }  ///< joint limits with their margins
  const WholeConfiguration& upper() const noexcept { return keeps_.high; }

  /// Draws joints up to `range` from those of `c`, in units of a joint's part, within their ranges.
  void vary_joints(double range, CountedDraws& draws, WholeConfiguration& c) const noexcept;
  /// Moves joints that wind by whole turns into their range.
  void unwind(WholeConfiguration& c) const noexcept;

  /// Returns the hand's least distance to an object with E at X_WG, at most `range` [m]. `c`: any configuration.
  double least_at_goal(const WholeConfiguration& c, const Isometry& X_WG, double range) noexcept {
    return goal_clearance_.least(place(c), X_WG, states_, range, proximity_);
  }

  bool free(const WholeConfiguration& c) noexcept;
  /// The same with other clearances and without joint ranges.
  bool clear(const WholeConfiguration& c, const Clearances& clearances) noexcept;
  /// Checks a way at its end, middle, quarters and so on, until it is cut into kMostParts, or no part of its `length`
  /// is longer than `step`. `at(part, c)` computes the configuration at `part` in (0, 1].
  template <class At>
  bool free(double length, double step, const At& at) noexcept {
    int parts = 1;
    while (parts * step < length && parts < kMostParts) parts *= 2;
    for (int stride = parts; stride >= 1; stride /= 2) {
      for (int k = stride; k <= parts; k += 2 * stride) {
        at(static_cast<double>(k) / parts, point_);
        if (!free(point_)) return false;
      }
    }
    return true;
  }
  /// The same of an edge: no point of the robot moves farther than `step` between two checks, less where the kept
  /// distance is small.
  bool free(const Edge& edge, double step) noexcept;
  /// Returns the part of the edge up to which it is free, checked from its start in the same steps; 1: all of it.
  double free_part(const Edge& edge, double step) noexcept;

  static constexpr int kMostParts = 128;

  long checks() const noexcept { return checks_; }
  /// Counts other work, in checks.
  void charge(long checks) noexcept { checks_ += checks; }

  /// Kinematics of the last configuration.
  const Kinematics& kinematics() const noexcept { return kinematics_; }
  /// Kinematics of `c`.
  Kinematics& place(const WholeConfiguration& c) noexcept;
  const MotionLimits& limits() const noexcept { return *limits_; }

 private:
  Vector3 hand() const noexcept;
  double step_near(const WholeConfiguration& c, double step) noexcept;

  const MotionLimits* limits_;
  Kinematics kinematics_;
  Proximity proximity_;
  GoalClearance goal_clearance_;
  std::vector<char> hand_;  // of each shape: it is rigid with E
  std::vector<ObjectState> states_;
  Keeps keeps_;
  std::optional<Upright> upright_;  // its angle: that of plans
  WholeConfiguration point_;
  long checks_ = 0;
};

}  // namespace moma
