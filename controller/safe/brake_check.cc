#include "controller/safe/brake_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace moma {
namespace {

constexpr int kMostPlaces = 200;  // on one braking trajectory
constexpr double kSure = 1e-3;    // exceeds all rounding of distances and travels [m]
// The broad phase keeps pairs up to this far beyond the range, because the next query is close [m].
constexpr double kAhead = 0.1;

// Mean over [from, to] of a velocity that falls evenly from 1 to 0 in `time`.
double mean_left(double time, double from, double to) noexcept {
  const double a = std::min(from, time), b = std::min(to, time);
  return b > a ? ((b - a) - (b * b - a * a) / (2.0 * time)) / (to - from) : 0.0;
}

}  // namespace

OwnMargins own_margins(const DamperParams& floor, const DamperParams& self, double share) noexcept {
  return {floor.enabled ? share * floor.stop : 0.0, self.enabled ? share * self.stop : 0.0};
}

BrakeCheck::BrakeCheck(std::shared_ptr<const RobotModel> model, const BrakeCheckParams& params,
                       const VectorX& acceleration, bool pair_together, double control_period,
                       const Uncertainty& uncertainty, const OwnMargins& own)
    : model_(std::move(model)),
      params_(params),
      own_(own),
      dt_(control_period),
      hold_(control_period),
      kinematics_(model_),
      proximity_(model_),
      ramp_(*model_),
      deceleration_(*model_, acceleration, pair_together),
      uncertainty_(uncertainty),
      J_(3, model_->num_velocities()),
      q_(VectorX::Zero(model_->num_joints())),
      ways_(*model_),
      floor_bounds_(model_->shapes.size()),
      self_bounds_(model_->self_pairs.size()),
      self_at_(model_->shapes.size() * model_->shapes.size(), -1),
      own_start_(model_) {
  row_ = mean_ = times_ = trial_ = full_ = in_proportion_ = gone_ = whole_ = VectorX::Zero(model_->num_velocities());
  for (std::size_t p = 0; p < model_->self_pairs.size(); ++p) {
    const SelfPair& pair = model_->self_pairs[p];
    const std::size_t at = static_cast<std::size_t>(pair.first) * model_->shapes.size();
    self_at_[at + static_cast<std::size_t>(pair.second)] = static_cast<int>(p);
  }
  set_objects({});
}

void BrakeCheck::set_objects(std::span<const ObjectShape> objects) {
  if (!on()) return;
  proximity_.set_objects(objects);
  states_.assign(objects.size(), ObjectState{});
  object_bounds_.assign(model_->shapes.size() * objects.size(), 0.0);
  sharp_.assign(object_bounds_.size(), 0);
  shown_.reserve(objects.size());
  radii_.clear();
  for (const ObjectShape& object : objects) radii_.push_back(bounding_radius(object.shape));
  candidates_.reserve(object_bounds_.size() + floor_bounds_.size() + self_bounds_.size());
  groups_.reserve(model_->shapes.size());
}

// Range in which distances of this kind count; negative if none does.
double BrakeCheck::range_of(PairKind kind) const noexcept {
  if (kind == PairKind::kObject) return params_.margin + widest_;
  return own_.of(kind) > 0.0 ? own_.of(kind) : -1.0;
}

// Stores bounds from the known pairs. Pairs that are not among them are infinitely far.
void BrakeCheck::begin(const Observation& o, const KnownPairs& known) noexcept {
  start_ = known.kinematics;
  if (start_ == nullptr) {
    own_start_.place(o.base, o.q);
    start_ = &own_start_;
  }
  ways_.begin(*start_);
  placed_ = Placed::kNot;
  const auto bound = [](double range) { return range >= 0.0 ? range : -kInfinity; };
  const std::size_t shapes = model_->shapes.size(), count = states_.size();
  shown_.clear();
  for (std::size_t k = 0; k < count; ++k) {
    if (states_[k].visible) shown_.push_back(static_cast<int>(k));
    const double far = states_[k].visible ? bound(known.ranges.of(states_[k])) : kInfinity;
    for (std::size_t i = 0; i < shapes; ++i) object_bounds_[i * count + k] = far;
  }
  std::fill(sharp_.begin(), sharp_.end(), char{0});
  std::fill(floor_bounds_.begin(), floor_bounds_.end(), bound(known.ranges.floor));
  std::fill(self_bounds_.begin(), self_bounds_.end(), bound(known.ranges.self));
  for (const ProximityPair& pair : known.pairs) {
    const auto first = static_cast<std::size_t>(pair.first), second = static_cast<std::size_t>(pair.second);
    switch (pair.kind) {
      case PairKind::kObject:
        if (!states_[second].visible) break;
        object_bounds_[first * count + second] = pair.distance.d;
        sharp_[first * count + second] = 1;
        break;
      case PairKind::kFloor:
        floor_bounds_[first] = pair.distance.d;
        break;
      case PairKind::kSelf: {
        const int at = self_at_[first * shapes + second];
        if (at >= 0) self_bounds_[static_cast<std::size_t>(at)] = pair.distance.d;
        break;
      }
    }
  }
}

