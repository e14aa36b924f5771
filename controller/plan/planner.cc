#include "controller/plan/planner.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "controller/plan/shorten.h"
#include "controller/plan/tuck.h"

namespace moma {
namespace {

// Moments at which a path is looked at [s]; the way between them is less than that of the edges' checks.
constexpr double kMoment = 0.08;
// Added to the best run's way for the ellipse of the next [m].
constexpr double kMoreWay = 0.3;
constexpr double kAnyLength = 1e18;
// Part of an edge's time that may be left where it overlaps with others, and of the best run's after further runs.
constexpr double kOverlapped = 0.75, kShortened = 0.6;
// Distances and margins of a plan, the widest first.
struct Tier {
  bool roomy;     // the roomy clearance, else the smaller one,
  double part;    // or this part of it
  bool close;     // the goal is approached as closely as `at_goal` lets it, whatever the hand needs
  double room;    // part of the joints' margins
  double beyond;  // how far beyond start and goal a way may lead [m]
};
constexpr Tier kTiers[] = {{true, 1.0, false, 1.0, 1.5},
                           {false, 1.0, false, 1.0, 2.5},
                           {false, 0.3, true, 0.25, 2.5},
                           {false, 0.3, true, 0.02, 2.5}};
// Goals that are as close as rows let them be would be reached never: they keep so much more [1].
constexpr double kCloser = 1.7;
constexpr int kMostEffort = 16;
// In narrow places most steps of a tree are blocked; shorter ones get on.
constexpr int kShortenings = 3;
// A goal keeps so much more than the rows' stop distances: there they would not let the robot arrive [m].
constexpr double kWithinRows = 0.002;

double least_of(const DamperParams& rows, double clearance) noexcept {
  return rows.enabled ? std::min(clearance, rows.stop + kWithinRows) : 0.0;
}

}  // namespace

Planner::Planner(std::shared_ptr<const RobotModel> model, const ControllerParams& params)
    : model_(model),
      params_(params.plan),
      limits_(std::make_unique<const MotionLimits>(*model, params)),
      space_(model, *limits_),
      ik_(model, *limits_),
      search_(*limits_, params.plan.check_step),
      tuck_(tucked_arm(*model, space_, {-1.0, params.plan.self, params.plan.self})),
      least_{-1.0, least_of(params.collision.floor, params.plan.self),
             least_of(params.collision.self, params.plan.self)},
      at_goal_(params.collision.at_goal),
      goal_clearance_(*model) {
  // Some links are nearer to each other than that however the arm is held.
  WholeConfiguration ready = WholeConfiguration::Zero(3 + model->num_joints());
  ready.tail(model->num_joints()) = model->ready;
  space_.set_clearances(least_, ready);
  least_ = space_.clearances();
  least_.object = least_of(params.collision.object, params.plan.clearance);
  goals_.reserve(static_cast<std::size_t>(params_.ik_enough));
}

void Planner::set_objects(std::span<const ObjectShape> objects) {
  space_.set_objects(objects);
  goal_clearance_.allocate(objects.size());
  stage_ = PlanStage::kIdle;
}

void Planner::begin(const WholeConfiguration& start, const Isometry& X_WG, std::span<const ObjectState> objects,
                    std::uint64_t seed, double within) noexcept {
  const bool goes_on = stage_ != PlanStage::kIdle && same_world(X_WG, objects);
  const bool failed = stage_ == PlanStage::kFailed;
  within_ = within;
  start_ = start;
  X_WG_ = X_WG;
  draws_ = {seed, 0};
  space_.set_states(objects);
  counts_ = {};
  needed_ = kInfinity;
  if (at_goal_.enabled) {
    const double needed = space_.least_at_goal(goal_clearance_, start, X_WG, params_.clearance);
    if (needed < params_.clearance) needed_ = needed;
  }
  // Where the hand is near to something at its goal, no way is roomy.
  const int first = needed_ < kInfinity && params_.roomy > params_.clearance ? 1 : 0;
  if (!goes_on) effort_ = 1;
  if (goes_on && failed) effort_ = std::min(2 * effort_, kMostEffort);
  begin_tier(goes_on && !failed ? tier_ : first, goes_on && !failed);
}

// Seen within what sensors that are filtered say of the same place.
bool Planner::same_world(const Isometry& X_WG, std::span<const ObjectState> objects) const noexcept {
  constexpr double kMoved = 1e-3, kTurned = 2e-3;  // [m, rad]
  const auto same = [](const Isometry& a, const Isometry& b) {
    return (a.translation() - b.translation()).squaredNorm() < kMoved * kMoved &&
           (a.linear() - b.linear()).squaredNorm() < 2.0 * kTurned * kTurned;
  };
  if (!same(X_WG, X_WG_) || objects.size() != space_.states().size()) return false;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectState& then = space_.states()[i];
    const bool counts = objects[i].visible && !in_motion(objects[i]);
    if (counts != then.visible || (counts && !same(objects[i].X_WO, then.X_WO))) return false;
  }
  return true;
}

