#include "controller/map/occupancy_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace moma {
namespace {

int units(double log_odds) noexcept { return static_cast<int>(std::lround(log_odds / OccupancyMap::kUnit)); }

}  // namespace

OccupancyMap::OccupancyMap(const MapParams& params)
    : size_(params.cell),
      count_(std::max(4 * kRoll, static_cast<int>(std::lround(params.window / params.cell)))),
      layers_(std::max(1, static_cast<int>(std::lround(params.height / params.cell)))),
      hit_(units(params.evidence.hit)),
      pass_(units(params.evidence.pass)),
      least_(-units(params.evidence.least)),
      most_(units(params.evidence.most)) {
  clear(0.0, 0.0);
}

void OccupancyMap::clear(double x, double y) {
  const std::size_t columns = static_cast<std::size_t>(count_) * static_cast<std::size_t>(count_);
  cells_.assign(columns * static_cast<std::size_t>(layers_), Cell{});
  left_.assign(cells_.size(), 0);
  occupied_.assign(columns, 0);
  fresh_.clear();
  fresh_.reserve(kFresh);
  origin_ = {static_cast<int>(std::floor(x / size_)) - count_ / 2, static_cast<int>(std::floor(y / size_)) - count_ / 2,
             0};
  frame_ = 0;
}

bool OccupancyMap::centre(double x, double y) noexcept {
  const auto shift = [&](double p, int origin) {
    const int off = static_cast<int>(std::floor(p / size_)) - count_ / 2 - origin;
    return std::abs(off) <= kRoll ? 0 : std::clamp(off, -count_, count_);
  };
  const int dx = shift(x, origin_.x()), dy = shift(y, origin_.y());
  if (dx == 0 && dy == 0) return false;
  // Columns move in the order in which none is overwritten before it has moved.
  for (int i = 0; i < count_; ++i)
    for (int j = 0; j < count_; ++j) {
      const int to_x = dx >= 0 ? i : count_ - 1 - i, to_y = dy >= 0 ? j : count_ - 1 - j;
      const int from_x = to_x + dx, from_y = to_y + dy;
      const std::size_t to = column(to_x, to_y), layers = static_cast<std::size_t>(layers_);
      Cell* cells = cells_.data() + to * layers;
      if (from_x < 0 || from_x >= count_ || from_y < 0 || from_y >= count_) {
        std::fill_n(cells, layers, Cell{});
        occupied_[to] = 0;
      } else {
        std::copy_n(cells_.data() + column(from_x, from_y) * layers, layers, cells);
        occupied_[to] = occupied_[column(from_x, from_y)];
      }
    }
  origin_.x() += dx;
  origin_.y() += dy;
  fresh_.clear();
  return true;
}

Eigen::Vector3i OccupancyMap::cell_of(const Vector3& p) const noexcept {
  // Far points become cells outside the window, without overflow.
  constexpr double kFar = 1e6;
  const Vector3 at = (p / size_).array().floor().max(-kFar).min(kFar);
  return at.cast<int>() - origin_;
}

void OccupancyMap::begin() noexcept {
  if (++frame_ != 0) return;
  for (Cell& cell : cells_) cell.frame = 0;
  frame_ = 1;
}

void OccupancyMap::set(std::size_t index, int odds) noexcept {
  Cell& cell = cells_[index];
  const bool was = cell.odds > 0, is = odds > 0;
  cell.odds = static_cast<std::int8_t>(odds);
  if (was == is) return;
  if (is && fresh_.size() < fresh_.capacity()) fresh_.push_back(static_cast<int>(index));
  occupied_[index / static_cast<std::size_t>(layers_)] += is ? 1 : -1;
}

void OccupancyMap::change(std::size_t index, int by) noexcept {
  Cell& cell = cells_[index];
  if (cell.frame == frame_) return;
  cell.frame = frame_;
  const int before = cell.odds == kUnseen ? 0 : cell.odds;
  set(index, std::clamp(before + by, least_, most_));
}

void OccupancyMap::hit(const Vector3& p) noexcept {
  const Eigen::Vector3i cell = cell_of(p);
  if (inside(cell)) change(at(cell), hit_);
}

