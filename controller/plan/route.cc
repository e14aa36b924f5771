#include "controller/plan/route.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace moma {
namespace {

constexpr int kMostPlaces = 64;  // along an axis
constexpr std::array<std::pair<int, int>, 8> kAround{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

}  // namespace

Route::Route(const MotionLimits& limits, const PlanParams& params) : limits_(limits), params_(params) {
  constexpr std::size_t kPlaces = static_cast<std::size_t>(kMostPlaces) * kMostPlaces;
  places_.resize(kPlaces);
  heap_.reserve(kAround.size() * kPlaces + 1);
  chain_.reserve(kPlaces + 1);
  corners_.reserve(kPlaces + 1);
}

void Route::begin(const WholeConfiguration& start, std::span<const GoalConfiguration> goals, const VectorX& tuck,
                  const Vector2& low, const Vector2& high) noexcept {
  start_ = tucked_ = start;
  tucked_.tail(limits_.num_joints()) = tuck;
  goals_ = goals.first(std::min(goals.size(), kMostGoals));
  met_.fill(false);
  cell_ = std::max(params_.smooth.cell, (high - low).maxCoeff() / (kMostPlaces - 2));
  // The start is one of the places.
  const Vector2 from = start.head<2>();
  const auto before = [&](int axis) { return static_cast<int>(std::max(0.0, std::floor((from - low)[axis] / cell_))); };
  low_ = from - cell_ * Vector2(before(0), before(1));
  const auto count = [&](int axis) {
    return std::clamp(1 + static_cast<int>((high - low_)[axis] / cell_), before(axis) + 1, kMostPlaces);
  };
  columns_ = count(0);
  rows_ = count(1);
  std::fill_n(places_.begin(), columns_ * rows_, Place{kInfinity, -1, false});
  heap_.clear();
  chain_.clear();
  open(before(1) * columns_ + before(0), -1, 0.0);
}

void Route::open(int place, int parent, double way) noexcept {
  Place& here = known(place);
  if (here.closed || !(way < here.way)) return;
  here.way = way;
  here.parent = parent;
  double rest = kInfinity;
  for (std::size_t i = 0; i < goals_.size(); ++i)
    if (!met_[i]) rest = std::min(rest, (at(place) - goals_[i].c.head<2>()).norm());
  heap_.push_back({way + rest, place});
  std::push_heap(heap_.begin(), heap_.end());
}

Progress Route::advance(FreeSpace& space) noexcept {
  if (!chain_.empty()) return pull(space);
  if (heap_.empty()) return Progress::kNone;
  const int place = heap_.front().place;
  const bool open = !known(place).closed;
  // A place stays the first one until it has led to all goals near it.
  if ((open && !expand(space, place)) || !meet(place)) {
    std::pop_heap(heap_.begin(), heap_.end());
    heap_.pop_back();
  }
  return Progress::kMore;
}

// Opens the neighbours of a place that is free, headed there from its parent.
bool Route::expand(FreeSpace& space, int place) noexcept {
  Place& here = known(place);
  here.closed = true;
  if (here.parent >= 0) {
    head_to(at(here.parent), at(place));
    if (!space.free(tucked_)) return false;
  }
  for (const auto& [dx, dy] : kAround) {
    const int x = place % columns_ + dx, y = place / columns_ + dy;
    if (x >= 0 && y >= 0 && x < columns_ && y < rows_)
      open(y * columns_ + x, place, here.way + cell_ * std::hypot(dx, dy));
  }
  return true;
}

// Takes the places that lead to a goal near this one. False if there is none that has no route yet.
bool Route::meet(int place) noexcept {
  for (goal_ = 0; goal_ < goals_.size(); ++goal_)
    if (!met_[goal_] && (at(place) - goals_[goal_].c.head<2>()).norm() <= params_.smooth.near) break;
  if (goal_ == goals_.size()) return false;
  met_[goal_] = true;
  chain_.push_back(goals_[goal_].c.head<2>());
  for (int i = place; i >= 0; i = known(i).parent) chain_.push_back(at(i));
  std::reverse(chain_.begin(), chain_.end());
  corners_.clear();
  corners_.push_back(start_);
  from_ = 0;
  to_ = chain_.size() - 1;
  return true;
}

// Goes on from a corner to the last place, to half as far, a quarter, ... to which a straight drive is free.
Progress Route::pull(FreeSpace& space) noexcept {
  if (to_ > from_ + 1 && !free_drive(space, chain_[from_], chain_[to_])) {
    to_ = from_ + (to_ - from_) / 2;
    return Progress::kMore;
  }
  from_ = to_;
  to_ = chain_.size() - 1;
  const WholeConfiguration& before = corners_.back();
  WholeConfiguration c = goals_[goal_].c;
  if (from_ < to_) {
    c = tucked_;
    c.head<3>() << chain_[from_], before[2];
    head_along(limits_, before, 0.0, c);
  }
  c[2] = before[2] + wrapped(c[2] - before[2]);
  corners_.push_back(c);
  if (from_ < to_) return Progress::kMore;
  chain_.clear();
  return Progress::kFound;
}

void Route::head_to(const Vector2& from, const Vector2& to) noexcept {
  WholeConfiguration before = tucked_;
  before.head<3>() << from, start_[2];
  tucked_.head<3>() << to, start_[2];
  head_along(limits_, before, 0.0, tucked_);
}

bool Route::free_drive(FreeSpace& space, const Vector2& a, const Vector2& b) noexcept {
  const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / params_.check_step)));
  head_to(a, b);
  for (int k = 1; k < parts; ++k) {
    tucked_.head<2>() = a + static_cast<double>(k) / parts * (b - a);
    if (!space.free(tucked_)) return false;
  }
  return true;
}

}  // namespace moma