// Returns the best cheap lower bound of a shape's distance to an object at the start of the step.
double BrakeCheck::object_bound(int shape, int object) noexcept {
  const auto k = static_cast<std::size_t>(object);
  const std::size_t at = static_cast<std::size_t>(shape) * states_.size() + k;
  double& bound = object_bounds_[at];
  if (sharp_[at] != 0) return bound;
  const Isometry& X_WO = states_[k].X_WO;
  if (placed_ != Placed::kAtStart) proximity_.place(*start_);
  placed_ = Placed::kAtStart;
  sharp_[at] = 1;
  return bound = std::max(bound, proximity_.least_gap(shape, object, X_WO));
}

// Selects the pairs that the braking trajectory may bring too near, and limits ways_ to them.
void BrakeCheck::choose_candidates() noexcept {
  candidates_.clear();
  groups_.clear();
  const double range = range_of(PairKind::kObject) + kSure;
  const int shapes = static_cast<int>(model_->present_shapes().size());
  for (int i = 0; i < shapes; ++i) {
    const double enough = range + ways_.most_in_world(i);
    Group group{i, candidates_.size(), 0, kInfinity};
    const double* known = object_bounds_.data() + static_cast<std::size_t>(i) * states_.size();
    for (const int k : shown_) {
      if (known[k] >= enough) continue;
      const double reach = enough + ways_.radius(i) + radii_[static_cast<std::size_t>(k)];
      const Vector3 between = ways_.centre_W(i) - states_[static_cast<std::size_t>(k)].X_WO.translation();
      if (between.squaredNorm() >= reach * reach) continue;
      const double bound = object_bound(i, k);
      if (bound >= enough) continue;
      candidates_.push_back({PairKind::kObject, i, k, bound});
      group.least_room = std::min(group.least_room, bound);
    }
    group.end = candidates_.size();
    if (group.end > group.begin) groups_.push_back(group);
  }
  grouped_ = candidates_.size();
  if (own_.floor > 0.0) {
    for (int i = 0; i < shapes; ++i) {
      if (model_->shape(i).rigid_with_base) continue;
      const double ball = ways_.centre_W(i).z() - ways_.radius(i);
      const double bound = std::max(floor_bounds_[static_cast<std::size_t>(i)], ball);
      if (!(bound >= own_.floor + kSure + ways_.in_height(i, whole_)))
        candidates_.push_back({PairKind::kFloor, i, -1, bound});
    }
  }
  if (own_.self > 0.0) {
    for (std::size_t p = 0; p < self_bounds_.size(); ++p) {
      const SelfPair& pair = model_->self_pairs[p];
      if (!pair.row || pair.second >= shapes) continue;
      const double enough = own_.self + kSure + ways_.between(pair.first, pair.second, whole_);
      double bound = self_bounds_[p];
      if (bound >= enough) continue;
      const double apart = (ways_.centre_W(pair.first) - ways_.centre_W(pair.second)).norm();
      bound = std::max(bound, apart - ways_.radius(pair.first) - ways_.radius(pair.second));
      if (!(bound >= enough)) candidates_.push_back({PairKind::kSelf, pair.first, pair.second, bound});
    }
  }
}

// Places the robot at base_ and q_; false if that is no valid pose.
bool BrakeCheck::place() noexcept {
  kinematics_.place(base_, q_);
  return proximity_.place(kinematics_);
}