void OccupancyMap::pass(const Vector3& from, const Vector3& to) noexcept {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const Eigen::Vector3i first = cell_of(from), last = cell_of(to);
  if (!inside(first)) return;
  const std::ptrdiff_t strides[3] = {static_cast<std::ptrdiff_t>(count_) * layers_, layers_, 1};
  std::ptrdiff_t stride[3];
  double next[3], each[3];  // share of the ray at the next step along each axis, and between two steps
  double end = kNever;      // share at which the ray leaves the window
  const Vector3 way = to - from, low = low_corner(first);
  for (int i = 0; i < 3; ++i) {
    const bool up = way[i] > 0.0;
    stride[i] = up ? strides[i] : -strides[i];
    each[i] = way[i] == 0.0 ? kNever : size_ / std::abs(way[i]);
    next[i] = way[i] == 0.0 ? kNever : (low[i] + (up ? size_ : 0.0) - from[i]) / way[i];
    // The sum of steps may be less than this product, by rounding.
    constexpr double kRounding = 1e-9;
    const int left = up ? cells()[i] - 1 - first[i] : first[i];
    if (way[i] != 0.0) end = std::min(end, next[i] + left * each[i] - kRounding);
  }
  Cell* cell = cells_.data() + at(first);
  double x = next[0], y = next[1], z = next[2];
  for (int steps = (last - first).cwiseAbs().sum(); steps > 0; --steps) {
    if (cell->frame != frame_) {
      const int before = cell->odds == kUnseen ? 0 : cell->odds, after = std::max(before - pass_, least_);
      cell->frame = frame_;
      if (before > 0 && after <= 0)
        set(static_cast<std::size_t>(cell - cells_.data()), after);
      else
        cell->odds = static_cast<std::int8_t>(after);
    }
    // Without branches: which axis is next cannot be guessed.
    const double t = std::min(x, std::min(y, z));
    if (t >= end) return;
    const bool along_x = x == t, along_y = !along_x && y == t, along_z = !along_x && !along_y;
    cell += along_x ? stride[0] : along_y ? stride[1] : stride[2];
    x += along_x ? each[0] : 0.0;
    y += along_y ? each[1] : 0.0;
    z += along_z ? each[2] : 0.0;
  }
}

void OccupancyMap::take_for_free(const Eigen::Vector3i& cell, bool surely) noexcept {
  if (!inside(cell)) return;
  const std::size_t index = at(cell);
  if (surely ? cells_[index].odds > -pass_ : cells_[index].odds == kUnseen) set(index, -pass_);
}

bool OccupancyMap::covers_fresh(std::span<const CellBox> boxes, const CellBox& region) noexcept {
  bool all = fresh_.size() < fresh_.capacity();
  const auto in = [](const CellBox& box, const Eigen::Vector3i& c) {
    return (c.array() >= box.low.array()).all() && (c.array() < box.high.array()).all();
  };
  for (const int index : fresh_) {
    if (!all) break;
    const Eigen::Vector3i cell(index / layers_ / count_, index / layers_ % count_, index % layers_);
    all =
        !in(region, cell) || std::any_of(boxes.begin(), boxes.end(), [&](const CellBox& box) { return in(box, cell); });
  }
  fresh_.clear();
  return all;
}

void OccupancyMap::cover(Kind kind, CellBox region, std::vector<CellBox>& boxes) noexcept {
  boxes.clear();
  region.low = region.low.cwiseMax(0);
  region.high = region.high.cwiseMin(cells());
  const auto& [low, high] = region;
  const auto empty = [&](int x, int y) { return kind == Kind::kOccupied && occupied_[column(x, y)] == 0; };
  for (int x = low.x(); x < high.x(); ++x)
    for (int y = low.y(); y < high.y(); ++y) {
      const std::size_t base = column(x, y) * static_cast<std::size_t>(layers_);
      for (int z = low.z(); z < high.z(); ++z) {
        const std::size_t index = base + static_cast<std::size_t>(z);
        left_[index] = !empty(x, y) && counts(kind, index) ? 1 : 0;
      }
    }
  const auto all_left = [&](int x, int y, int from, int to) {
    const std::size_t base = column(x, y) * static_cast<std::size_t>(layers_);
    for (int z = from; z < to; ++z)
      if (left_[base + static_cast<std::size_t>(z)] == 0) return false;
    return true;
  };
  for (int x = low.x(); x < high.x(); ++x)
    for (int y = low.y(); y < high.y(); ++y) {
      if (empty(x, y)) continue;
      const std::size_t base = column(x, y) * static_cast<std::size_t>(layers_);
      for (int z = low.z(); z < high.z(); ++z) {
        if (left_[base + static_cast<std::size_t>(z)] == 0) continue;
        if (boxes.size() == boxes.capacity()) return;
        CellBox box{{x, y, z}, {x + 1, y + 1, z + 1}};
        while (box.high.z() < std::min(high.z(), z + kLongest) && all_left(x, y, box.high.z(), box.high.z() + 1))
          ++box.high.z();
        while (box.high.y() < std::min(high.y(), y + kLongest) && all_left(x, box.high.y(), z, box.high.z()))
          ++box.high.y();
        const auto row_left = [&](int row) {
          for (int side = y; side < box.high.y(); ++side)
            if (!all_left(row, side, z, box.high.z())) return false;
          return true;
        };
        while (box.high.x() < std::min(high.x(), x + kLongest) && row_left(box.high.x())) ++box.high.x();
        for (int i = x; i < box.high.x(); ++i)
          for (int j = y; j < box.high.y(); ++j)
            std::fill_n(left_.begin() + static_cast<std::ptrdiff_t>(column(i, j)) * layers_ + z, box.high.z() - z, 0);
        boxes.push_back(box);
      }
    }
}

}  // namespace moma
