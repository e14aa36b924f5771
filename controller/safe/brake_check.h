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

/// What is kept on the way to a stop from the floor and from the robot itself [m]; 0: not looked at.
struct OwnMargins {
  double floor = 0.0;
  double self = 0.0;
};
/// Half of what the rows for the floor and for the robot itself keep.
OwnMargins own_margins(const DamperParams& floor, const DamperParams& self) noexcept;

/// The last check of a command: the places of the robot if it follows the command for one period (or for as long as
/// set_execution() says) and brakes from then on. There are two ways to brake: (a) all velocities in proportion, in the
/// time that the slowest needs, which keeps the path, and (b) each as fast as it can. The command passes where on one
/// of them the distance to all objects at rest stays `margin` or more, and those to the floor and of the robot to
/// itself theirs; it then has a backup trajectory (after Hobbs et al., IEEE CSM 43(2), 2023, "Runtime assurance";
/// Singletary et al., IEEE L-CSS 6, 2022), whatever comes after.
///
/// Where both fail, commands between it and two that slow down are tried, slower + f (u - slower), f = 0.75, 0.5, 0.25,
/// 0; slower is the present velocity less one period's braking in proportion, and the smallest command that is allowed.
/// The first that passes is taken, else the one that stays furthest away. Objects in motion are left out: to stand
/// still is no way out of somebody's way. With `uncertainty` each distance to an object is taken to be less by its
/// margin there, of pairs that are no further than 1.5 times the largest margin of those within 1 m as the step begins.
/// One per controller; only set_objects() takes memory. Distances are looked at every `every` periods on the way, and
/// as it ends.
///
/// A pair of solids is measured only where it may be too near: its distance as the step begins, or where it was
/// measured last, or at the end of the way less the most that the robot's shape can move between (ShapeWays). That
/// leaves out what counts for nothing, so that results are to the bit those of measuring all pairs everywhere.
class BrakeCheck {
 public:
  /// `acceleration` per velocity, resolved; `pair_together` as of Deceleration.
  BrakeCheck(std::shared_ptr<const RobotModel> model, const BrakeCheckParams& params, const VectorX& acceleration,
             bool pair_together, double control_period, const Uncertainty& uncertainty = {{}, 0},
             const OwnMargins& own = {});

  bool on() const noexcept { return params_.enabled; }
  /// The margin from here on [m].
  void set_margin(double margin) noexcept { params_.margin = margin; }
  /// Time that a command acts for before the next one can brake [s], the control period unless told, and shares of
  /// its accelerations with which the base's drive follows.
  void set_execution(double hold, const BaseRamp::Shares& shares) noexcept {
    hold_ = hold;
    ramp_.set_shares(shares);
    deceleration_.set_slowing(shares.slowing);
  }
  void set_objects(std::span<const ObjectShape> objects);

  /// Box of the commands that are allowed.
  struct Allowed {
    const VectorX& lower;
    const VectorX& upper;
    const VectorX& slowest;  ///< the smallest command in it
  };
  /// What is known of where the command begins to act: pairs that are near, how near they would have to be to be among
  /// them (a kind with a negative range is not known), and the robot there, null where it is not at hand.
  struct Known {
    std::span<const ProximityPair> pairs;
    ProximityRanges ranges{-1.0, -1.0, -1.0};
    const Kinematics* kinematics = nullptr;
  };
  /// `o`: where the command begins to act. Returns the share of `command` that was kept, 1 where it passes.
  /// `spreads`: of the objects' places, empty where they are exact.
  double apply(const Observation& o, const Allowed& allowed, std::span<const PlaceSpread> spreads, VectorX& command,
               const Known& known) noexcept;
  double apply(const Observation& o, const Allowed& allowed, std::span<const PlaceSpread> spreads,
               VectorX& command) noexcept {
    return apply(o, allowed, spreads, command, Known{});
  }

  /// Least distance to objects at rest on the way to a stop, as far as it is below the margin, else infinite. That to
  /// the floor and to itself counts with what the margin is above theirs added. Objects are where the last apply()
  /// found them.
  double least_distance(const Observation& o, const VectorX& command, bool in_proportion) noexcept;

 private:
  // A pair that may come too near on the way to a stop that is looked at.
  struct Candidate {
    PairKind kind;
    int first, second;
    double room;              // the way at which it may be at 0 [m]; infinite where it is clear to the end of the way
    double end = -kInfinity;  // no distance is less there [m]
  };
  // Those of one shape and objects.
  struct Group {
    int shape;
    std::size_t begin, end;
    double least_room;
  };

  void begin(const Observation& o, const Known& known) noexcept;
  void choose_candidates() noexcept;
  double object_bound(int shape, int object) noexcept;
  double range_of(PairKind kind) const noexcept;
  void leave_out_by_end() noexcept;
  double way_of_own(const Candidate& own, const VectorX& gone) const noexcept;
  double way_to_stop(const Observation& o, const VectorX& command, bool in_proportion, double floor) noexcept;
  bool place() noexcept;
  double measure(Candidate& candidate, double way, double to_come) noexcept;
  double clearance(const Observation& o, const VectorX& command, double floor) noexcept;
  double distance() noexcept;
  double margin_of(const ProximityPair& pair) noexcept;
  double widest_margin(const Observation& o) noexcept;

  std::shared_ptr<const RobotModel> model_;
  BrakeCheckParams params_;
  OwnMargins own_;
  double dt_, hold_;
  Kinematics kinematics_;
  Proximity proximity_;
  BaseRamp ramp_;
  Deceleration deceleration_;
  Uncertainty uncertainty_;
  std::span<const PlaceSpread> spreads_;  // of the present step
  double widest_ = 0.0;                   // margin that is thought of
  Matrix3X J_;
  VectorX row_;
  VectorX q_, mean_, times_;
  VectorX trial_, full_, in_proportion_;
  Vector3 base_ = Vector3::Zero();
  std::vector<ObjectState> states_;

  ShapeWays ways_;
  VectorX gone_, whole_;  // of each velocity so far, and by all of the way
  // No distance is less than these as the step begins: of shapes and objects, of shapes, of the model's self pairs.
  std::vector<double> object_bounds_, floor_bounds_, self_bounds_;
  std::vector<double> radii_;                                          // of the objects
  std::vector<char> sharp_;                                            // whether an object's is as good as is cheap
  std::vector<int> self_at_;                                           // place of a pair of shapes in the model's list
  enum class Placed { kNot, kAtStart, kHere } placed_ = Placed::kNot;  // what proximity_ has of the robot
  const Kinematics* start_ = nullptr;                                  // the robot as the step begins
  Kinematics own_start_;
  std::vector<Candidate> candidates_;  // those of groups first
  std::vector<Group> groups_;
  std::size_t grouped_ = 0;
  bool open_ = false;
};

}  // namespace moma
