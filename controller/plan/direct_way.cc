#include "controller/plan/direct_way.h"

#include <algorithm>
#include <cmath>

namespace moma {
namespace {

constexpr int kCorrections = 2;      // of the point to which a base steers
constexpr double kLeastScale = 0.1;  // of the draws around an end

ControllerParams with_share(ControllerParams params) {
  params.plan.speed = params.plan.acceleration = params.plan.direct_way.share;
  return params;
}

}  // namespace

DirectWay::DirectWay(std::shared_ptr<const RobotModel> model, const ControllerParams& params)
    : limits_(*model, with_share(params)),
      params_(params.plan),
      space_(model, limits_),
      ik_(model, params.plan.ik, limits_),
      passing_(limits_, params_, space_, ik_),
      upright_share_(params.upright.plan),
      start_{WholeConfiguration::Zero(3 + model->num_joints()), WholeConfiguration::Zero(3 + model->num_joints())} {
  ends_.reserve(static_cast<std::size_t>(params_.direct));
}

void DirectWay::set_objects(std::span<const ObjectShape> objects) {
  space_.set_objects(objects);
  stage_ = Stage::kDone;
}

// Takes objects and clearances. False if there is no direct way: start or goal are too near to an object.
bool DirectWay::clear(const MotionState& start, const Isometry& X_WG, std::span<const ObjectState> objects) noexcept {
  space_.set_states(objects);
  space_.keep_upright(upright_, upright_share_, start.c, X_WG);
  space_.set_clearances({params_.clearance, params_.self, params_.self}, start.c);
  close_goal_ = space_.least_at_goal(start.c, X_WG, params_.clearance) < params_.clearance;
  return !close_goal_ && !(start.moves() && space_.clearances().object < params_.clearance);
}

void DirectWay::begin(const MotionState& start, const Isometry& X_WG, std::span<const ObjectState> objects) noexcept {
  start_ = start;
  X_WG_ = X_WG;
  ends_.clear();
  best_.time = kInfinity;
  draws_ = {};
  tries_ = 0;
  next_ = 0;
  passes_ = false;
  stage_ = clear(start, X_WG, objects) ? Stage::kTries : Stage::kDone;
}

void DirectWay::begin_passing(const MotionState& start, const Isometry& X_WG, const Isometry& X_WN,
                              const WholeConfiguration& pass, const WholeConfiguration& last, double within,
                              std::uint64_t seed, std::span<const ObjectState> objects) noexcept {
  X_WG_ = X_WN;
  last_ = last;
  pass_time_ = within;
  pass_path_.pass = kInfinity;
  draws_ = {seed, 0};
  tries_ = 0;
  passes_ = true;
  passing_.begin(start, X_WG, X_WN, pass);
  stage_ = clear(start, X_WN, objects) && clear(start, X_WG, objects) ? Stage::kPassing : Stage::kDone;
}

void DirectWay::try_passing() noexcept {
  first_time_ = passing_.make(tries_, draws_);
  if (!(first_time_ < pass_time_)) return;
  start_ = passing_.pass();
  on_.time = kInfinity;
  next_ = 0;
  stage_ = Stage::kEnds;
}

// Tries another way on from there.
void DirectWay::try_end() noexcept {
  End end;
  if (draws_.uniform() < params_.direct_way.pass_anywhere)
    seed(end);
  else
    seed_near(last_, end);
  if (make(end) && end.time < on_.time) on_ = end;
  if (++next_ < static_cast<std::size_t>(params_.direct_way.pass_ends)) return;
  stage_ = first_time_ + on_.time < pass_time_ ? Stage::kPass : Stage::kPassing;
}

void DirectWay::take_passing() noexcept {
  if (!take(on_) || !first_path_.append(0.0, best_path_, X_WG_)) return;
  pass_time_ = first_path_.duration;
  pass_path_ = first_path_;
  passing_.keep();
  last_ = on_.c;
}

bool DirectWay::advance(long& budget) noexcept {
  while (budget > 0 && stage_ != Stage::kDone) {
    const long before = space_.checks();
    work();
    budget -= std::max(1L, space_.checks() - before);
  }
  return stage_ != Stage::kDone;
}

void DirectWay::work() noexcept {
  End end;
  switch (stage_) {
    case Stage::kPassing:
      if (tries_++ == params_.direct_way.pass_tries)
        stage_ = Stage::kDone;
      else
        try_passing();
      return;
    case Stage::kEnds:
      try_end();
      return;
    case Stage::kPass:
      passing_.lay(first_path_, longest_);
      stage_ = is_free(first_path_) ? Stage::kOn : Stage::kPassing;
      return;
    case Stage::kOn:
      take_passing();
      stage_ = Stage::kPassing;
      return;
    case Stage::kTries:
      if (tries_++ == params_.direct) {
        stage_ = Stage::kChecks;
        return;
      }
      seed(end);
      if (make(end)) ends_.insert(std::ranges::upper_bound(ends_, end.time, {}, &End::time), end);
      return;
    case Stage::kChecks:
      if (next_ == ends_.size()) {
        stage_ = Stage::kDone;
      } else if (take(ends_[next_++])) {
        tries_ = 0;
        stage_ = Stage::kAround;
      }
      return;
    case Stage::kAround:
      if (tries_++ == params_.direct_way.around_tries) {
        stage_ = Stage::kDone;
        return;
      }
      end.stays = best_.stays;
      seed_near(best_.c, end);
      if (make(end) && end.time < best_.time && take(end)) tries_ = 0;
      return;
    case Stage::kDone:
      return;
  }
}

// Draws joints around those of the start, and a base between start and goal.
void DirectWay::seed(End& end) noexcept {
  const DirectWayParams& p = params_.direct_way;
  WholeConfiguration& c = end.c;
  c = start_.c;
  space_.vary_joints(p.joints, draws_, c);
  end.stays = !limits_.mobile() || (limits_.base->nonholonomic() && tries_ % p.stay == 0);
  if (end.stays) return;
  const Vector2 goal = X_WG_.translation().head<2>(), from = start_.c.head<2>() - goal;
  const double stand = std::min(from.norm(), draws_.uniform(p.near, p.far));
  const double angle = std::atan2(from.y(), from.x()) + draws_.uniform(-p.aside, p.aside);
  c.head<2>() = goal + stand * Vector2(std::cos(angle), std::sin(angle));
  head_along(limits_, start_.c, SteeredDrive::kReached, c);
}

// Draws joints around a configuration, and a base that does not stay, its place pulled towards the start.
void DirectWay::seed_near(const WholeConfiguration& around, End& end) noexcept {
  const DirectWayParams& p = params_.direct_way;
  const double scale = std::pow(kLeastScale, draws_.uniform());
  WholeConfiguration& c = end.c;
  c = around;
  space_.vary_joints(scale * p.joints, draws_, c);
  end.stays = end.stays || !limits_.mobile();
  if (end.stays) return;
  const Vector2 aside(draws_.uniform(-p.far, p.far), draws_.uniform(-p.far, p.far));
  c.head<2>() += scale * (0.5 * aside + draws_.uniform() * (start_.c - c).head<2>());
  head_along(limits_, start_.c, SteeredDrive::kReached, c);
}

// Moves a try to a configuration with E at the goal that the base can reach. False if there is none.
bool DirectWay::make(End& end) noexcept {
  WholeConfiguration& c = end.c;
  const bool steered = steers(end);
  if (!(steered && end.stays) && !ik_.solve(space_, X_WG_, c, !end.stays)) return false;
  double drive = 0.0;
  WholeConfiguration from = start_.c;
  if (steered) {
    end.point = end.stays ? start_.c.head<2>() : c.head<2>();
    for (int correction = 0;; ++correction) {
      if (!drive_to(end)) return false;
      from.head<3>() = c.head<3>() = drive_.end();
      WholeConfiguration near = c;
      if (ik_.solve(space_, X_WG_, c, false)) break;
      // The base has to come to rest where the arm reaches the goal with that heading.
      if (end.stays || correction == kCorrections || !ik_.solve(space_, X_WG_, near)) return false;
      end.point += (near - from).head<2>();
      c = near;
    }
    drive = drive_.time();
  } else {
    c[2] = start_.c[2] + wrapped(c[2] - start_.c[2]);
  }
  space_.unwind(c);
  if (!start_.moves()) {
    end.time = std::max(drive, edge_time(limits_, from, c));
    return true;
  }
  end.time = std::max(drive, glide_to_rest(limits_, Moves::kArm, start_, c).time);
  if (limits_.base->lateral()) end.time = std::max(end.time, glide_to_rest(limits_, Moves::kBase, start_, c).time);
  return true;
}

// Checks are at even times, and the speed between them is not even: they are so much closer.
bool DirectWay::is_free(const Path& path) noexcept {
  constexpr double kUneven = 1.5;
  return space_.free(kUneven * longest_, params_.check_step,
                     [&](double part, WholeConfiguration& c) { path.at(part * path.duration, c); });
}

bool DirectWay::drive_to(const End& end) noexcept {
  const bool reached = drive_.plan(limits_, start_.c.head<3>(), driving_speeds(start_), end.point);
  space_.charge(drive_.checks());
  return reached;
}

// Makes `end` the best one if its way is free.
bool DirectWay::take(const End& end) noexcept {
  lay(end);
  if (!is_free(path_)) return false;
  best_ = end;
  best_path_ = path_;
  return true;
}

void DirectWay::lay(const End& end) noexcept {
  WholeConfiguration from = start_.c;
  if (steers(end)) from.head<3>() = end.c.head<3>();
  make_edge(limits_, from, end.c, edge_);
  longest_ = longest_way(limits_, edge_);
  if (steers(end)) {
    drive_to(end);
    longest_ += drive_.way() + limits_.base_lever * drive_.turned();
  }
  if (start_.moves())
    lay_glides(end);
  else
    lay_from_rest(end);
  path_.clearance = space_.clearances().object;
  path_.X_WG = X_WG_;
}

void DirectWay::lay_from_rest(const End& end) noexcept {
  lay_path(limits_, std::span(&edge_, 1), 0.0, {}, path_);
  path_.origin = start_.c;
  if (!steers(end)) return;
  if (path_.count > 0 && drive_.time() > path_.duration)  // the arm takes as long as the drive
    path_.motions.front().motion = edge_.arm.stretched(drive_.time() / edge_.arm.time);
  drive_.add_to(path_);
}

void DirectWay::lay_glides(const End& end) noexcept {
  const MotionState rest{end.c, WholeConfiguration::Zero(end.c.size())};
  path_.begin(start_.c);
  for (const Moves moves : {Moves::kArm, Moves::kBase}) {
    if (moves == Moves::kBase && !limits_.base->lateral()) continue;
    Trapezoid glide = glide_to_rest(limits_, moves, start_, end.c);
    glide.time = std::max(glide.time, end.time);
    add_glide(moves, glide, start_, rest, path_);
    longest_ += 0.5 * glide.rise *
                (moves == Moves::kBase ? start_.v.head<2>().norm()
                                       : start_.v.tail(limits_.num_joints()).cwiseAbs().dot(limits_.lever));
  }
  if (steers(end)) drive_.add_to(path_);
}

}  // namespace moma
