#include "world/scenario/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/model/analytic_distance.h"
#include "controller/model/sampling.h"

namespace moma {
namespace {

/// Enables all self pairs, including those that need no row in the controller.
std::shared_ptr<const RobotModel> with_all_self_rows(const RobotModel& model) {
  auto copy = std::make_shared<RobotModel>(model);
  for (SelfPair& pair : copy->self_pairs) pair.row = true;
  return copy;
}

}  // namespace

SceneBuilder::SceneBuilder(std::shared_ptr<const RobotModel> model, std::uint64_t seed, std::uint64_t index,
                           const Room& room, std::shared_ptr<const Moves> moves)
    : model_(std::move(model)),
      seed_(seed),
      index_(index),
      moves_(std::move(moves)),
      room_(room),
      start_(model_),
      witness_(model_),
      proximity_(with_all_self_rows(*model_)),
      reach_(floor_reach(*model_)),
      one_(1) {}

void SceneBuilder::begin(std::uint64_t attempt, World& world) {
  attempt_ = attempt;
  further_.clear();
  world = World();
  world.index = index_;
  world.seed = seed_;
  world.moves = moves_;
  world.robot = model_->name;
}

bool SceneBuilder::reject(const std::string& constraint) {
  ++rejections_[constraint];
  return false;
}

std::string SceneBuilder::worst_constraint() const {
  const auto worst =
      std::ranges::max_element(rejections_, [](const auto& a, const auto& b) { return a.second < b.second; });
  if (worst == rejections_.end()) return "no constraint failed";
  return worst->first + " (" + std::to_string(worst->second) + " times)";
}

bool SceneBuilder::check_pose(const Kinematics& kinematics, double floor_clearance, double self_clearance,
                              const std::string& who, bool at_ready) {
  // `ready` is the same in every world, so that the message can name the links in contact.
  for (std::size_t i = 0; i < model_->shapes.size(); ++i) {
    const CollisionShape& shape = model_->shapes[i];
    if (shape.rigid_with_base) continue;
    const double height = lowest_point(shape.shape, kinematics.X_WS(shape));
    // Shapes that no joint can lift only need to stay above the floor.
    if (height >= (reach_.lifted[i] ? floor_clearance : -kStanding)) continue;
    if (!at_ready) return reject(who + ": an arm shape too near the floor");
    return reject(fmt::format("{}: at arm.ready shape {} reaches {:.3g} m below the floor", who, shape.name, -height));
  }
  proximity_.set_objects({});
  const auto& pairs = proximity_.query(kinematics, {}, {-1.0, -1.0, self_clearance});
  if (pairs.empty()) return true;
  if (!at_ready) return reject(who + ": self-collision");
  return reject(fmt::format("{}: at arm.ready shapes {} and {} touch", who, model_->shape(pairs.front().first).name,
                            model_->shape(pairs.front().second).name));
}

// Places the bases with the arm at `ready`; returns the rest of the goal's draws.
Draws SceneBuilder::place_bases(const Placement& placement, World& world) const {
  Draws at_start = draws(Stream::kStart);
  const double start_heading = placement.start_heading.sample(at_start);
  Draws at_goal = draws(Stream::kGoal);
  const double distance = placement.distance.sample(at_goal);
  const double direction = placement.direction.sample(at_goal);
  const double heading = placement.heading.sample(at_goal);

  world.start = {Vector3::Zero(), model_->ready};
  world.witness = {Vector3::Zero(), model_->ready};
  if (mobile()) {
    world.start.base.z() = start_heading;
    world.witness.base = {distance * std::cos(direction), distance * std::sin(direction), heading};
  }
  return at_goal;
}

void SceneBuilder::place_start(const World& world) {
  start_.update(world.start.base, world.start.q);
  start_tip_ = start_.X_WE().translation();
}

bool SceneBuilder::place_goal(const Placement& placement, World& world) {
  witness_.update(world.witness.base, world.witness.q);
  if (witness_.X_WE().translation().z() < placement.tip_height) return reject("goal: too low (tip_height)");
  if (!check_pose(witness_, placement.floor_clearance, placement.self_clearance, "goal")) return false;
  set_goal(world);
  return true;
}

void SceneBuilder::draw_arm(const Placement& placement, Draws& from, VectorX& q) const {
  const auto [low, high] = arm_range(placement);
  for (int i = 0; i < model_->num_joints(); ++i) q[i] = from.uniform(low[i], high[i]);
}

std::pair<VectorX, VectorX> SceneBuilder::arm_range(const Placement& placement) const {
  VectorX low(model_->num_joints()), high(model_->num_joints());
  for (int i = 0; i < model_->num_joints(); ++i) {
    const ControlledJoint& joint = model_->joint(i);
    const bool bounded = std::isfinite(joint.lower) && std::isfinite(joint.upper);
    const auto [lower, upper] = drawn_range(joint);
    const double margin = bounded ? std::min(placement.limit_margin, 0.25 * (upper - lower)) : 0.0;
    low[i] = lower + margin;
    high[i] = upper - margin;
  }
  return {low, high};
}

bool SceneBuilder::move_arm(const Placement& placement, const Kinematics& from, const Isometry& X_WG) {
  constexpr int kMost = 100;
  constexpr double kTolerance = 1e-6, kDamping = 1e-4;  // [m, rad]
  const auto [low, high] = arm_range(placement);
  const Vector3 base = from.base();
  VectorX q = from.q();
  Kinematics at(model_);
  for (int i = 0; i < kMost; ++i) {
    at.update(base, q);
    const Vector6 error = pose_error(at.X_WE(), X_WG);
    if (error.norm() < kTolerance) {
      further_.push_back(std::move(at));
      return check_pose(further_.back(), placement.floor_clearance, placement.self_clearance, "beside a goal");
    }
    const Matrix6X J = at.J_WE_W().rightCols(q.size());
    const Eigen::Matrix<double, 6, 6> square = J * J.transpose() + kDamping * Eigen::Matrix<double, 6, 6>::Identity();
    q = (q + J.transpose() * square.ldlt().solve(error)).cwiseMax(low).cwiseMin(high);
  }
  return reject("beside a goal: out of the arm's reach");
}

bool SceneBuilder::place_further(const Placement& placement, World& world, const Upright* upright) {
  constexpr std::uint64_t kTries = 50;
  const std::uint64_t number = further_.size() + 1;
  const Isometry X_WB = number == 1 ? witness_.X_WB() : further_.back().X_WB();
  Kinematics& at = further_.emplace_back(model_);
  Configuration witness{Vector3::Zero(), model_->ready};
  for (std::uint64_t i = 0; i < kTries; ++i) {
    Draws from = draws(Stream::kGoal, number * kTries + i);
    const double distance = placement.distance.sample(from);
    const double direction = placement.direction.sample(from);
    const double heading = placement.heading.sample(from);
    draw_arm(placement, from, witness.q);
    if (mobile())
      witness.base << X_WB.translation().x() + distance * std::cos(direction),
          X_WB.translation().y() + distance * std::sin(direction), heading;
    at.update(witness.base, witness.q);
    if (upright != nullptr) {
      const auto [low, high] = arm_range(placement);
      if (bring_upright(*upright, 0.0, low, high, at, witness.q) < 0) continue;
    }
    if (at.X_WE().translation().z() < placement.tip_height ||
        !check_pose(at, placement.floor_clearance, placement.self_clearance, "further goal"))
      continue;
    set_pose(world.further.emplace_back(), at.X_WE());
    return true;
  }
  return reject("further goal: no place (tip_height, floor_clearance, self_clearance)");
}

bool SceneBuilder::place_robot(const Placement& placement, World& world) {
  Draws at_goal = place_bases(placement, world);
  draw_arm(placement, at_goal, world.witness.q);
  place_start(world);
  return check_start() && place_goal(placement, world);
}

// The result does not depend on the base's pose: one check is enough, but every failed try counts.
bool SceneBuilder::check_start() {
  start_checked_ = start_checked_ || check_pose(start_, 0.0, 0.0, "start", true);
  return start_checked_;
}

bool SceneBuilder::place_upright(const Placement& placement, double angle, const Distribution& at_goal, World& world) {
  Draws draws = place_bases(placement, world);
  draw_arm(placement, draws, world.witness.q);
  place_start(world);
  world.upright = Upright{start_.X_WE().linear().row(2).transpose(), angle};
  const double most = angle * at_goal.sample(draws);
  const auto [low, high] = arm_range(placement);
  if (bring_upright(*world.upright, most, low, high, witness_, world.witness.q) < 0)
    return reject("goal: no upright tool (angle, at_goal)");
  return check_start() && place_goal(placement, world);
}

bool SceneBuilder::place_pair(const Placement& placement, double range, World& world) {
  Draws at_goal = place_bases(placement, world);
  Draws at_start = draws(Stream::kStart, 1);
  const auto draw = [&](Draws& from, VectorX& q) {
    for (int i = 0; i < model_->num_joints(); ++i) {
      const ControlledJoint& joint = model_->joint(i);
      const auto [low, high] = drawn_range(joint);
      q[i] = 0.5 * (low + high) + 0.5 * range * (high - low) * from.uniform(-1.0, 1.0);
    }
  };
  draw(at_start, world.start.q);
  draw(at_goal, world.witness.q);
  place_start(world);
  if (!check_pose(start_, placement.floor_clearance, placement.self_clearance, "start")) return false;
  return place_goal(placement, world);
}

void SceneBuilder::take_robot(World& world) {
  place_start(world);
  set_goal(world);
}

void SceneBuilder::set_goal(World& world) {
  witness_.update(world.witness.base, world.witness.q);
  set_pose(world.goal, witness_.X_WE());
}

bool SceneBuilder::check_configuration(const Configuration& configuration, const Placement& placement) {
  Kinematics kinematics(model_);
  kinematics.update(configuration.base, configuration.q);
  return check_pose(kinematics, placement.floor_clearance, placement.self_clearance, "goal's path");
}

Vector3 SceneBuilder::approach(double apart) const {
  const Vector3 tool = witness_.X_WE().translation();
  for (int link = model_->tip; link > 0; link = model_->link(link).parent) {
    const Vector3 reach = tool - witness_.X_WL(link).translation();
    if (reach.norm() >= apart) return reach.normalized();
  }
  return witness_.X_WE().linear().col(2);
}

void SceneBuilder::choose_object(const WorldObject& object) {
  const ObjectShape shape{object.name, object.shape};
  proximity_.set_objects({&shape, 1});
}

std::vector<ObjectState> SceneBuilder::choose_objects(const World& world) {
  std::vector<ObjectState> states(world.objects.size());
  object_states(world, 0.0, states);
  proximity_.set_objects(object_shapes(world));
  return states;
}

double SceneBuilder::distance(const Kinematics& at, const std::vector<ObjectState>& states, double range) {
  double least = range;
  for (const ProximityPair& pair : proximity_.query(at, states, {.object = range, .floor = -1.0, .self = -1.0}))
    least = std::min(least, pair.distance.d);
  return least;
}

double SceneBuilder::distance_to_witnesses(const std::vector<ObjectState>& states, double range) {
  double least = distance(witness_, states, range);
  for (const Kinematics& at : further_) least = std::min(least, distance(at, states, range));
  return least;
}

double SceneBuilder::distance_at(const WorldObject& object, double t, double range) {
  one_[0].X_WO = evaluate(object.motion, object.X_WO, t).X;
  return std::min(distance(start_, one_, range), distance_to_witnesses(one_, range));
}

bool SceneBuilder::leaves_start_room(const WorldObject& object) {
  if (room_.start <= 0.0) return true;
  one_[0].X_WO = evaluate(object.motion, object.X_WO, 0.0).X;
  return distance(start_, one_, room_.start + 1e-3) > room_.start;
}

bool SceneBuilder::stands_clear(const WorldObject& object, double clearance) {
  choose_object(object);
  return leaves_start_room(object) && distance_at(object, 0.0, clearance + 1e-3) > clearance;
}

bool SceneBuilder::clear_for(const WorldObject& object, double top_speed, double horizon, double clearance) {
  choose_object(object);
  if (!leaves_start_room(object)) return false;
  const double range = clearance + 0.5;
  for (double t = 0.0; t <= horizon;) {
    const double least = distance_at(object, t, range);
    if (least <= clearance) return false;
    if (top_speed <= 0.0) return true;
    // No point can come within `clearance` sooner, except for the least step.
    t += std::max((least - clearance) / top_speed, kTimeStep);
  }
  return true;
}

bool SceneBuilder::bring_near(WorldObject& object, const Vector3& direction_W, double furthest, double clearance) {
  constexpr double kWithin = 1e-4;  // [m]
  choose_object(object);
  one_[0].X_WO = object.X_WO;
  for (double way = 0.0; way <= furthest;) {
    const Vector3 p = object.X_WO.translation() + way * direction_W;
    one_[0].X_WO.translation() = p;
    const double gap = distance(witness_, one_, furthest + clearance);
    if (gap < clearance) return false;
    if (gap <= clearance + kWithin) {
      set_pose(object, p, object.file_rotation);
      return true;
    }
    // The gap shrinks by no more than the way.
    way += gap - clearance - 0.5 * kWithin;
  }
  return false;
}

bool SceneBuilder::stands_near(const WorldObject& object, double at_witness) {
  choose_object(object);
  if (!leaves_start_room(object)) return false;
  one_[0].X_WO = object.X_WO;
  const double range = std::max(room_.clearance, at_witness) + 1e-3;
  return distance(start_, one_, range) > room_.clearance && distance_to_witnesses(one_, range) >= at_witness;
}

std::vector<Vector3> SceneBuilder::footprints() const {
  std::vector<Vector3> out;
  for (const Kinematics* kinematics : {&start_, &witness_}) {
    for (const CollisionShape& shape : model_->shapes) {
      const Vector3 center = kinematics->X_WS(shape).translation();
      out.emplace_back(center.x(), center.y(), bounding_radius(shape.shape));
    }
  }
  return out;
}

void SceneBuilder::measure(World& world) {
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  constexpr double kGrown = 0.05;
  constexpr int kPoints = 200;
  Difficulty& out = world.difficulty;
  const Vector3 goal = world.goal.X_WG.translation();
  out.goal_distance_m = (goal - start_tip_).norm();
  out.objects = static_cast<int>(world.objects.size());
  out.witness_clearance_m = kAbsent;
  out.narrowest_gap_m = kAbsent;
  out.blocked_fraction = 0.0;
  const int held = model_->carried ? model_->carried->object : -1;
  std::vector<std::size_t> obstacles;
  for (std::size_t i = 0; i < world.objects.size(); ++i)
    if (static_cast<int>(i) != held) obstacles.push_back(i);
  if (obstacles.empty()) return;

  const std::vector<ObjectState> states = choose_objects(world);
  out.witness_clearance_m = distance_to_witnesses(states, 1e3);

  int blocked = 0;
  for (int k = 0; k <= kPoints; ++k) {
    const Vector3 p = start_tip_ + (static_cast<double>(k) / kPoints) * (goal - start_tip_);
    for (const std::size_t i : obstacles) {
      if (point_gap(world.objects[i].shape, states[i].X_WO.inverse() * p) > kGrown) continue;
      ++blocked;
      break;
    }
  }
  out.blocked_fraction = static_cast<double>(blocked) / (kPoints + 1);

  if (obstacles.size() < 2) return;
  double gap = std::numeric_limits<double>::infinity();
  for (const std::size_t i : obstacles) {
    for (const std::size_t j : obstacles) {
      if (j <= i) continue;
      const Shape& a = world.objects[i].shape;
      const Shape& b = world.objects[j].shape;
      const double between = (states[i].X_WO.translation() - states[j].X_WO.translation()).norm();
      if (between - bounding_radius(a) - bounding_radius(b) >= gap) continue;
      gap = std::min(gap, shape_distance(a, states[i].X_WO, b, states[j].X_WO).d);
    }
  }
  out.narrowest_gap_m = gap;
}

std::vector<std::string> SceneBuilder::touching_at_start(const World& world) {
  const std::vector<ObjectState> states = choose_objects(world);
  std::vector<std::string> out;
  for (const ProximityPair& pair : proximity_.query(start_, states, {0.0, -1.0, 0.0}))
    out.push_back(fmt::format("{} - {}", model_->shape(pair.first).name,
                              pair.kind == PairKind::kSelf
                                  ? model_->shape(pair.second).name
                                  : world.objects[static_cast<std::size_t>(pair.second)].name));
  return out;
}

}  // namespace moma
