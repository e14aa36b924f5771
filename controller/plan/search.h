#pragma once

#include <span>
#include <vector>

#include "controller/plan/configuration.h"
#include "controller/plan/counted_draws.h"
#include "controller/plan/free_space.h"
#include "controller/plan/plan_params.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// A tree of configurations with one or several roots. Only the constructor allocates.
class Tree {
 public:
  /// `limits` must outlive the tree.
  Tree(const MotionLimits& limits, int capacity)
      : limits_(&limits), nodes_(3 + limits.num_joints(), capacity), parents_(static_cast<std::size_t>(capacity), -1) {}

  void clear() noexcept { size_ = 0; }
  int size() const noexcept { return size_; }
  bool full() const noexcept { return size_ == static_cast<int>(parents_.size()); }
  /// Returns the new node's index. The tree must not be full. `parent`: -1 for a root.
  int add(const WholeConfiguration& c, int parent) noexcept {
    nodes_.col(size_) = c;
    parents_[static_cast<std::size_t>(size_)] = parent;
    return size_++;
  }
  WholeConfiguration node(int i) const noexcept { return nodes_.col(i); }
  int parent(int i) const noexcept { return parents_[static_cast<std::size_t>(i)]; }
  /// Returns the node nearest to c, the first of equal ones; -1 for an empty tree.
  int nearest(const WholeConfiguration& c) const noexcept;

 private:
  const MotionLimits* limits_;
  MatrixX nodes_;  // a column each
  std::vector<int> parents_;
  int size_ = 0;
};

/// A chain of at most kMost edges. Only the constructor allocates.
class EdgeList {
 public:
  static constexpr std::size_t kMost = 96;
  EdgeList() { edges_.reserve(kMost); }
  void clear() noexcept { edges_.clear(); }
  bool full() const noexcept { return edges_.size() == kMost; }
  bool empty() const noexcept { return edges_.empty(); }
  std::size_t size() const noexcept { return edges_.size(); }
  /// False if it is full.
  bool push(const Edge& edge) noexcept {
    if (full()) return false;
    edges_.push_back(edge);
    return true;
  }
  const Edge& operator[](std::size_t i) const noexcept { return edges_[i]; }
  std::span<const Edge> all() const noexcept { return edges_; }
  void swap(EdgeList& other) noexcept { edges_.swap(other.edges_); }
  /// Sum of their times [s].
  double time() const noexcept;
  /// Length of the base's way [m].
  double base_way() const noexcept;
  /// Computes the configuration at time t.
  void at(const MotionLimits& limits, double t, WholeConfiguration& c) const noexcept;

 private:
  std::vector<Edge> edges_;
};

/// Input of a search.
struct SearchTask {
  WholeConfiguration start;
  Vector2 goal_W = Vector2::Zero();    ///< horizontal position of the goal
  std::span<GoalConfiguration> goals;  ///< the cheapest first; samples are drawn near all of them
  int roots = 0;                       ///< the first of them become roots of the goals' tree
  double beyond = 1.5;                 ///< samples' bases lie at most this far beyond start and goal [m]
  double longest = kInfinity;          ///< longest way of the base through a sample to the goal [m]
};

/// Edges from the start to one of several goal configurations: straight there, the quickest; else by two trees that
/// grow towards each other (RRT-Connect: Kuffner & LaValle, ICRA 2000), one from the start, one from all roots. A step
/// that is blocked goes as far as it is free; the tree from the goals, which lie in narrow places more often, may have
/// twice as many nodes. If the hand at its goal is close to an object, a share of the steps translates the hand without
/// turning it, since no other motion leads out of a gap between plates. A robot that drives then also moves its base or
/// its arm alone, since nearly all steps of both are blocked. Other samples have the arm between the start's and a
/// goal's, near a goal, or anyhow. Work is cut into pieces of one edge.
class Search {
 public:
  Search(const MotionLimits& limits, const SearchParams& params, double check_step);

  /// The span of `task` must outlive the search. With `goes_on` the goals' tree of the last search stays;
  /// goals and clearances must be the same.
  void begin(const SearchTask& task, bool goes_on = false);
  /// Does one piece of work. kNone if a tree is full.
  Progress advance(FreeSpace& space, CountedDraws& draws) noexcept;
  /// The edges found, once it is done.
  const EdgeList& edges() const noexcept { return edges_; }

 private:
  enum class Stage { kStraight, kGrow, kMoveHand, kConnect };
  Progress move_hand(FreeSpace& space) noexcept;
  bool begin_hand(FreeSpace& space, CountedDraws& draws) noexcept;
  bool sample_part(const FreeSpace& space, CountedDraws& draws, WholeConfiguration& c) noexcept;
  void sample(const FreeSpace& space, CountedDraws& draws, WholeConfiguration& c) const noexcept;
  int grow(FreeSpace& space, Tree& tree, int from, const WholeConfiguration& target, bool& reached) noexcept;
  bool keep_upright(FreeSpace& space, const WholeConfiguration& a, const WholeConfiguration& target,
                    WholeConfiguration& b, bool& reached) noexcept;
  bool join(int from_start, int from_goal) noexcept;
  Tree& tree(int side) noexcept { return side == 0 ? from_start_ : from_goal_; }

  const MotionLimits* limits_;
  SearchParams params_;
  double check_step_;
  SearchTask task_;
  Vector2 box_low_, box_high_;
  Tree from_start_, from_goal_;
  Stage stage_ = Stage::kStraight;
  int straight_ = 0;
  double quickest_ = 0.0;
  int side_ = 0;   // tree that grew last: 0 from the start, 1 from the goals
  int grown_ = 0;  // its new node
  int hand_steps_ = 0;
  Vector3 hand_step_ = Vector3::Zero();  // in W [m]
  int reaching_ = 0;                     // the other tree's node that grows towards it
  Edge edge_;
  EdgeList edges_;
};

}  // namespace moma
