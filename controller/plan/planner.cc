#include "controller/plan/planner.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "controller/plan/shorten.h"
#include "controller/plan/tuck.h"

namespace moma {
namespace {

// Interval between checked moments of a path [s], in which it moves less than between the checks of edges.
constexpr double kMoment = 0.08;
// Added to the best run's way for the ellipse of the next [m].
constexpr double kMoreWay = 0.3;
// Least share of an edge's time that overlaps leave, and of the best run's time that further runs leave.
constexpr double kOverlapped = 0.75, kShortened = 0.6;
// Part of the joints' margins that is kept in each tier.
constexpr std::array<double, 4> kRoom{1.0, 1.0, 0.0, 0.0};
// Distance of goals beyond the rows' stop distances, at which the robot would not arrive [m].
constexpr double kWithinRows = 0.002;
// Most goal configurations, whatever the gains: they are kept and compared one by one.
constexpr int kMostGoals = 2000;
// Poses of a goal with free directions whose distances from objects are looked at.
constexpr int kPoses = 8;

double least_of(const DamperParams& rows, double clearance) noexcept {
  return rows.enabled ? std::min(clearance, rows.stop + kWithinRows) : 0.0;
}

}  // namespace

Planner::Planner(std::shared_ptr<const RobotModel> model, const ControllerParams& params)
    : params_(params.plan),
      limits_(*model, params),
      space_(model, limits_),
      ik_(model, params.plan.ik, limits_),
      search_(limits_, params.plan.search, params.plan.check_step),
      tuck_(tucked_arm(*model, space_, {-1.0, params.plan.self, params.plan.self})),
      least_{-1.0, least_of(params.collision.floor, params.plan.self),
             least_of(params.collision.self, params.plan.self)},
      at_goal_(params.collision.at_goal),
      position_(params.escape.position),
      orientation_(params.escape.orientation),
      upright_share_(params.upright.plan),
      route_(limits_, params_),
      smooth_(limits_, params_, space_, ik_) {
  // Some links are nearer to each other than that in every configuration.
  WholeConfiguration ready = WholeConfiguration::Zero(3 + model->num_joints());
  ready.tail(model->num_joints()) = model->ready;
  space_.set_clearances(least_, ready);
  least_ = space_.clearances();
  least_.object = least_of(params.collision.object, params.plan.clearance);
  static_assert(SmoothPath::kMostCorners == EdgeList::kMost + 1);
  corners_.reserve(SmoothPath::kMostCorners);
  goals_.reserve(
      static_cast<std::size_t>(std::min(kMostGoals, params_.search.goals * params_.search.effort * params_.ik_enough)));
  tiers_.fill(space_.keeps());
}

void Planner::set_objects(std::span<const ObjectShape> objects) {
  space_.set_objects(objects);
  stage_ = PlanStage::kIdle;
}

void Planner::keep_upright(const std::optional<Upright>& upright) noexcept {
  if (upright == upright_) return;
  upright_ = upright;
  stage_ = PlanStage::kIdle;  // what the last plan found may tilt the tool
}

void Planner::begin(const WholeConfiguration& start, const Isometry& X_WG, std::span<const ObjectState> objects,
                    std::uint64_t seed, double within, const Braking& braking, const FreeDirections& free) noexcept {
  const bool same = stage_ != PlanStage::kIdle && !free.any() && same_world(X_WG, objects);
  if (!same) effort_ = 1;
  if (same && stage_ == PlanStage::kFailed) effort_ = std::min(2 * effort_, params_.search.effort);
  within_ = within;
  start_ = start;
  braking_ = braking;
  X_WG_ = X_WG;
  free_ = free;
  draws_ = {seed, 0};
  space_.set_states(objects);
  space_.keep_upright(upright_, upright_share_, start, X_WG);
  counts_ = {};
  needed_ = kInfinity;
  if (at_goal_.enabled) {
    const double needed = needed_at_goal();
    if (needed < params_.clearance) needed_ = needed;
  }
  // If the hand is near an object at its goal, no way is roomy.
  const int first = close_goal() && params_.roomy > params_.clearance ? kClear : kRoomy;
  const Keeps before = tiers_[static_cast<std::size_t>(tier_)];
  set_turn(same && close_goal());
  set_tiers(first);
  // A start that has moved away from an object may keep more than the last plan.
  goes_on_ =
      same && tier_ >= first && tier_ <= last_tier() && tiers_[static_cast<std::size_t>(tier_)].follows_from(before);
  if (!goes_on_) goals_.clear();
  if (goals_.empty()) tries_ = 0;  // objects may be measured a little elsewhere now
  for (GoalConfiguration& goal : goals_) {
    const double time = edge_time(limits_, start_, goal.c);
    goal.cost += time - goal.time;
    goal.time = time;
  }
  begin_tier(goes_on_ ? tier_ : first);
}

// Chooses the turn of joints that wind: the last plan's if it `stays` and no such joint has left its middle half,
// otherwise the start's.
void Planner::set_turn(bool stays) noexcept {
  for (int i = 0; stays && i < limits_.num_joints(); ++i)
    stays = limits_.winds[i] == 0 || std::abs(start_[3 + i] - turn_[3 + i]) < 0.25 * kFullTurn;
  if (!stays) turn_ = start_;
}

void Planner::set_tiers(int first) noexcept {
  const bool halved = close_goal() && effort_ >= params_.search.hard;
  const double tight = params_.tight() / (halved ? 2.0 : 1.0);
  const double arm = effort_ > params_.search.hard ? 0.5 * tight : tight;  // at the goal, one failed plan later
  const std::array<double, kTiers> objects{std::max(params_.roomy, params_.clearance), params_.clearance,
                                           0.5 * (1.0 + params_.search.tight) * params_.clearance, tight};
  for (int tier = first; tier < kTiers; ++tier) {
    const bool close = tier == kTight && close_goal();  // as close as `at_goal` lets rows be, whatever the hand needs
    const double object = objects[static_cast<std::size_t>(tier)];
    space_.set_clearances({object, params_.self, params_.self}, start_, turn_, kRoom[static_cast<std::size_t>(tier)]);
    // The mean of the rows' distance and the hand's own.
    double kept = close ? 0.0 : 0.5 * (1.0 + at_goal_.part) * needed_;
    kept = std::max(kept, params_.search.closer * at_goal_.least);
    space_.keep_near({kept < object ? kept : kInfinity, at_goal_.slope, X_WG_.translation()}, arm);
    tiers_[static_cast<std::size_t>(tier)] = space_.keeps();
  }
}

bool Planner::same_world(const Isometry& X_WG, std::span<const ObjectState> objects) const noexcept {
  const SearchParams& search = params_.search;
  if (objects.size() != space_.states().size() ||
      !stays({.X_WO = X_WG}, {.X_WO = X_WG_}, search.same_goal, search.same_goal_turn))
    return false;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectState& then = space_.states()[i];
    const bool counts = counts_for_plans(objects[i]);
    if (counts != then.visible || (counts && !stays(objects[i], then, search.same, search.same_turn))) return false;
  }
  return true;
}