// Returns the contribution of a pair that is too near, else infinity. `way`: its travel since the start of the step.
double BrakeCheck::measure(NearPair& candidate, double way, double to_come) noexcept {
  const double range = range_of(candidate.kind);
  // The same bound as in leave_out_by_end(), for the rest of the trajectory.
  const double clear = 2.0 * (range + kSure) + to_come - candidate.end;
  const double far = std::max(range + kAhead, clear < kInfinity ? clear : 0.0);
  const auto found = proximity_.within(candidate.kind, candidate.first, candidate.second, states_, far);
  const double d = found ? found->d : far;
  candidate.room = d >= clear ? kInfinity : way + d;
  if (!(d < range)) return kInfinity;
  return d - margin_of({candidate.kind, candidate.first, candidate.second, *found});
}

// Drops pairs, with the robot at the end of the trajectory. On the way a pair's distance is at least its distance at
// the start minus the travel so far, and at least its distance at the end minus the travel to come; the greater of the
// two is at least half of their sum.
void BrakeCheck::leave_out_by_end() noexcept {
  placed_ = Placed::kHere;
  if (!place()) return;
  const auto clear = [&](NearPair& c, double way) {
    const double need = 2.0 * (range_of(c.kind) + kSure) + way - c.room;
    if (!(need < kInfinity)) return false;
    const auto found = proximity_.within(c.kind, c.first, c.second, states_, need);
    if (found) c.end = found->d;
    return !found;
  };
  std::size_t kept = 0;
  for (Group& group : groups_) {
    const std::size_t begin = kept;
    group.least_room = kInfinity;
    for (std::size_t i = group.begin; i < group.end; ++i) {
      if (clear(candidates_[i], ways_.most_in_world(group.shape))) continue;
      group.least_room = std::min(group.least_room, candidates_[i].room);
      candidates_[kept++] = candidates_[i];
    }
    group.begin = begin;
    group.end = kept;
  }
  const std::size_t own = grouped_;
  grouped_ = kept;
  for (std::size_t i = own; i < candidates_.size(); ++i)
    if (!clear(candidates_[i], way_of_own(candidates_[i], whole_))) candidates_[kept++] = candidates_[i];
  candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(kept), candidates_.end());
}

// Travel of a pair of a shape with the floor, or of two shapes.
double BrakeCheck::way_of_own(const NearPair& own, const VectorX& gone) const noexcept {
  return own.kind == PairKind::kFloor ? ways_.in_height(own.first, gone) : ways_.between(own.first, own.second, gone);
}

// Returns the least distance at base_ and q_, at the travel gone_ from the start of the step. Sets open_ if a pair may
// be too near later.
double BrakeCheck::distance() noexcept {
  double least = kInfinity;
  bool here = false;
  open_ = false;
  const auto look = [&](NearPair& c, double way, double to_come) {
    const double enough = range_of(c.kind) + kSure;
    if (c.end - to_come >= enough) c.room = kInfinity;
    if (c.room - way < enough) {
      if (!here) {
        placed_ = Placed::kHere;
        here = place();
      }
      if (here) least = std::min(least, measure(c, way, to_come));
    }
    open_ |= c.room < kInfinity;
  };
  for (Group& group : groups_) {
    if (!(group.least_room < kInfinity)) continue;
    const double way = ways_.in_world(group.shape, gone_);
    if (group.least_room - way >= range_of(PairKind::kObject) + kSure) {
      open_ = true;
      continue;
    }
    const double to_come = ways_.most_in_world(group.shape) - way;
    group.least_room = kInfinity;
    for (std::size_t i = group.begin; i < group.end; ++i) {
      look(candidates_[i], way, to_come);
      group.least_room = std::min(group.least_room, candidates_[i].room);
    }
  }
  for (std::size_t i = grouped_; i < candidates_.size(); ++i) {
    NearPair& own = candidates_[i];
    if (!(own.room < kInfinity)) continue;
    const double way = way_of_own(own, gone_);
    look(own, way, way_of_own(own, whole_) - way);
  }
  return least < params_.margin ? least : kInfinity;
}

// Returns the distance required in addition to the margin; negative for floor and self, which have their own margins.
// At the present kinematics_.
double BrakeCheck::margin_of(const ProximityPair& pair) noexcept {
  if (pair.kind != PairKind::kObject) return own_.of(pair.kind) - params_.margin;
  if (!states_[static_cast<std::size_t>(pair.second)].seen) return unseen_ - params_.margin;
  if (!uncertainty_.on()) return 0.0;
  approach_row(pair, kinematics_, J_, row_);
  return uncertainty_.margin(pair, kinematics_, row_, states_, spreads_);
}

