#pragma once

#include <span>
#include <vector>

#include "controller/plan/counted_draws.h"
#include "controller/plan/free_space.h"
#include "controller/plan/plan_params.h"
#include "controller/plan/tree.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// Edges in a row. Reserved once, so that up to kMost take no memory.
class EdgeList {
 public:
  static constexpr std::size_t kMost = 96;
  EdgeList() { edges_.reserve(kMost); }
  void clear() noexcept { edges_.clear(); }
  bool full() const noexcept { return edges_.size() == kMost; }
  bool empty() const noexcept { return edges_.empty(); }
  std::size_t size() const noexcept { return edges_.size(); }
  /// False where it is full.
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
  /// Way of the base [m].
  double base_way() const noexcept;
  /// WholeConfiguration at t from the first one's start.
  void at(const MotionLimits& limits, double t, WholeConfiguration& c) const noexcept;

 private:
  std::vector<Edge> edges_;
};

enum class SearchProgress { kMore, kDone, kFailed };

/// What a search starts from.
struct SearchTask {
  WholeConfiguration start;
  Vector2 goal_W = Vector2::Zero();    ///< the goal's place, seen from above
  std::span<GoalConfiguration> goals;  ///< the best first; samples are drawn near any of them ...
  int roots = 0;                       ///< ... and so many of the first are roots
  const VectorX* tuck = nullptr;       ///< joint values of an arm that takes little room
  double beyond = 1.5;                 ///< samples' bases lie so far beyond start and goal, at most [m]
  double longest = 1e18;               ///< of the base's way to a sample and from there to the goal [m]
};

/// Edges from the start to one of several goal configurations: straight there, the quickest; else by two trees that
/// grow towards each other (RRT-Connect: Kuffner & LaValle, ICRA 2000), one from the start, one from all roots. A step
/// that is blocked goes as far as it is free; the tree from the goals, which lie in narrow places more often, may have
/// twice as many nodes. Where the hand is close to an object at its goal, part of the growth moves the hand
/// straight, without turning it: from between plates no other way leads out. Base and arm of a robot that
/// drives also move apart there: of steps that move both nearly all are blocked. Other samples have the arm tucked,
/// between the start's and a goal's, near a goal, or anyhow. Work is cut into pieces of one edge.
class Search {
 public:
  Search(const MotionLimits& limits, const SearchParams& params, double check_step);

  /// The spans and pointers of `task` have to last as long as the search. With `goes_on` the tree from the goals stays
  /// as the last search left it, which has to have had the same goals and clearances.
  void begin(const SearchTask& task, bool goes_on = false);
  /// One piece of work. kFailed where a tree is full.
  SearchProgress advance(FreeSpace& space, CountedDraws& draws) noexcept;
  /// Of a search that is done.
  const EdgeList& edges() const noexcept { return edges_; }

 private:
  enum class Stage { kStraight, kGrow, kMoveHand, kConnect };
  SearchProgress move_hand(FreeSpace& space) noexcept;
  bool begin_hand(FreeSpace& space, CountedDraws& draws) noexcept;
  bool sample_part(const FreeSpace& space, CountedDraws& draws, WholeConfiguration& c) noexcept;
  void sample(const FreeSpace& space, CountedDraws& draws, WholeConfiguration& c) const noexcept;
  int grow(FreeSpace& space, Tree& tree, int from, const WholeConfiguration& target, bool& reached) noexcept;
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
  int side_ = 0;   // of the tree that grew last
  int grown_ = 0;  // its new node
  int hand_steps_ = 0;
  Vector3 hand_step_ = Vector3::Zero();  // in W [m]
  int reaching_ = 0;                     // the other one's node that is on its way there
  Edge edge_;
  EdgeList edges_;
};

}  // namespace moma