bool Planner::advance(long& budget) noexcept {
  while (budget > 0 && busy()) {
    const long before = space_.checks();
    work();
    const long used = std::max(1L, space_.checks() - before);
    counts_.checks += used;
    budget -= used;
  }
  return busy();
}

void Planner::begin_tier(int tier) noexcept {
  tier_ = tier;
  keep(tier);
  late_ = 0;
  stage_ = PlanStage::kGoals;
}

int Planner::usable_goals() const noexcept {
  return static_cast<int>(
      std::count_if(goals_.begin(), goals_.end(), [&](const GoalConfiguration& goal) { return goal.tier <= tier_; }));
}

void Planner::work() noexcept {
  switch (stage_) {
    case PlanStage::kGoals:
      try_goal();
      break;
    case PlanStage::kRoute:
      if (const Progress progress = route_.advance(space_); progress == Progress::kFound) {
        ++routes_;
        smooth_.begin(route_.corners(), braking_, within_ + braking_.time);
        stage_ = PlanStage::kSmooth;
      } else if (progress == Progress::kNone) {
        begin_runs();
      }
      break;
    case PlanStage::kSearch:
      if (const Progress progress = search_.advance(space_, draws_); progress == Progress::kFound) {
        edges_ = search_.edges();
        shortcut_ = shortened_ = 0;
        stage_ = PlanStage::kShorten;
      } else if (progress == Progress::kNone || counts_.checks >= search_end_) {
        end_tier();
      }
      break;
    case PlanStage::kShorten: {
      const bool pulls = !smooths();  // edges that are smoothed afterwards need not be as short as they can be
      if (shortcut_ - (pulls ? shortened_ : 0) < params_.shortcuts && (edges_.size() > 1 || shortcut_ <= 10)) {
        if (try_shortcut(space_, params_.check_step, shortcut_++, pulls, draws_, edges_, work_)) shortened_ = shortcut_;
        break;
      }
      take_edges();
      if (best_.size() == 1 || run_ >= params_.runs || counts_.checks >= search_end_ ||
          kShortened * best_time_ > within_)
        end_tier();
      else
        begin_run();
      break;
    }
    case PlanStage::kLay:
      lay();
      break;
    case PlanStage::kSmooth:
      if (!smooth_.work()) end_smooth();
      break;
    case PlanStage::kIdle:
    case PlanStage::kFound:
    case PlanStage::kFailed:
      break;
  }
}

