#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/plan/free_space.h"
#include "controller/plan/glide.h"
#include "controller/plan/passing_way.h"
#include "controller/plan/steered_drive.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// Searches the quickest way without a corner to the goal: from rest, base and arm move straight; from a motion they go
/// over into a straight one (glide.h); a differential base steers to its place (steered_drive.h). Whole-body inverse
/// kinematics around the start give end configurations, and the robot's speeds and accelerations the time to each. The
/// quickest free way counts. Further tries around its end shorten it, until too many in a row do not.
///
/// A goal at which the hand is nearer to an object than a path's clearance has no direct way, nor has a moving start
/// that is; the planner serves them (planner.h). The work consists of pieces (one try, or the checks of one way);
/// its result does not depend on how they are spread over control steps. Only construction and set_objects() allocate.
class DirectWay {
 public:
  DirectWay(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void set_objects(std::span<const ObjectShape> objects);
  /// Keeps the tool upright on the ways that begin from now on.
  void keep_upright(const std::optional<Upright>& upright) noexcept { upright_ = upright; }
  /// As Planner::set_drive().
  void set_drive(double share) noexcept { limits_.set_drive(share); }
  void begin(const MotionState& start, const Isometry& X_WG, std::span<const ObjectState> objects) noexcept;
  /// Begins a search for a way through the goal at X_WG to the one at X_WN, in less than `within` seconds. A try is a
  /// way to the goal (passing_way.h), past the configuration `pass` or near it, and the quickest of a few direct ways
  /// from there; some end near `last`. It counts if it is free and the quickest so far; further tries vary it. All
  /// draws come from `seed`.
  void begin_passing(const MotionState& start, const Isometry& X_WG, const Isometry& X_WN,
                     const WholeConfiguration& pass, const WholeConfiguration& last, double within, std::uint64_t seed,
                     std::span<const ObjectState> objects) noexcept;
  /// Works until `budget` checks are spent or the search is complete; subtracts them. True if work is left.
  bool advance(long& budget) noexcept;

  /// True if a free way is known; path() is the quickest so far.
  bool found() const noexcept { return passes_ ? pass_path_.passes() : best_.time < kInfinity; }
  const Path& path() const noexcept { return passes_ ? pass_path_ : best_path_; }
  /// True if the hand is nearer to an object at the goal than `clearance`: such a goal has no direct way.
  bool close_goal() const noexcept { return close_goal_; }
  const MotionLimits& limits() const noexcept { return limits_; }

 private:
  struct End {
    WholeConfiguration c;             // end of a way
    Vector2 point = Vector2::Zero();  // the point to which a differential base steers [m]
    bool stays = false;               // the base does not move, or only comes to rest
    double time = kInfinity;          // time of the way [s]
  };
  enum class Stage { kPassing, kEnds, kPass, kOn, kTries, kChecks, kAround, kDone };

  bool clear(const MotionState& start, const Isometry& X_WG, std::span<const ObjectState> objects) noexcept;
  void work() noexcept;
  void try_passing() noexcept;
  void try_end() noexcept;
  void take_passing() noexcept;
  void seed(End& end) noexcept;
  void seed_near(const WholeConfiguration& around, End& end) noexcept;
  bool make(End& end) noexcept;
  bool drive_to(const End& end) noexcept;
  bool is_free(const Path& path) noexcept;
  bool take(const End& end) noexcept;
  bool steers(const End& end) const noexcept {
    return limits_.base->nonholonomic() && (!end.stays || !start_.v.head<3>().isZero(0.0));
  }
  void lay(const End& end) noexcept;
  void lay_from_rest(const End& end) noexcept;
  void lay_glides(const End& end) noexcept;

  MotionLimits limits_;
  PlanParams params_;
  FreeSpace space_;
  WholeBodyIk ik_;
  SteeredDrive drive_;
  PassingWay passing_;

  Stage stage_ = Stage::kDone;
  std::optional<Upright> upright_;
  double upright_share_;  // of its angle, on the ways
  bool close_goal_ = false;
  MotionState start_;
  Isometry X_WG_ = Isometry::Identity();
  CountedDraws draws_;
  int tries_ = 0;
  std::vector<End> ends_;  // the quickest first
  std::size_t next_ = 0;   // the next one of them to be checked, or to be tried past a goal
  End best_;
  Edge edge_;
  Path path_, best_path_;
  bool passes_ = false;
  WholeConfiguration last_;       // the end of the path so far
  double pass_time_ = kInfinity;  // of the best way through the goal, or in which it has to be [s]
  double first_time_ = 0.0;       // of the present try's way to the goal [s]
  End on_;                        // and its way on from there
  Path first_path_, pass_path_;   // to the goal, and the best one through it
  double longest_ = 0.0;          // approximate travel of the robot's farthest point on path_ [m]
};

}  // namespace moma
