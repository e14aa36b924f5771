#pragma once

#include <array>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "controller/plan/path.h"
#include "controller/plan/search.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// How far a plan has come.
enum class PlanStage { kIdle, kGoals, kSearch, kShorten, kLay, kFound, kFailed };

/// What was done for one plan.
struct PlanCounts {
  long checks = 0;
  int ik_tries = 0;
  int goals = 0;
  int runs = 0;
};

/// A timed path of base and arm from where the robot is to one of many configurations that put E at the goal:
///
/// 1. goal configurations by whole-body inverse kinematics (whole_body_ik.h) that the controller's rows let the robot
///    reach, the cheapest first; each counts from the first tier on in which it is free;
/// 2. edges to one of them (search.h), shortened (shorten.h); several runs, each in the ellipse that the best one
///    leaves open, the quickest counts;
/// 3. a path of motions that overlap where half the clearances hold, one after another where they do not (path.h).
///
/// All of it at the roomy clearance first, then at the smaller one, then with part of that, the goal approached more
/// closely and joints nearer to their limits. Where the hand itself is nearer to an object at the goal than the
/// clearance, what is kept shrinks towards that in every tier (`at_goal`). The work is cut into pieces of one inverse
/// kinematics or one edge's checks, so that it can be spread over control steps: the same plan comes out however it is
/// spread. No clock decides anything, all draws come from the seed. After set_objects() nothing takes memory.
class Planner {
 public:
  Planner(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void set_objects(std::span<const ObjectShape> objects);
  /// Begins a plan among the objects that are seen and at rest. The start is where the robot stands. What would take
  /// longer than `within` [s] is not looked for: the plan fails where there is nothing else. Where goal and objects are
  /// those of the last plan, its goal configurations and the tree that grew from them are kept, and the plan goes on in
  /// the tier in which that one ended, with twice the work where it failed.
  void begin(const WholeConfiguration& start, const Isometry& X_WG, std::span<const ObjectState> objects,
             std::uint64_t seed, double within = std::numeric_limits<double>::infinity()) noexcept;
  /// Works until `budget` checks are used up or the plan is found or failed; takes what it used from `budget`, which a
  /// last piece of work may leave below zero. True as long as there is more to do.
  bool advance(long& budget) noexcept;

  /// Ends with the best of the runs so far, or with this one where it is the first.
  void hurry() noexcept;

  PlanStage stage() const noexcept { return stage_; }
  bool found() const noexcept { return stage_ == PlanStage::kFound; }
  /// Of a plan that was found.
  const Path& path() const noexcept { return path_; }
  /// Whether the hand is nearer to an object at the goal than the clearance, in the last plan.
  bool close_goal() const noexcept { return needed_ < kInfinity; }
  const PlanCounts& counts() const noexcept { return counts_; }
  const MotionLimits& limits() const noexcept { return *limits_; }
  const VectorX& tuck() const noexcept { return tuck_; }
  /// The goal configurations of the plan's tier, the cheapest first from the search on.
  std::span<const GoalConfiguration> goals() const noexcept {
    return std::span(goals_).first(static_cast<std::size_t>(usable_goals()));
  }
  /// The shortened edges of a plan that was found.
  const EdgeList& edges() const noexcept { return best_; }

 private:
  void work() noexcept;
  void set_turn(bool stays) noexcept;
  void set_tiers(int first) noexcept;
  void begin_tier(int tier) noexcept;
  bool next_tier() noexcept;
  int usable_goals() const noexcept;
  bool same_world(const Isometry& X_WG, std::span<const ObjectState> objects) const noexcept;
  void begin_search() noexcept;
  void try_goal() noexcept;
  void take_goal(GoalConfiguration& goal) noexcept;
  long tier_checks() const noexcept;
  int last_tier() const noexcept;
  bool within_rows(const WholeConfiguration& c) noexcept;
  void begin_run() noexcept;
  void end_run(bool found) noexcept;
  void take_edges() noexcept;
  void end_tier() noexcept;
  void lay() noexcept;

  std::shared_ptr<const RobotModel> model_;
  PlanParams params_;
  std::unique_ptr<const MotionLimits> limits_;
  FreeSpace space_;
  WholeBodyIk ik_;
  Search search_;
  VectorX tuck_;
  Clearances least_;  // of a goal, however near the start is to something
  GoalClearanceParams at_goal_;
  GoalClearance goal_clearance_;
  double needed_ = kInfinity;  // the hand's distance at the goal; infinite where it is not below the clearance [m]
  int effort_ = 1;
  bool goes_on_ = false;  // with goal configurations and tree of the last plan

  PlanStage stage_ = PlanStage::kIdle;
  WholeConfiguration start_;
  WholeConfiguration turn_;  // joints that wind keep to its turn
  Isometry X_WG_ = Isometry::Identity();
  CountedDraws draws_;
  static constexpr int kTiers = 3;
  std::array<Keeps, kTiers> tiers_;
  int tier_ = 0;
  std::vector<GoalConfiguration> goals_;  // from the search on those of the tier first, the cheapest first
  double within_ = 0.0;
  int late_ = 0;   // goal configurations that are too far away
  int tries_ = 0;  // of inverse kinematics, in this tier
  int run_ = 0;    // of the search, in this tier
  long search_end_ = 0;
  double longest_ = 0.0;
  int shortcut_ = 0;
  EdgeList edges_, work_, best_;
  Edge spare_;
  double best_time_ = 0.0;
  double overlap_ = 0.0;
  int laid_ = 0;  // moments of the path that are known to be clear
  Path path_;
  PlanCounts counts_;
};

}  // namespace moma