// Tries for a goal close to an object alternate with the last tier, in case all its configurations are near joint
// limits. If a plan found none, measured objects may lie where the hand would be, or the goal is measured beyond the
// arm's reach: then poses count from which the trial succeeds all the same.
void Planner::try_goal() noexcept {
  if (usable_goals() + late_ >= effort_ * params_.ik_enough || tries_ >= effort_ * params_.ik_tries)
    return begin_search();
  const int aim = close_goal() && tries_ % 2 == 1 ? last_tier() : tier_;
  ik_.keep_room(kRoom[static_cast<std::size_t>(aim)]);
  keep(aim);
  ++counts_.ik_tries;
  GoalConfiguration goal;
  const bool off = params_.search.off_goal > 0.0 && aim == last_tier() && goals_.empty() && effort_ > 1;
  const bool drawn = free_.any() && tries_ % 2 == 1;
  const Isometry X_WG = off ? near_goal() : drawn ? allowed_pose() : X_WG_;
  const bool hard = close_goal() && params_.ik.hard * static_cast<int>(goals_.size()) < tries_;
  if (ik_.find(space_, X_WG, start_, goals_, tries_++, draws_, hard, goal.c)) take_goal(goal);
  keep(tier_);
}

// Draws one of the poses that a goal with free directions allows: places up to ik.far from the nearest one, and any
// free rotation. With two free rotations R_GE is a swing about an axis between theirs (nearest_pose()).
Isometry Planner::allowed_pose() noexcept {
  Isometry X = X_WG_;
  Vector3 way = Vector3::Zero();
  for (int i = 0; i < 3; ++i)
    if (free_.free[3 + i] != 0.0) way[i] = draws_.uniform(-params_.ik.far, params_.ik.far);
  X.translation() += free_.R_WG * way;
  Vector3 axis = Vector3::Zero();
  int turns = 0;
  for (int i = 0; i < 3; ++i) {
    if (free_.free[i] == 0.0) continue;
    axis[i] = draws_.uniform(-1.0, 1.0);
    ++turns;
  }
  const double length = axis.norm();
  if (length < 1e-9) return X;
  const double angle = draws_.uniform(-std::numbers::pi, std::numbers::pi);
  const Matrix3 turn = Eigen::AngleAxisd(angle, axis / length).toRotationMatrix();
  X.linear() = (turns == 2 ? free_.R_WG : X_WG_.linear()) * turn;
  return X;
}