bool Planner::advance(long& budget) noexcept {
  while (budget > 0 && stage_ != PlanStage::kFound && stage_ != PlanStage::kFailed && stage_ != PlanStage::kIdle) {
    const long before = space_.checks();
    work();
    const long used = std::max(1L, space_.checks() - before);
    counts_.checks += used;
    budget -= used;
  }
  return stage_ != PlanStage::kFound && stage_ != PlanStage::kFailed && stage_ != PlanStage::kIdle;
}

void Planner::begin_tier(int tier, bool goes_on) noexcept {
  tier_ = tier;
  const Clearances before = space_.clearances();
  const Tier& now = kTiers[tier];
  const double object = now.roomy ? std::max(params_.roomy, params_.clearance) : now.part * params_.clearance;
  space_.set_clearances({object, params_.self, params_.self}, start_, now.room);
  ik_.keep_room(now.room);
  // Half way between what rows keep and what the hand has.
  double kept = 0.5 * (1.0 + at_goal_.part) * needed_;
  if (now.close) kept = 0.0;
  kept = std::max(kept, kCloser * at_goal_.least);
  space_.keep_near({kept < object ? kept : kInfinity, at_goal_.slope, X_WG_.translation()});
  late_ = 0;
  stage_ = PlanStage::kGoals;
  // Joints that wind keep to the start's turn, and a start that is near to something lessens clearances.
  goes_on_ = goes_on && limits_->winds.isZero() && before == space_.clearances();
  if (!goes_on_) {
    goals_.clear();
    tries_ = 0;
    return;
  }
  for (GoalConfiguration& goal : goals_) {
    const double time = edge_time(*limits_, start_, goal.c);
    goal.cost += time - goal.time;
    goal.time = time;
  }
}

void Planner::work() noexcept {
  switch (stage_) {
    case PlanStage::kGoals:
      try_goal();
      break;
    case PlanStage::kSearch:
      switch (search_.advance(space_, draws_)) {
        case SearchProgress::kMore:
          if (counts_.checks >= search_end_) end_tier();
          break;
        case SearchProgress::kDone:
          end_run(true);
          break;
        case SearchProgress::kFailed:
          end_run(false);
          break;
      }
      break;
    case PlanStage::kShorten:
      if (shortcut_ < params_.shortcuts && (edges_.size() > 1 || shortcut_ <= 10)) {
        try_shortcut(space_, params_.check_step, shortcut_++, draws_, edges_, work_, spare_);
        break;
      }
      if (edges_.time() < best_time_) {
        best_time_ = edges_.time();
        best_.swap(edges_);
        longest_ = best_.base_way() + kMoreWay;
      }
      if (best_.size() == 1 || run_ >= params_.runs || counts_.checks >= search_end_ ||
          kShortened * best_time_ > within_)
        end_tier();
      else
        begin_run();
      break;
    case PlanStage::kLay:
      lay();
      break;
    case PlanStage::kIdle:
    case PlanStage::kFound:
    case PlanStage::kFailed:
      break;
  }
}

