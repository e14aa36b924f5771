#include "controller/lookahead/path_watch.h"

#include <algorithm>
#include <cmath>

#include "controller/model/proximity.h"

namespace moma {
namespace {

// Objects may be nearer now than the path's distance says, since measurements differ from those of its planning.
double asked(const DecisionParams& params, double kept) noexcept {
  return std::max(0.0, params.share * kept - params.less);
}

double least_clearance(const DecisionParams& params, const Path& path) noexcept {
  return std::min(params.least, asked(params, path.clearance));
}

// A path is looked at among what is known: it may lead into space that no sensor has seen.
bool counts(const ObjectState& object) noexcept { return counts_for_plans(object) && object.seen; }

// Near the goal the path keeps a share of the distance with which it was planned there.
KeptDistance shifted_goal(const DecisionParams& params, const Path& path, const PlanarShift& shift,
                          double slope) noexcept {
  KeptDistance kept{asked(params, path.kept_at_goal), slope, path.X_WG.translation()};
  const Vector2 at = kept.p_WG.head<2>();
  const double cs = std::cos(shift.turn), sn = std::sin(shift.turn);
  kept.p_WG.head<2>() = shift.move + Vector2(cs * at.x() - sn * at.y(), sn * at.x() + cs * at.y());
  return kept;
}

}  // namespace

PathWatch::PathWatch(std::shared_ptr<const RobotModel> model, const DecisionParams& params, const MotionLimits& limits,
                     double slope)
    : params_(params), slope_(slope), space_(model, limits), movers_(model) {}

void PathWatch::set_objects(std::span<const ObjectShape> objects) {
  space_.set_objects(objects);
  movers_.set_objects(objects);
  looked_at_.assign(objects.size(), ObjectState{});
  moving_.assign(objects.size(), ObjectState{});
  forget();
}

void PathWatch::forget() noexcept { known_ = false; }

bool PathWatch::news(std::span<const ObjectState> objects, const PlanarShift& shift) noexcept {
  const double moved = params_.moved, turned = params_.turned;
  if (!known_ || (shift.move - looked_shift_.move).norm() > moved ||
      std::abs(wrapped(shift.turn - looked_shift_.turn)) > turned)
    return true;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!counts(objects[i])) continue;
    if (!counts(looked_at_[i]) || !stays(objects[i], looked_at_[i], moved, turned)) return true;
  }
  return false;
}

bool PathWatch::holds(const Path& path, const PlanarShift& shift, double t, std::span<const ObjectState> objects,
                      long& budget) noexcept {
  if (objects.size() != looked_at_.size()) return true;
  if (news(objects, shift)) {
    std::copy(objects.begin(), objects.end(), looked_at_.begin());
    for (ObjectState& object : looked_at_) object.visible = counts(object);
    space_.set_states(looked_at_);
    looked_shift_ = shift;
    space_.keep_near(shifted_goal(params_, path, shift, slope_), asked(params_, path.arm_at_goal));
    known_ = true;
    from_ = t;
  }
  from_ = std::max(from_, t);
  const Clearances clearances{least_clearance(params_, path), -1.0, -1.0};
  while (from_ < path.duration + params_.watch_step && budget > 0) {
    path.at(std::min(from_, path.duration), point_);
    point_ = looked_shift_.of(point_);
    --budget;
    from_ += params_.watch_step;
    if (!space_.clear(point_, clearances)) return false;
  }
  return true;
}

double PathWatch::met_after(const Path& path, const PlanarShift& shift, double t, double ahead,
                            std::span<const ObjectState> objects, long& budget) noexcept {
  if (objects.size() != moving_.size()) return ahead;
  bool any = false;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    moving_[i] = objects[i];
    moving_[i].visible = objects[i].visible && in_motion(objects[i]);
    any = any || moving_[i].visible;
  }
  if (!any) return ahead;
  const double between = 2.0 * params_.watch_step, room = path.clearance + params_.meet_room;
  for (double after = between; after < ahead && budget > 0; after += between) {
    for (ObjectState& object : moving_)
      if (object.visible) object.X_WO.translation() += between * object.V_WO_W.tail<3>();
    path.at(std::min(t + after, path.duration), point_);
    --budget;
    if (!movers_.clear(space_.place(shift.of(point_)), moving_, {room, -1.0, -1.0})) return after;
  }
  return ahead;
}

}  // namespace moma