// Returns the hand's distance at the goal; the largest of some poses if it allows several.
double Planner::needed_at_goal() noexcept {
  const double range = params_.clearance;
  double needed = space_.least_at_goal(start_, X_WG_, range);
  for (int i = 0; i < kPoses && free_.any() && needed < range; ++i)
    needed = std::max(needed, space_.least_at_goal(start_, allowed_pose(), range));
  return needed;
}

// Draws a pose within a share of the goal's tolerances.
Isometry Planner::near_goal() noexcept {
  Vector3 way, turn;
  for (int i = 0; i < 3; ++i) {
    way[i] = draws_.uniform(-1.0, 1.0);
    turn[i] = draws_.uniform(-1.0, 1.0);
  }
  Isometry X = X_WG_;
  X.translation() += params_.search.off_goal * position_ * way / std::max(1.0, way.norm());
  turn *= params_.search.off_goal * orientation_ / std::max(1.0, turn.norm());
  const double angle = turn.norm();
  if (angle > 1e-9) X.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * X_WG_.linear();
  return X;
}

// Keeps a goal with the first tier in which it is free. An arm that stands finds the same ones again and again, and
// where a plan has failed, more of what it had do not help.
void Planner::take_goal(GoalConfiguration& goal) noexcept {
  const auto same = [&](const GoalConfiguration& other) {
    return limits_.distance_squared(other.c, goal.c) < params_.search.apart * params_.search.apart;
  };
  if (goals_.size() == goals_.capacity()) return;
  if ((effort_ > 1 || !limits_.mobile()) && std::any_of(goals_.begin(), goals_.end(), same)) return;
  const auto free = [&](int tier) {
    keep(tier);
    return space_.free(goal.c) && within_rows(goal.c);
  };
  goal.tier = last_tier();
  if (!free(goal.tier)) return;
  for (int tier = tier_; tier < last_tier(); tier = after(tier)) {
    if (!free(tier)) continue;
    goal.tier = tier;
    break;
  }
  keep(goal.tier);
  goal.time = edge_time(limits_, start_, goal.c);
  goal.cost = goal.time + ik_.penalty(space_, params_.roomy, goal.c);
  if (kOverlapped * goal.time > within_)
    late_ += goal.tier == tier_ ? 1 : 0;
  else
    goals_.push_back(goal);
}

void Planner::begin_search() noexcept {
  counts_.goals = usable_goals();
  best_.clear();
  best_time_ = kInfinity;
  if (counts_.goals == 0) {
    end_tier();
    return;
  }
  const auto before = [&](const GoalConfiguration& a, const GoalConfiguration& b) {
    const bool first = a.tier <= tier_, second = b.tier <= tier_;
    return first != second ? first : a.cost < b.cost;
  };
  std::sort(goals_.begin(), goals_.end(), before);
  longest_ = within_ * limits_.linear;
  if (smooths() && params_.smooth.routes > 0)
    begin_route();
  else
    begin_runs();
}

void Planner::begin_runs() noexcept {
  search_end_ = counts_.checks + static_cast<long>(effort_) * tier_checks();
  run_ = 0;
  begin_run();
}

// Returns half of the work for the roomy tier, and a quarter before the last tier for a close goal.
long Planner::tier_checks() const noexcept {
  if (tier_ == kRoomy && params_.roomy > params_.clearance) return params_.checks / 2;
  return close_goal() && tier_ != last_tier() ? params_.checks / 4 : params_.checks;
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
  const std::span<GoalConfiguration> goals = std::span(goals_).first(static_cast<std::size_t>(counts_.goals));
  const auto rooted = [](const GoalConfiguration& goal) { return goal.rooted; };
  const bool goes_on = goes_on_ && run_ == 1 && std::any_of(goals.begin(), goals.end(), rooted);
  if (!goes_on)
    for (GoalConfiguration& goal : goals_) goal.rooted = false;
  search_.begin({start_, X_WG_.translation().head<2>(), goals, effort_ * params_.roots, beyond(), longest_}, goes_on);
  stage_ = PlanStage::kSearch;
}

void Planner::take_edges() noexcept {
  if (edges_.time() >= best_time_) return;
  best_time_ = edges_.time();
  best_.swap(edges_);
  longest_ = best_.base_way() + kMoreWay;
}

