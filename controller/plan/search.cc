#include "controller/plan/search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace moma {

int Tree::nearest(const WholeConfiguration& c) const noexcept {
  int best = -1;
  double least = 0.0;
  for (int i = 0; i < size_; ++i) {
    const double d = limits_->distance_squared(nodes_.col(i), c);
    if (best >= 0 && d >= least) continue;
    least = d;
    best = i;
  }
  return best;
}

namespace {

constexpr int kNodes = 3000;
// Cumulative shares of samples: the arm between start and goal, near a goal, the base near the start. The rest is drawn
// freely.
struct SampleKinds {
  double between, near_goal, near_start;
};
constexpr SampleKinds kBolted{0.1, 0.3, 0.3};
constexpr double kUprightStep = 0.5;  // longest step of a joint where the tool stays upright [rad]
constexpr double kShortWay = 0.05;    // shorter steps keep their heading [m]
constexpr int kBlocked = 2;           // cost of a search in a tree, in checks

// Draws any posture of the arm.
void draw_arm(const FreeSpace& space, int joints, CountedDraws& draws, WholeConfiguration& c) noexcept {
  for (int i = 0; i < joints; ++i) c[3 + i] = draws.uniform(space.lower()[i], space.upper()[i]);
}

}  // namespace

double EdgeList::time() const noexcept {
  double sum = 0.0;
  for (const Edge& edge : edges_) sum += edge.time;
  return sum;
}

double EdgeList::base_way() const noexcept {
  double sum = 0.0;
  for (const Edge& edge : edges_) sum += std::abs(edge.drive);
  return sum;
}

void EdgeList::at(const MotionLimits& limits, double t, WholeConfiguration& c) const noexcept {
  for (const Edge& edge : edges_) {
    if (t <= edge.time || &edge == &edges_.back()) {
      edge_at(limits, edge, std::min(t, edge.time), c);
      return;
    }
    t -= edge.time;
  }
}

Search::Search(const MotionLimits& limits, const SearchParams& params, double check_step)
    : limits_(&limits),
      params_(params),
      check_step_(check_step),
      from_start_(limits, kNodes),
      from_goal_(limits, kNodes) {}

void Search::begin(const SearchTask& task, bool goes_on) {
  task_ = task;
  const Vector2 at = task.start.head<2>();
  box_low_ = at.cwiseMin(task.goal_W).array() - task.beyond;
  box_high_ = at.cwiseMax(task.goal_W).array() + task.beyond;
  from_start_.clear();
  if (!goes_on || from_goal_.full()) {
    from_goal_.clear();
    for (GoalConfiguration& goal : task_.goals) goal.rooted = false;
  }
  from_start_.add(task.start, -1);
  edges_.clear();
  stage_ = Stage::kStraight;
  straight_ = 0;
  side_ = 1;
}

Progress Search::advance(FreeSpace& space, CountedDraws& draws) noexcept {
  if (stage_ == Stage::kStraight) {
    const int roots = std::min(task_.roots, static_cast<int>(task_.goals.size()));
    if (straight_ < roots) {
      GoalConfiguration& goal = task_.goals[static_cast<std::size_t>(straight_++)];
      if (!goal.rooted) {
        if (from_goal_.full()) return Progress::kNone;
        from_goal_.add(goal.c, -1);
        goal.rooted = true;
      }
      make_edge(*limits_, task_.start, goal.c, edge_);
      if (!edges_.empty() && edge_.time >= quickest_) return Progress::kMore;
      if (!space.free(edge_, check_step_)) return Progress::kMore;
      quickest_ = edge_.time;
      edges_.clear();
      edges_.push(edge_);
      return Progress::kMore;
    }
    if (!edges_.empty()) return Progress::kFound;
    if (roots == 0) return Progress::kNone;
    stage_ = Stage::kGrow;
  }
  if (stage_ == Stage::kGrow) {
    side_ = params_.from_goal * from_start_.size() <= from_goal_.size() ? 0 : 1;
    if (begin_hand(space, draws)) return Progress::kMore;
    WholeConfiguration target;
    if (!sample_part(space, draws, target)) sample(space, draws, target);
    space.charge(kBlocked);
    bool reached = false;
    Tree& growing = tree(side_);
    grown_ = grow(space, growing, growing.nearest(target), target, reached);
    if (from_start_.full() || from_goal_.full()) return Progress::kNone;
    if (grown_ < 0) return Progress::kMore;
    reaching_ = tree(1 - side_).nearest(growing.node(grown_));
    stage_ = Stage::kConnect;
    return Progress::kMore;
  }
  if (stage_ == Stage::kMoveHand) return move_hand(space);
  bool reached = false;
  const WholeConfiguration meet = tree(side_).node(grown_);
  reaching_ = grow(space, tree(1 - side_), reaching_, meet, reached);
  if (from_start_.full() || from_goal_.full()) return Progress::kNone;
  if (reaching_ < 0 || (reached && !join(side_ == 0 ? grown_ : reaching_, side_ == 0 ? reaching_ : grown_)))
    stage_ = Stage::kGrow;
  else if (reached)
    return Progress::kFound;
  return Progress::kMore;
}