void Planner::try_goal() noexcept {
  if (goes_on_ && !goals_.empty()) return begin_search();
  GoalConfiguration goal;
  ++counts_.ik_tries;
  if (ik_.find(space_, X_WG_, params_.roomy, start_, tries_++, draws_, goal) && within_rows(goal.c)) {
    if (kOverlapped * goal.time > within_)
      ++late_;
    else
      goals_.push_back(goal);
  }
  if (tries_ < effort_ * params_.ik_tries && static_cast<int>(goals_.size()) + late_ < params_.ik_enough) return;
  begin_search();
}

void Planner::begin_search() noexcept {
  counts_.goals = static_cast<int>(goals_.size());
  best_.clear();
  best_time_ = std::numeric_limits<double>::infinity();
  if (goals_.empty()) {
    end_tier();
    return;
  }
  // Insertion: stable, few of them, and it takes no memory.
  for (std::size_t i = 1; i < goals_.size(); ++i)
    for (std::size_t j = i; j > 0 && goals_[j].cost < goals_[j - 1].cost; --j) std::swap(goals_[j], goals_[j - 1]);
  const bool half = tier_ == 0 && params_.roomy > params_.clearance;
  search_end_ = counts_.checks + static_cast<long>(effort_) * (half ? params_.checks / 2 : params_.checks);
  run_ = 0;
  longest_ = within_ < kAnyLength ? within_ * limits_->linear : kAnyLength;
  begin_run();
}

bool Planner::within_rows(const WholeConfiguration& c) noexcept {
  const Clearances& now = space_.clearances();
  if (now.object >= least_.object && now.floor >= least_.floor && now.self >= least_.self) return true;
  return space_.clear(
      c, {std::max(now.object, least_.object), std::max(now.floor, least_.floor), std::max(now.self, least_.self)});
}

void Planner::begin_run() noexcept {
  ++run_;
  ++counts_.runs;
  search_.begin({start_, X_WG_.translation().head<2>(), goals_, params_.roots, &tuck_, kTiers[tier_].beyond,
                 space_.kept().at_goal < kInfinity ? kShortenings : 0, longest_},
                goes_on_ && run_ == 1);
  stage_ = PlanStage::kSearch;
}

void Planner::end_run(bool found) noexcept {
  if (!found) {
    end_tier();
    return;
  }
  edges_.clear();
  for (const Edge& edge : search_.edges().all()) edges_.push(edge);
  shortcut_ = 0;
  stage_ = PlanStage::kShorten;
}

void Planner::end_tier() noexcept {
  if (!best_.empty()) {
    overlap_ = params_.overlap;
    laid_ = -1;
    stage_ = PlanStage::kLay;
  } else if ((late_ > 0 && goals_.empty()) || !next_tier()) {
    stage_ = PlanStage::kFailed;
  }
}

// False where there is none that keeps less.
bool Planner::next_tier() noexcept {
  int next = tier_ + 1;
  if (next == 1 && params_.roomy <= params_.clearance) ++next;
  if (next == static_cast<int>(std::size(kTiers)) || (kTiers[next].close && !at_goal_.enabled)) return false;
  begin_tier(next, false);
  return true;
}

// Half the clearances are enough for what the overlaps cut off. Without overlaps the path is that of the edges.
void Planner::lay() noexcept {
  if (laid_ < 0) {
    if (!lay_path(*limits_, best_.all(), overlap_, path_)) {
      stage_ = PlanStage::kFailed;
      return;
    }
    path_.X_WG = X_WG_;
    path_.clearance = space_.clearances().object;
    path_.kept_at_goal = space_.kept().at_goal;
    laid_ = 0;
  }
  constexpr int kAtOnce = 16;
  const Clearances& whole = space_.clearances();
  const Clearances half{0.5 * whole.object, 0.5 * whole.floor, 0.5 * whole.self};
  for (int k = 0; k < kAtOnce; ++k) {
    const double t = kMoment * laid_++;
    path_.at(std::min(t, path_.duration), spare_.a);
    if (!space_.clear(spare_.a, half)) {
      if (overlap_ > 0.0) {
        overlap_ = 0.0;
        laid_ = -1;
      } else {
        stage_ = PlanStage::kFailed;
      }
      return;
    }
    if (t >= path_.duration) {
      stage_ = PlanStage::kFound;
      return;
    }
  }
}

}  // namespace moma
