#include "controller/plan/direct_way.h"

#include <algorithm>
#include <cmath>

namespace moma {
namespace {

constexpr double kLeastNear = 0.9;      // part of the way to the best end at which nearer tries begin, at most
constexpr double kDriveOfACheck = 0.8;  // a drive of so long is simulated in the time of a check [s]
// Checks are at even times, and the speed between them is not even: they are so much closer.
constexpr double kUneven = 1.5;

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
      goal_clearance_(*model),
      start_(WholeConfiguration::Zero(3 + model->num_joints())) {
  ends_.reserve(static_cast<std::size_t>(params_.direct));
}

void DirectWay::set_objects(std::span<const ObjectShape> objects) {
  space_.set_objects(objects);
  goal_clearance_.allocate(objects.size());
  stage_ = Stage::kDone;
}

void DirectWay::begin(const WholeConfiguration& start, const Isometry& X_WG,
                      std::span<const ObjectState> objects) noexcept {
  start_ = start;
  X_WG_ = X_WG;
  space_.set_states(objects);
  space_.set_clearances({params_.clearance, params_.self, params_.self}, start);
  ends_.clear();
  best_.time = kInfinity;
  draws_ = {};
  tries_ = 0;
  next_ = 0;
  const double at_goal = space_.least_at_goal(goal_clearance_, start, X_WG, params_.clearance);
  stage_ = at_goal < params_.clearance ? Stage::kDone : Stage::kTries;
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
    case Stage::kTries:
      if (tries_++ == params_.direct) {
        stage_ = Stage::kChecks;
        return;
      }
      seed(end);
      if (make(end))
        ends_.insert(std::upper_bound(ends_.begin(), ends_.end(), end,
                                      [](const End& a, const End& b) { return a.time < b.time; }),
                     end);
      return;
    case Stage::kChecks:
      if (next_ == ends_.size()) {
        stage_ = Stage::kDone;
      } else if (take(ends_[next_++])) {
        tries_ = 0;
        stage_ = Stage::kNearer;
      }
      return;
    case Stage::kNearer:
      if (tries_++ == params_.direct_way.nearer_tries) {
        stage_ = Stage::kDone;
        return;
      }
      end.c = start_ + draws_.uniform(params_.direct_way.nearest, kLeastNear) * (best_.c - start_);
      end.stays = best_.stays;
      if (make(end) && end.time < best_.time) take(end);
      return;
    case Stage::kDone:
      return;
  }
}

// Draws joints around those of the start, and a base between start and goal.
void DirectWay::seed(End& end) noexcept {
  const DirectWayParams& p = params_.direct_way;
  WholeConfiguration& c = end.c;
  c = start_;
  for (int i = 0; i < limits_.num_joints(); ++i)
    c[3 + i] = std::clamp(c[3 + i] + limits_.part[i] * draws_.uniform(-p.joints, p.joints), space_.lower()[i],
                          space_.upper()[i]);
  end.stays = !limits_.mobile() || (limits_.base->nonholonomic() && tries_ % p.stay == 0);
  if (end.stays) return;
  const Vector2 goal = X_WG_.translation().head<2>(), from = start_.head<2>() - goal;
  const double stand = std::min(from.norm(), draws_.uniform(p.near, p.far));
  const double angle = std::atan2(from.y(), from.x()) + draws_.uniform(-p.aside, p.aside);
  c.head<2>() = goal + stand * Vector2(std::cos(angle), std::sin(angle));
  head_along(limits_, start_, SteeredDrive::kThere, c);
}

// Moves a try to a configuration with E at the goal that the base can reach. False if there is none.
bool DirectWay::make(End& end) noexcept {
  WholeConfiguration& c = end.c;
  if (!ik_.solve(space_, X_WG_, c, !end.stays)) return false;
  double drive = 0.0;
  WholeConfiguration from = start_;
  if (steers(end)) {
    end.point = c.head<2>();
    if (!drive_to(end.point)) return false;
    drive = drive_.time();
    from.head<3>() = c.head<3>() = drive_.end();
    if (!ik_.solve(space_, X_WG_, c, false)) return false;
  } else {
    c[2] = start_[2] + wrapped(c[2] - start_[2]);
  }
  space_.unwind(c);
  end.time = std::max(drive, edge_time(limits_, from, c));
  return true;
}

bool DirectWay::drive_to(const Vector2& point) noexcept {
  const bool reached = drive_.plan(limits_, start_.head<3>(), point);
  space_.charge(static_cast<long>(drive_.time() / kDriveOfACheck));
  return reached;
}

// Makes `end` the best one if its way is free.
bool DirectWay::take(const End& end) noexcept {
  lay(end);
  if (!free()) return false;
  best_ = end;
  best_path_ = path_;
  return true;
}

void DirectWay::lay(const End& end) noexcept {
  WholeConfiguration from = start_;
  if (steers(end)) from.head<3>() = end.c.head<3>();
  make_edge(limits_, from, end.c, edge_);
  lay_path(limits_, std::span(&edge_, 1), 0.0, path_);
  longest_ = longest_way(limits_, edge_);
  path_.origin = start_;
  if (steers(end)) {
    drive_to(end.point);
    longest_ += drive_.way() + limits_.base_lever * drive_.turned();
    if (path_.count > 0 && drive_.time() > path_.duration) {  // the arm takes as long as the drive
      PathPart& arm = path_.motions.front();
      const Trapezoid motion = edge_.arm.stretched(drive_.time() / edge_.arm.time);
      arm.time = motion.time;
      arm.ramp = motion.ramp;
    }
    drive_.add_to(path_);
  }
  path_.clearance = space_.clearances().object;
  path_.X_WG = X_WG_;
}

// The end first, then the middle, the quarters ...
bool DirectWay::free() noexcept {
  int parts = 1;
  while (parts * params_.check_step < kUneven * longest_ && parts < FreeSpace::kMostParts) parts *= 2;
  for (int stride = parts; stride >= 1; stride /= 2) {
    for (int k = stride; k <= parts; k += 2 * stride) {
      path_.at(path_.duration * k / parts, point_);
      if (!space_.free(point_)) return false;
    }
  }
  return true;
}

}  // namespace moma
