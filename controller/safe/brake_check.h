#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/shape_ways.h"
#include "controller/params.h"
#include "controller/safe/base_ramp.h"
#include "controller/safe/braking.h"
#include "controller/safe/params.h"
#include "controller/safe/uncertainty.h"
#include "controller/step.h"

namespace moma {

/// Margins to the floor and to the robot itself on a braking trajectory [m]; 0: not checked.
struct OwnMargins {
  double floor = 0.0;
  double self = 0.0;

  double of(PairKind kind) const noexcept { return kind == PairKind::kFloor ? floor : self; }
};
/// Returns this share of the stop distances of floor rows and self rows.
OwnMargins own_margins(const DamperParams& floor, const DamperParams& self, double share) noexcept;

/// Known pairs of the state in which a command begins to act: near pairs, the ranges within which all pairs are
/// included (negative for an unknown kind), and the robot's kinematics there, or null.
struct KnownPairs {
  std::span<const ProximityPair> pairs;
  ProximityRanges ranges{-1.0, -1.0, -1.0};
  const Kinematics* kinematics = nullptr;
};

/// The check ahead of a command: simulates the robot that follows the command for one period (or the time of
/// set_execution()) and then brakes. There are two ways of braking: (a) all velocities in proportion, in the time that
/// the slowest needs, which keeps the path, and (b) each as fast as it can. The command passes if on one of them the
/// distances to all objects at rest stay at least `margin`, and those to the floor and of the robot to itself at least
/// their own margins. It then has a backup trajectory (after Hobbs et al., IEEE CSM 43(2), 2023, "Runtime assurance";
/// Singletary et al., IEEE L-CSS 6, 2022).
/// If both fail, the check tries slower + f (u - slower), f = 0.75, 0.5, 0.25, 0, for two slower commands: the present
/// velocity minus one period of braking in proportion, and the smallest allowed command. The first that passes is
/// taken, else the one that stays furthest away. Moving objects are left out: standing still does not avoid them. With
/// `uncertainty` each distance to an object is reduced by its margin there, for pairs up to `widening` times the
/// largest margin of those within `range` at the start of the step. Distances are checked every `every` periods on the
/// trajectory, and at its end. One per controller; only set_objects() allocates.
///
/// The broad phase measures a pair only if it may be too near: its distance at the start of the step, at its last
/// measurement, or at the end of the trajectory minus the largest travel of the robot's shape in between (ShapeWays).
/// Results have the bits of measuring all pairs everywhere.
class BrakeCheck {
 public:
  /// `acceleration` per velocity, resolved; `pair_together` as for Deceleration.
  BrakeCheck(std::shared_ptr<const RobotModel> model, const BrakeCheckParams& params, const VectorX& acceleration,
             bool pair_together, double control_period, const Uncertainty& uncertainty = {{}, 0},
             const OwnMargins& own = {});

  bool on() const noexcept { return params_.enabled; }
  /// Sets the distance kept from space that no sensor has seen (ObjectState::seen) [m].
  void keep_from_unseen(double margin) noexcept { unseen_ = margin; }
  /// Sets the margin [m].
  void set_margin(double margin) noexcept { params_.margin = margin; }
  /// Sets the time that a command acts before the next one can brake [s], the control period by default, and the shares
  /// of the base drive's accelerations.
  void set_execution(double hold, const BaseRamp::Shares& shares) noexcept {
    hold_ = hold;
    ramp_.set_shares(shares);
    deceleration_.set_slowing(shares.slowing);
  }
  void set_objects(std::span<const ObjectShape> objects);

  struct Allowed {
    const VectorX& lower;
    const VectorX& upper;
    const VectorX& slowest;  ///< the smallest command in the box
  };
  /// `o`: state in which the command begins to act. Returns the kept share of `command`, 1 if it passes. `spreads`: of
  /// the objects' positions, empty if they are exact.
  double apply(const Observation& o, const Allowed& allowed, std::span<const PlaceSpread> spreads, VectorX& command,
               const KnownPairs& known = {}) noexcept;

  /// Least distance to objects at rest on the braking trajectory if it is below the margin, else infinity. Distances to
  /// the floor and to itself count with the difference of the margins added. Objects are those of the last apply().
  double least_distance(const Observation& o, const VectorX& command, bool in_proportion) noexcept;

 private:
  // A pair that may come too near on the examined trajectory.
  struct NearPair {
    PairKind kind;
    int first, second;
    double room;              // travel at which the distance may be 0 [m]; infinite if the pair stays clear
    double end = -kInfinity;  // lower bound of the distance at the end [m]
  };
  struct Group {
    int shape;
    std::size_t begin, end;
    double least_room;
  };

  void begin(const Observation& o, const KnownPairs& known) noexcept;
  void choose_candidates() noexcept;
  double object_bound(int shape, int object) noexcept;
  double range_of(PairKind kind) const noexcept;
  void leave_out_by_end() noexcept;
  double way_of_own(const NearPair& own, const VectorX& gone) const noexcept;
  double way_to_stop(const Observation& o, const VectorX& command, bool in_proportion, double floor) noexcept;
  bool place() noexcept;
  double measure(NearPair& candidate, double way, double to_come) noexcept;
  double clearance(const Observation& o, const VectorX& command, double floor) noexcept;
  double distance() noexcept;
  double margin_of(const ProximityPair& pair) noexcept;
  double widest_margin(const Observation& o) noexcept;

  std::shared_ptr<const RobotModel> model_;
  BrakeCheckParams params_;
  OwnMargins own_;
  double unseen_ = 0.0;
  double dt_, hold_;
  Kinematics kinematics_;
  Proximity proximity_;
  BaseRamp ramp_;
  Deceleration deceleration_;
  Uncertainty uncertainty_;
  std::span<const PlaceSpread> spreads_;  // of the present step
  double widest_ = 0.0;                   // largest margin considered
  Matrix3X J_;
  VectorX row_;
  VectorX q_, mean_, times_;
  VectorX trial_, full_, in_proportion_;
  Vector3 base_ = Vector3::Zero();
  std::vector<ObjectState> states_;

  ShapeWays ways_;
  VectorX gone_, whole_;  // travel of each velocity so far, and over the whole trajectory
  // Lower bounds of distances at the start of the step: of shapes and objects, of shapes to the floor, of the model's
  // self pairs.
  std::vector<double> object_bounds_, floor_bounds_, self_bounds_;
  std::vector<int> shown_;     // the visible ones among them
  std::vector<double> radii_;  // of the objects
  std::vector<char> sharp_;    // the object's bounds are as good as cheaply possible
  std::vector<int> self_at_;   // index of a pair of shapes in the model's list
  enum class Placed { kNot, kAtStart, kHere } placed_ = Placed::kNot;  // state of the robot in proximity_
  const Kinematics* start_ = nullptr;                                  // the robot at the start of the step
  Kinematics own_start_;
  std::vector<NearPair> candidates_;  // pairs of groups first
  std::vector<Group> groups_;
  std::size_t grouped_ = 0;
  bool open_ = false;
};

}  // namespace moma