double BrakeCheck::widest_margin(const Observation& o) noexcept {
  if (!uncertainty_.on()) return 0.0;
  kinematics_.place(o.base, o.q);
  double widest = 0.0;
  for (const ProximityPair& pair : proximity_.query(kinematics_, {params_.range, -1.0, -1.0}))
    widest = std::max(widest, margin_of(pair));
  return params_.widening * widest;
}

double BrakeCheck::least_distance(const Observation& o, const VectorX& command, bool in_proportion) noexcept {
  begin(o, {});
  return way_to_stop(o, command, in_proportion, -kInfinity);
}

// A caller that only compares with `floor` gets an answer as soon as the value is below it.
double BrakeCheck::way_to_stop(const Observation& o, const VectorX& command, bool in_proportion,
                               double floor) noexcept {
  base_ = o.base;
  q_ = o.q;
  deceleration_.stopping_times(command, times_);
  const double last = times_.maxCoeff();
  if (in_proportion) times_.setConstant(last);
  // While the command acts, the base ramps to the command.
  mean_ = command;
  Vector3 velocity = ramp_.base_of(o.qdot);
  ramp_.set_base(ramp_.follow(ramp_.base_of(command), hold_, velocity), mean_);
  whole_ = hold_ * mean_.cwiseAbs() + 0.5 * command.cwiseAbs().cwiseProduct(times_);
  ways_.limit(whole_);
  choose_candidates();
  if (in_proportion && !candidates_.empty()) {
    // On this trajectory the base brakes along one arc, whose end is cheap to compute.
    integrate(*model_, base_, q_, mean_, hold_);
    row_ = 0.5 * command;
    integrate(*model_, base_, q_, row_, last);
    leave_out_by_end();
    base_ = o.base;
    q_ = o.q;
  }
  if (candidates_.empty()) return kInfinity;
  const double part = params_.every * dt_;
  const int held = std::max(1, static_cast<int>(std::ceil(hold_ / part - 1e-9)));
  const double each = hold_ / held;
  double d = kInfinity;
  gone_.setZero();
  for (int k = 0; k < held; ++k) {
    gone_ += each * mean_.cwiseAbs();
    integrate(*model_, base_, q_, mean_, each);
    d = std::min(d, distance());
  }
  for (int k = 0; k < kMostPlaces && k * part < last && d > floor && open_; ++k) {
    const double from = k * part, to = std::min(from + part, last);
    for (Eigen::Index i = 0; i < mean_.size(); ++i) mean_[i] = command[i] * mean_left(times_[i], from, to);
    gone_ += (to - from) * mean_.cwiseAbs();
    integrate(*model_, base_, q_, mean_, to - from);
    d = std::min(d, distance());
  }
  return d;
}

// Returns the better of the two trajectories, or a value of at most `floor` if neither exceeds it.
double BrakeCheck::clearance(const Observation& o, const VectorX& command, double floor) noexcept {
  const double d = way_to_stop(o, command, true, floor);
  return d >= params_.margin ? d : std::max(d, way_to_stop(o, command, false, floor));
}

double BrakeCheck::apply(const Observation& o, const Allowed& allowed, std::span<const PlaceSpread> spreads,
                         VectorX& command, const KnownPairs& known) noexcept {
  spreads_ = spreads;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    states_[i] = o.objects[i];
    if (!states_[i].V_WO_W.isZero(0.0) || !is_pose(states_[i].X_WO)) states_[i].visible = false;
    if (states_[i].box.x() > 0.0) radii_[i] = 0.5 * states_[i].box.norm();
  }
  proximity_.hold(states_);
  widest_ = widest_margin(o);
  begin(o, known);
  double best = clearance(o, command, -kInfinity);
  if (best >= params_.margin) return 1.0;
  double kept = 1.0;
  full_ = command;
  deceleration_.stopping_times(o.qdot, times_);
  in_proportion_ = (1.0 - dt_ / std::max(dt_, times_.maxCoeff())) * o.qdot;
  in_proportion_ = in_proportion_.cwiseMax(allowed.lower).cwiseMin(allowed.upper);
  for (const double share : {0.75, 0.5, 0.25, 0.0}) {
    for (const VectorX* slower : {static_cast<const VectorX*>(&in_proportion_), &allowed.slowest}) {
      trial_ = *slower + share * (full_ - *slower);
      const double d = clearance(o, trial_, best);
      if (!(d > best)) continue;
      best = d;
      kept = share;
      command = trial_;
      if (d >= params_.margin) return kept;
    }
  }
  return kept;
}

}  // namespace moma