// Draws a node and a direction of the hand: back along the arm to one of its joints, which leads out of where it
// reaches in, one of the hand's axes, or any. False for a draw of joints, and if the goal is not close to an object.
bool Search::begin_hand(FreeSpace& space, CountedDraws& draws) noexcept {
  if (!space.narrow() || draws.uniform() >= params_.hand_moves) return false;
  const Tree& growing = tree(side_);
  grown_ = static_cast<int>(draws.choice(static_cast<std::size_t>(growing.size())));
  const double kind = draws.uniform();
  if (kind < params_.hand_back + params_.hand_axes) {
    space.charge(1);
    const Kinematics& kinematics = space.place(growing.node(grown_));
    if (kind < params_.hand_back) {
      const auto joint = static_cast<int>(draws.choice(static_cast<std::size_t>(limits_->num_joints())));
      const Vector3 p_W = kinematics.X_WL(kinematics.model().joint(joint).link).translation();
      hand_step_ = (p_W - kinematics.X_WE().translation()).stableNormalized();
    } else {
      const auto axis = static_cast<Eigen::Index>(draws.choice(6));
      hand_step_ = kinematics.X_WE().linear().col(axis / 2);
      if (axis % 2 == 1) hand_step_ = -hand_step_;
    }
  } else {
    const double z = draws.uniform(-1.0, 1.0), angle = draws.uniform(-std::numbers::pi, std::numbers::pi);
    const double r = std::sqrt(1.0 - z * z);
    hand_step_ << r * std::cos(angle), r * std::sin(angle), z;
  }
  hand_step_ *= params_.hand_step;
  hand_steps_ = 0;
  stage_ = Stage::kMoveHand;
  return true;
}

// Moves the hand one step by the arm alone, dq = J^T (J J^T + 1e-3 I)^-1 (0, step).
Progress Search::move_hand(FreeSpace& space) noexcept {
  constexpr double kDamping = 1e-3;
  Tree& growing = tree(side_);
  WholeConfiguration target = growing.node(grown_);
  const Eigen::Index joints = limits_->num_joints();
  space.charge(1);
  const auto J = space.place(target).J_WE_W().rightCols(joints);
  Eigen::Matrix<double, 6, 6> M;
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) M(i, j) = M(j, i) = J.row(i).dot(J.row(j)) + (i == j ? kDamping : 0.0);
  Vector6 step = Vector6::Zero();
  step.tail<3>() = hand_step_;
  const Vector6 y = M.ldlt().solve(step);
  bool inside = true;
  for (Eigen::Index i = 0; i < joints; ++i) {
    target[3 + i] += J.col(i).dot(y);
    inside = inside && target[3 + i] >= space.lower()[i] && target[3 + i] <= space.upper()[i];
  }
  bool reached = false;
  const int added = inside ? grow(space, growing, grown_, target, reached) : -1;
  if (growing.full()) return Progress::kNone;
  if (added >= 0) {
    grown_ = added;
    if (++hand_steps_ < params_.hand_steps && reached) return Progress::kMore;
  }
  stage_ = Stage::kGrow;
  if (hand_steps_ == 0) return Progress::kMore;
  reaching_ = tree(1 - side_).nearest(growing.node(grown_));
  stage_ = Stage::kConnect;
  return Progress::kMore;
}

// Adds an edge from a node towards the target, at most one step, as far as it is free. Returns the new node, or -1.
int Search::grow(FreeSpace& space, Tree& tree, int from, const WholeConfiguration& target, bool& reached) noexcept {
  const WholeConfiguration a = tree.node(from);
  const double way = std::sqrt(limits_->distance_squared(a, target));
  const double most = limits_->mobile() ? params_.step : params_.arm_step;
  const double part = way <= most ? 1.0 : most / way;
  WholeConfiguration b = target;
  reached = part == 1.0;
  if (!reached) {
    b = a + part * (target - a);
    b[2] = target[2];
    const bool mobile = limits_->mobile();
    if (limits_->base->nonholonomic() && (b - a).head<2>().norm() > kShortWay)
      head_along(*limits_, a, kShortWay, b);
    else
      b[2] = mobile ? a[2] + part * wrapped(target[2] - a[2]) : a[2];
  }
  if (space.keeps_upright() && !keep_upright(space, a, target, b, reached)) return -1;
  make_edge(*limits_, a, b, edge_);
  double free = space.free_part(edge_, check_step_);
  if (free == 1.0) return tree.add(b, from);
  reached = false;
  if (free * std::sqrt(limits_->distance_squared(a, b)) < params_.least_step) return -1;
  free *= params_.back;
  edge_point(*limits_, edge_, free, b);
  if (limits_->mobile()) {
    make_edge(*limits_, a, b, edge_);
    if (!space.free(edge_, check_step_)) return -1;
  }
  return tree.add(b, from);
}