void Planner::hurry() noexcept {
  run_ = params_.runs;
  if (stage_ == PlanStage::kSmooth) {
    smooth_.finish();
    end_smooth();
  }
  if (best_.empty() || (stage_ != PlanStage::kShorten && stage_ != PlanStage::kSearch)) return;
  if (stage_ == PlanStage::kShorten) take_edges();
  end_tier();
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

// The narrow tiers are for goals that nothing else reaches; a path that is only quicker keeps the clearance.
int Planner::last_tier() const noexcept { return at_goal_.enabled && !(within_ < kInfinity) ? kTight : kClear; }

// A goal close to an object has no narrow tier: what it needs is less at the goal alone.
int Planner::after(int tier) const noexcept { return tier + (tier + 1 == kNarrow && close_goal() ? 2 : 1); }

// False if this is the last tier. A start near an object lets the first two tiers keep the same.
bool Planner::next_tier() noexcept {
  int next = after(tier_);
  if (next == kClear && tiers_[kRoomy].follows_from(tiers_[kClear])) next = after(next);
  if (next > last_tier()) return false;
  goes_on_ = false;
  if (!close_goal()) tries_ = 0;
  begin_tier(next);
  return true;
}

// Where motions overlap, half the clearances suffice. Without overlap the path is that of the edges, after a braking
// that nothing can change.
void Planner::lay() noexcept {
  if (laid_ < 0) {
    if (!lay_path(limits_, best_.all(), overlap_, braking_, path_)) {
      stage_ = PlanStage::kFailed;
      return;
    }
    label_path();
    laid_ = overlap_ > 0.0 ? 0 : static_cast<int>(braking_.time / kMoment);
  }
  constexpr int kAtOnce = 16;
  const Clearances& whole = space_.clearances();
  const Clearances half{0.5 * whole.object, 0.5 * whole.floor, 0.5 * whole.self};
  for (int k = 0; k < kAtOnce; ++k) {
    const double t = kMoment * laid_++;
    WholeConfiguration c;
    path_.at(std::min(t, path_.duration), c);
    if (!space_.clear(c, half)) {
      if (overlap_ > 0.0) {
        overlap_ = 0.0;
        laid_ = -1;
      } else {
        stage_ = PlanStage::kFailed;
      }
      return;
    }
    if (t >= path_.duration) {
      begin_smooth();
      return;
    }
  }
}

// The path that stops at each corner counts until there is a quicker one.
void Planner::begin_smooth() noexcept {
  if (!smooths()) return finish();
  corners_.clear();
  corners_.push_back(best_[0].a);
  for (const Edge& edge : best_.all()) corners_.push_back(edge.b);
  routes_ = 0;
  smooth_.begin(corners_, braking_, std::min(path_.duration, within_ + braking_.time));
  stage_ = PlanStage::kSmooth;
}

void Planner::end_smooth() noexcept {
  if (smooth_.found()) {
    path_ = smooth_.path();
    label_path();
  } else if (routes_ > 0) {
    stage_ = PlanStage::kRoute;
    if (routes_ == params_.smooth.routes) begin_runs();
    return;
  }
  finish();
}

void Planner::finish() noexcept {
  stage_ = path_.duration < within_ + braking_.time ? PlanStage::kFound : PlanStage::kFailed;
}

void Planner::label_path() noexcept {
  path_.X_WG = X_WG_;
  path_.clearance = space_.clearances().object;
  path_.kept_at_goal = space_.kept().at_goal;
  path_.arm_at_goal = space_.keeps().arm_at_goal;
}

void Planner::begin_route() noexcept {
  const Vector2 a = start_.head<2>(), b = X_WG_.translation().head<2>();
  route_.begin(start_, std::span(goals_).first(static_cast<std::size_t>(counts_.goals)), tuck_,
               a.cwiseMin(b).array() - beyond(), a.cwiseMax(b).array() + beyond());
  routes_ = 0;
  stage_ = PlanStage::kRoute;
}

}  // namespace moma
