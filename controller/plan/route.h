#pragma once

#include <array>
#include <span>
#include <vector>

#include "controller/plan/free_space.h"
#include "controller/plan/whole_body_ik.h"

namespace moma {

/// Searches the shortest way of a base whose arm is tucked from the start to the places of goal configurations: A*
/// (Hart, Nilsson & Raphael, IEEE Trans. SSC 4(2), 1968) on a square grid, whose places are checked as they are
/// reached. A route ends near a goal's place; corners that a straight drive saves are left out. It takes no account of
/// the way in which the arm folds and unfolds (smooth_path.h does). The work consists of pieces of one place (a check)
/// or one straight drive. Only the constructor allocates.
class Route {
 public:
  static constexpr std::size_t kMostGoals = 24;

  /// References must outlive it.
  Route(const MotionLimits& limits, const PlanParams& params);

  /// Begins from `start`. `goals` must outlive the search, and the first kMostGoals of them count. The box [low, high]
  /// bounds the base in W [m].
  void begin(const WholeConfiguration& start, std::span<const GoalConfiguration> goals, const VectorX& tuck,
             const Vector2& low, const Vector2& high) noexcept;
  /// Does one piece of work. kFound: corners() is a route to one more goal; the next call goes on to the others.
  Progress advance(FreeSpace& space) noexcept;
  /// Corners of the route found, start and goal included; inner ones have the arm tucked.
  std::span<const WholeConfiguration> corners() const noexcept { return corners_; }

 private:
  struct Open {
    double least;  // length of a route through the place, at least [m]
    int place;
    bool operator<(const Open& other) const noexcept { return least > other.least; }  // the least is a heap's first
  };

  struct Place {
    double way;  // to it [m]
    int parent;
    bool closed;
  };

  Vector2 at(int place) const noexcept { return low_ + cell_ * Vector2(place % columns_, place / columns_); }
  Place& known(int place) noexcept { return places_[static_cast<std::size_t>(place)]; }
  void open(int place, int parent, double way) noexcept;
  bool expand(FreeSpace& space, int place) noexcept;
  bool meet(int place) noexcept;
  Progress pull(FreeSpace& space) noexcept;
  void head_to(const Vector2& from, const Vector2& to) noexcept;
  bool free_drive(FreeSpace& space, const Vector2& a, const Vector2& b) noexcept;

  const MotionLimits& limits_;
  const PlanParams& params_;
  WholeConfiguration start_, tucked_;  // tucked_: where a check is
  std::span<const GoalConfiguration> goals_;
  std::array<bool, kMostGoals> met_{};  // goals to which a route was found

  // The grid.
  Vector2 low_ = Vector2::Zero();
  double cell_ = 0.0;  // [m]
  int columns_ = 0, rows_ = 0;
  std::vector<Place> places_;
  std::vector<Open> heap_;

  // The route.
  std::size_t goal_ = 0;
  std::vector<Vector2> chain_;  // of places; empty while the search goes on
  std::size_t from_ = 0, to_ = 0;
  std::vector<WholeConfiguration> corners_;
};

}  // namespace moma
