#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "controller/plan/path.h"
#include "controller/plan/route.h"
#include "controller/plan/search.h"
#include "controller/plan/smooth_path.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// Stage of a plan.
enum class PlanStage { kIdle, kGoals, kRoute, kSearch, kShorten, kLay, kSmooth, kFound, kFailed };

/// Directions that a goal leaves free (GoalState::free), and its axes, in which places along them lie.
struct FreeDirections {
  Vector6 free = Vector6::Zero();
  Matrix3 R_WG = Matrix3::Identity();

  bool any() const noexcept { return !free.isZero(0.0); }
};

/// Work of one plan.
struct PlanCounts {
  long checks = 0;
  int ik_tries = 0;
  int goals = 0;
  int runs = 0;
};

/// Plans a timed path of base and arm to one of many configurations with E at the goal:
///
/// 1. Whole-body inverse kinematics give goal configurations that the controller's rows admit (whole_body_ik.h), the
///    cheapest first. A configuration counts from the first tier in which it is free. For a goal with free directions,
///    every second try draws the free coordinates.
/// 2. Routes of the base with its arm tucked lead to some of them (route.h). The first one on which the robot moves
///    freely from start to goal counts (smooth_path.h).
/// 3. Without one, a search gives edges to one of them (search.h), and shortcuts shorten them (shorten.h). Each further
///    run searches the ellipse in which a quicker way can lie. The quickest counts.
/// 4. A path overlaps the motions of the edges if half the clearances hold, otherwise it runs them in turn (path.h). It
///    gives way to one past its corners that is quicker (smooth_path.h).
///
/// Routes and paths past corners are those of robots that drive, to goals that are not close to an object.
///
/// Tiers relax the clearance in this order: `roomy`; `clearance`; the mean of `clearance` and its share `search.tight`;
/// that share. The last two have no margins of joint limits. If the hand at its goal is nearer to an object than
/// `clearance`, every tier keeps less near the goal (`at_goal`), the last tier least, and the tier of the mean is
/// skipped. The work consists of pieces (one inverse kinematics, or one edge's checks); the plan does not depend on how
/// they are spread over control steps. No clock decides anything, and all draws come from the seed. Only construction
/// and set_objects() allocate.
class Planner {
 public:
  Planner(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void set_objects(std::span<const ObjectShape> objects);
  /// Keeps the tool upright in the plans that begin from now on.
  void keep_upright(const std::optional<Upright>& upright) noexcept;
  /// Plans from the next begin() on for a base whose drive has this share of its accelerations.
  void set_drive(double share) noexcept { limits_.set_drive(share); }
  /// Begins a plan from `start`, where the robot rests after `braking`, among visible objects at rest. Its path
  /// includes the braking. The plan fails if it finds no path that takes less than `within` seconds after the braking.
  /// If goal and objects are those of the last plan, it keeps that plan's goal configurations and their tree and
  /// continues in its tier, with twice the work if it failed.
  void begin(const WholeConfiguration& start, const Isometry& X_WG, std::span<const ObjectState> objects,
             std::uint64_t seed, double within = kInfinity, const Braking& braking = {},
             const FreeDirections& free = {}) noexcept;
  /// Works until `budget` checks are spent or the plan ends; subtracts them. The last piece of work may leave `budget`
  /// negative. True if work is left.
  bool advance(long& budget) noexcept;

  /// Ends with the best run so far, or with the present one if it is the first.
  void hurry() noexcept;

  PlanStage stage() const noexcept { return stage_; }
  bool found() const noexcept { return stage_ == PlanStage::kFound; }
  /// The path, once found.
  const Path& path() const noexcept { return path_; }
  /// True if the hand is nearer to an object at the goal than the clearance, in the last plan.
  bool close_goal() const noexcept { return needed_ < kInfinity; }
  const PlanCounts& counts() const noexcept { return counts_; }
  const MotionLimits& limits() const noexcept { return limits_; }
  /// Goal configurations of the plan's tier, the cheapest first once the search begins.
  std::span<const GoalConfiguration> goals() const noexcept {
    return std::span(goals_).first(static_cast<std::size_t>(usable_goals()));
  }
  /// The space in which the plan's tier searches: its objects, clearances and joint ranges.
  FreeSpace& space() noexcept { return space_; }
  /// The shortened edges, once a path is found.
  const EdgeList& edges() const noexcept { return best_; }

 private:
  bool busy() const noexcept {
    return stage_ != PlanStage::kFound && stage_ != PlanStage::kFailed && stage_ != PlanStage::kIdle;
  }
  void work() noexcept;
  void set_turn(bool stays) noexcept;
  void set_tiers(int first) noexcept;
  void keep(int tier) noexcept { space_.keep(tiers_[static_cast<std::size_t>(tier)]); }
  void begin_tier(int tier) noexcept;
  bool next_tier() noexcept;
  int usable_goals() const noexcept;
  bool same_world(const Isometry& X_WG, std::span<const ObjectState> objects) const noexcept;
  void begin_search() noexcept;
  void try_goal() noexcept;
  Isometry near_goal() noexcept;
  Isometry allowed_pose() noexcept;
  double needed_at_goal() noexcept;
  void take_goal(GoalConfiguration& goal) noexcept;
  long tier_checks() const noexcept;
  int last_tier() const noexcept;
  int after(int tier) const noexcept;
  bool within_rows(const WholeConfiguration& c) noexcept;
  void begin_runs() noexcept;
  void begin_run() noexcept;
  void take_edges() noexcept;
  void end_tier() noexcept;
  void lay() noexcept;
  void label_path() noexcept;
  /// True for a path past its corners: of a robot that drives, to a goal that is not close to an object.
  bool smooths() const noexcept { return limits_.mobile() && !close_goal() && params_.smooth.tries > 0; }
  double beyond() const noexcept { return tier_ == kRoomy ? params_.search.roomy_beyond : params_.search.beyond; }
  void begin_route() noexcept;
  void begin_smooth() noexcept;
  void end_smooth() noexcept;
  /// The path counts if it takes less than it may.
  void finish() noexcept;

  PlanParams params_;
  MotionLimits limits_;
  FreeSpace space_;
  WholeBodyIk ik_;
  Search search_;
  VectorX tuck_;
  Clearances least_;  // of a goal, however near the start is to something
  GoalClearanceParams at_goal_;
  double position_, orientation_;  // tolerances of the goal [m, rad]
  std::optional<Upright> upright_;
  double upright_share_;       // of its angle, in plans
  double needed_ = kInfinity;  // the hand's distance at the goal; infinite where it is not below the clearance [m]
  int effort_ = 1;
  bool goes_on_ = false;  // with goal configurations and tree of the last plan

  PlanStage stage_ = PlanStage::kIdle;
  WholeConfiguration start_;
  Braking braking_;
  WholeConfiguration turn_;  // joints that wind keep to its turn
  Isometry X_WG_ = Isometry::Identity();
  FreeDirections free_;
  CountedDraws draws_;
  enum Tier { kRoomy, kClear, kNarrow, kTight, kTiers };
  std::array<Keeps, kTiers> tiers_;
  int tier_ = kRoomy;
  std::vector<GoalConfiguration> goals_;  // from the search on those of the tier first, the cheapest first
  double within_ = 0.0;
  int late_ = 0;   // goal configurations that are too far away
  int tries_ = 0;  // of inverse kinematics, in this tier
  int run_ = 0;    // of the search, in this tier
  long search_end_ = 0;
  double longest_ = 0.0;
  int shortcut_ = 0, shortened_ = 0;  // tries so far, at the last that was taken
  EdgeList edges_, work_, best_;
  double best_time_ = 0.0;
  double overlap_ = 0.0;
  int laid_ = 0;  // moments of the path that are known to be clear
  Path path_;
  Route route_;
  int routes_ = 0;  // tried in this tier; 0 while a search's path becomes smooth
  SmoothPath smooth_;
  std::vector<WholeConfiguration> corners_;
  PlanCounts counts_;
};

}  // namespace moma