// Shortens a step so that joints move straight enough, and moves its end to where the tool is upright (after Berenson
// et al., "Manipulation planning on constraint manifolds", ICRA 2009). False if that end is no nearer to the target.
bool Search::keep_upright(FreeSpace& space, const WholeConfiguration& a, const WholeConfiguration& target,
                          WholeConfiguration& b, bool& reached) noexcept {
  const Eigen::Index joints = limits_->num_joints();
  const double turn = (b - a).tail(joints).lpNorm<Eigen::Infinity>();
  if (turn > kUprightStep) {
    b.tail(joints) = a.tail(joints) + kUprightStep / turn * (b - a).tail(joints);
    reached = false;
  }
  const WholeConfiguration straight = b;
  if (!space.bring_upright(b)) return false;
  if (b == straight) return true;
  reached = false;
  return limits_->distance_squared(b, target) < limits_->distance_squared(a, target);
}

// Makes the edges from the start to the trees' meeting point, and on along the goals' tree.
bool Search::join(int from_start, int from_goal) noexcept {
  std::array<int, EdgeList::kMost> forwards;
  std::size_t count = 0;
  for (int i = from_start; i >= 0; i = from_start_.parent(i)) {
    if (count == forwards.size()) return false;
    forwards[count++] = i;
  }
  edges_.clear();
  WholeConfiguration a = task_.start, b;
  const auto on = [&](const WholeConfiguration& next) {
    b = next;
    b[2] = a[2] + wrapped(b[2] - a[2]);
    make_edge(*limits_, a, b, edge_);
    a = b;
    return edges_.push(edge_);
  };
  for (std::size_t k = count - 1; k-- > 0;)
    if (!on(from_start_.node(forwards[k]))) return false;
  for (int i = from_goal_.parent(from_goal); i >= 0; i = from_goal_.parent(i))
    if (!on(from_goal_.node(i))) return false;
  return !edges_.empty();
}

// Draws a node of the growing tree and moves its base straight (or sideways, if it can) or its arm alone. False if base
// and arm move together: for a fixed arm, outside of narrow places, and in the other draws.
bool Search::sample_part(const FreeSpace& space, CountedDraws& draws, WholeConfiguration& c) noexcept {
  if (!limits_->mobile() || !space.narrow()) return false;
  const double kind = draws.uniform();
  if (kind >= params_.base_alone + params_.arm_alone) return false;
  const Tree& growing = tree(side_);
  c = growing.node(static_cast<int>(draws.choice(static_cast<std::size_t>(growing.size()))));
  if (kind < params_.base_alone) {
    const double way = draws.uniform(-params_.base_way, params_.base_way);
    const double angle = limits_->base->nonholonomic() ? c[2] : draws.uniform(-std::numbers::pi, std::numbers::pi);
    c.head<2>() += way * Vector2(std::cos(angle), std::sin(angle));
  } else {
    draw_arm(space, limits_->num_joints(), draws, c);
  }
  return true;
}

void Search::sample(const FreeSpace& space, CountedDraws& draws, WholeConfiguration& c) const noexcept {
  const bool mobile = limits_->mobile();
  const SearchParams& p = params_;
  const double near_goal = p.between + p.near_goal;
  const SampleKinds kinds = mobile ? SampleKinds{p.between, near_goal, near_goal + p.near_start} : kBolted;
  constexpr int kTries = 10;
  const int joints = limits_->num_joints();
  c = task_.start;
  if (mobile) {
    for (int k = 0; k < kTries; ++k) {
      c[0] = draws.uniform(box_low_.x(), box_high_.x());
      c[1] = draws.uniform(box_low_.y(), box_high_.y());
      const double there = (c - task_.start).head<2>().norm();
      const double on = std::max(0.0, (c.head<2>() - task_.goal_W).norm() - p.reach);
      if (there + on < task_.longest) break;
    }
    c[2] = draws.uniform(-std::numbers::pi, std::numbers::pi);
  }
  const double kind = draws.uniform();
  const WholeConfiguration& goal = task_.goals[draws.choice(task_.goals.size())].c;
  if (kind < kinds.between) {
    const double f = draws.uniform();
    c.tail(joints) += f * (goal - task_.start).tail(joints);
  } else if (kind < kinds.near_goal) {
    constexpr double kAway = 0.4, kTurned = 1.0, kFolded = 0.8;  // [m, rad, rad]
    if (mobile) {
      c[0] = goal[0] + draws.uniform(-kAway, kAway);
      c[1] = goal[1] + draws.uniform(-kAway, kAway);
      c[2] = goal[2] + draws.uniform(-kTurned, kTurned);
    }
    for (int i = 0; i < joints; ++i) {
      const double bent = limits_->part[i] * kFolded;
      c[3 + i] = std::clamp(goal[3 + i] + draws.uniform(-bent, bent), space.lower()[i], space.upper()[i]);
    }
  } else {
    constexpr double kAway = 0.3, kTurned = 1.0;
    if (kind < kinds.near_start) {
      c[0] = task_.start[0] + draws.uniform(-kAway, kAway);
      c[1] = task_.start[1] + draws.uniform(-kAway, kAway);
      c[2] = task_.start[2] + draws.uniform(-kTurned, kTurned);
    }
    draw_arm(space, joints, draws, c);
  }
}

}  // namespace moma
