#include "controller/map/occupancy_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace moma {
namespace {

int units(double log_odds) noexcept { return static_cast<int>(std::lround(log_odds / OccupancyMap::kUnit)); }

// Bits from `low` up to below `high`; 0 <= low < high <= 64.
std::uint64_t bits(int low, int high) noexcept { return (~std::uint64_t{0} >> (64 - (high - low))) << low; }

}  // namespace

OccupancyMap::OccupancyMap(const MapParams& params)
    : size_(params.cell),
      count_(std::max(4 * kRoll, static_cast<int>(std::lround(params.window / params.cell)))),
      layers_(std::clamp(static_cast<int>(std::lround(params.height / params.cell)), 1, kMostLayers)),
      hit_(units(params.evidence.hit)),
      pass_(units(params.evidence.pass)),
      least_(-units(params.evidence.least)),
      most_(units(params.evidence.most)) {
  count_ += (kBlock - count_ % kBlock) % kBlock;
  clear(0.0, 0.0);
}

void OccupancyMap::clear(double x, double y) {
  const std::size_t columns = static_cast<std::size_t>(count_) * static_cast<std::size_t>(count_);
  cells_.assign(columns * static_cast<std::size_t>(layers_), Cell{});
  columns_.assign(columns, Column{});
  left_.assign(columns, 0);
  covered_.assign(columns, 0);
  blocks_.assign(columns / (kBlock * kBlock), Block{});
  region_ = {};
  uncovered_ = false;
  origin_ = {static_cast<int>(std::floor(x / size_)) - count_ / 2, static_cast<int>(std::floor(y / size_)) - count_ / 2,
             0};
  frame_ = 0;
}

bool OccupancyMap::centre(double x, double y) noexcept {
  // By whole blocks.
  const auto shift = [&](double p, int origin) {
    const int off = static_cast<int>(std::floor(p / size_)) - count_ / 2 - origin;
    return std::abs(off) <= kRoll ? 0 : std::clamp(off / kBlock * kBlock, -count_, count_);
  };
  const int dx = shift(x, origin_.x()), dy = shift(y, origin_.y());
  if (dx == 0 && dy == 0) return false;
  // Things move in the order in which none is overwritten before it has moved.
  const auto move = [](int count, int by_x, int by_y, auto&& take) {
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < count; ++j) {
        const int to_x = by_x >= 0 ? i : count - 1 - i, to_y = by_y >= 0 ? j : count - 1 - j;
        const int from_x = to_x + by_x, from_y = to_y + by_y;
        const bool inside = from_x >= 0 && from_x < count && from_y >= 0 && from_y < count;
        take(static_cast<std::size_t>(to_x * count + to_y), inside ? from_x * count + from_y : -1);
      }
  };
  const auto layers = static_cast<std::size_t>(layers_);
  move(count_, dx, dy, [&](std::size_t to, int from) {
    Cell* cells = cells_.data() + to * layers;
    if (from < 0) {
      std::fill_n(cells, layers, Cell{});
      columns_[to] = Column{};
    } else {
      std::copy_n(cells_.data() + static_cast<std::size_t>(from) * layers, layers, cells);
      columns_[to] = columns_[static_cast<std::size_t>(from)];
    }
  });
  move(count_ / kBlock, dx / kBlock, dy / kBlock,
       [&](std::size_t to, int from) { blocks_[to] = from < 0 ? Block{} : blocks_[static_cast<std::size_t>(from)]; });
  origin_ += Eigen::Vector3i(dx, dy, 0);
  uncovered_ = true;
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

void OccupancyMap::set(std::size_t column, int z, int odds) noexcept {
  const Layers bit = Layers{1} << z;
  cells_[column * static_cast<std::size_t>(layers_) + static_cast<std::size_t>(z)].odds =
      static_cast<std::int8_t>(odds);
  Column& c = columns_[column];
  c.unseen &= ~bit;
  c.occupied = odds > 0 ? c.occupied | bit : c.occupied & ~bit;
  const bool settles = odds == least_;
  if (settles == ((c.settled & bit) != 0)) return;
  c.settled ^= bit;
  const auto row = static_cast<std::size_t>(count_);
  Block& block = blocks_[this->block(static_cast<int>(column / row), static_cast<int>(column % row))];
  std::uint8_t& count = block.count[static_cast<std::size_t>(z)];
  count = static_cast<std::uint8_t>(settles ? count + 1 : count - 1);
  block.settled = count == kBlock * kBlock ? block.settled | bit : block.settled & ~bit;
}

void OccupancyMap::hit(const Vector3& p) noexcept {
  const Eigen::Vector3i at_cell = cell_of(p);
  if (!inside(at_cell)) return;
  Cell& cell = cells_[at(at_cell)];
  if (cell.frame == frame_) return;
  cell.frame = frame_;
  const int before = cell.odds == kUnseen ? 0 : cell.odds, after = std::min(before + hit_, most_);
  if (after == before) return;
  const std::size_t in = column(at_cell.x(), at_cell.y());
  set(in, at_cell.z(), after);
  const bool uncovered = after > 0 && (covered_[in] >> at_cell.z() & 1) == 0;
  if (uncovered && (at_cell.array() >= region_.low.array()).all() && (at_cell.array() < region_.high.array()).all())
    uncovered_ = true;
}

void OccupancyMap::pass(const Vector3& from, const Vector3& to) noexcept {
  constexpr double kNever = 1e30;
  const Eigen::Vector3i first = cell_of(from);
  if (!inside(first)) return;
  int left = (cell_of(to) - first).cwiseAbs().sum();  // steps from cell to cell
  struct Axis {
    int cell, step;
    double next, each;  // share of the ray at the next step, and between two steps
    double per;         // steps in a ray
    // Steps up to a share of the ray.
    int until(double share) const noexcept { return static_cast<int>(std::max(0.0, (share - next) * per + 1.0)); }
    // Share at which the ray leaves the block.
    double leaves() const noexcept {
      const int in_block = cell & (kBlock - 1);
      return next + (step > 0 ? kBlock - 1 - in_block : in_block) * each;
    }
    void go(int steps) noexcept {
      cell += step * steps;
      next += steps * each;
    }
  };
  double end = kNever;  // share at which the ray leaves the window
  const Vector3 way = to - from, low = low_corner(first);
  const auto along = [&](int i) {
    if (way[i] == 0.0) return Axis{first[i], 1, kNever, kNever, 1.0};
    const bool up = way[i] > 0.0;
    const double each = size_ / std::abs(way[i]),
                 next = std::abs(low[i] + (up ? size_ : 0.0) - from[i]) / std::abs(way[i]);
    // The sum of steps may be less than this product, by rounding.
    constexpr double kRounding = 1e-9;
    end = std::min(end, next + (up ? cells()[i] - 1 - first[i] : first[i]) * each - kRounding);
    return Axis{first[i], up ? 1 : -1, next, each, std::abs(way[i]) / size_};
  };
  Axis x = along(0), y = along(1), z = along(2);
  const std::ptrdiff_t to_x = static_cast<std::ptrdiff_t>(x.step) * count_ * layers_;
  const std::ptrdiff_t to_y = static_cast<std::ptrdiff_t>(y.step) * layers_;
  while (left > 0 && inside({x.cell, y.cell, z.cell})) {
    // Up to `out` the ray is in one block.
    const double out = std::min(end, std::min(x.leaves(), y.leaves()));
    const int up = z.until(out);
    const int last = std::clamp(z.cell + z.step * up, 0, layers_ - 1);
    const Layers passed = bits(std::min(z.cell, last), std::max(z.cell, last) + 1);
    if ((passed & ~blocks_[block(x.cell, y.cell)].settled) == 0) {
      if (out >= end) return;
      const int steps_x = x.until(out), steps_y = y.until(out);
      x.go(steps_x);
      y.go(steps_y);
      z.go(up);
      left -= steps_x + steps_y + up;
      continue;
    }
    Cell* cell = cells_.data() + at({x.cell, y.cell, z.cell});
    double t;
    do {
      if (cell->frame != frame_ && cell->odds != least_) {
        const int before = cell->odds == kUnseen ? 0 : cell->odds, after = std::max(before - pass_, least_);
        cell->frame = frame_;
        // Most are free, and stay so above the lower bound.
        if (cell->odds < 0 && cell->odds != kUnseen && after > least_)
          cell->odds = static_cast<std::int8_t>(after);
        else
          set(column(x.cell, y.cell), z.cell, after);
      }
      // Without branches: which axis is next cannot be guessed.
      t = std::min(x.next, std::min(y.next, z.next));
      if (t >= end) return;
      const bool along_x = x.next == t, along_y = !along_x && y.next == t, along_z = !along_x && !along_y;
      cell += along_x ? to_x : along_y ? to_y : z.step;
      x.cell += along_x ? x.step : 0;
      y.cell += along_y ? y.step : 0;
      z.cell += along_z ? z.step : 0;
      x.next += along_x ? x.each : 0.0;
      y.next += along_y ? y.each : 0.0;
      z.next += along_z ? z.each : 0.0;
      --left;
    } while (left > 0 && t < out);
  }
}

bool OccupancyMap::freed_already(const Eigen::Vector3i& cell, bool surely) const noexcept {
  if (!inside(cell)) return true;
  const int odds = cells_[at(cell)].odds;
  return surely ? odds != kUnseen && odds <= -pass_ : odds != kUnseen;
}

void OccupancyMap::take_for_free(const Eigen::Vector3i& cell, bool surely) noexcept {
  if (!freed_already(cell, surely)) set(column(cell.x(), cell.y()), cell.z(), -pass_);
}

void OccupancyMap::cover(Kind kind, CellBox region, std::vector<CellBox>& boxes) noexcept {
  region.low = region.low.cwiseMax(0);
  region.high = region.high.cwiseMin(cells());
  const auto& [low, high] = region;
  const bool occupied = kind == Kind::kOccupied;
  const auto of_kind = [&](const Column& c) { return occupied ? c.occupied : c.unseen; };
  const auto each_column = [&](const CellBox& box, auto&& of) {
    for (int x = box.low.x(); x < box.high.x(); ++x)
      for (int y = box.low.y(); y < box.high.y(); ++y)
        if (!of(column(x, y))) return false;
    return true;
  };
  if ((low.array() >= high.array()).any()) return boxes.clear();
  const Layers layers = bits(low.z(), high.z());
  each_column(region, [&](std::size_t c) {
    left_[c] = of_kind(columns_[c]) & layers;
    return true;
  });
  if (occupied) {
    region_ = region;
    uncovered_ = false;
    std::fill(covered_.begin(), covered_.end(), 0);
  }
  const auto take = [&](const CellBox& box) {
    const Layers mask = bits(box.low.z(), box.high.z());
    each_column(box, [&](std::size_t c) {
      left_[c] &= ~mask;
      if (occupied) covered_[c] |= mask;
      return true;
    });
  };
  std::erase_if(boxes, [&](const CellBox& box) {
    if ((box.low.array() < 0).any() || (box.high.array() > cells().array()).any()) return true;
    const Layers mask = bits(box.low.z(), box.high.z());
    const bool holds = (box.low.array() < high.array()).all() && (box.high.array() > low.array()).all() &&
                       each_column(box, [&](std::size_t c) { return (of_kind(columns_[c]) & mask) == mask; });
    if (holds) take(box);
    return !holds;
  });
  for (int x = low.x(); x < high.x(); ++x)
    for (int y = low.y(); y < high.y(); ++y)
      for (const Layers* left = &left_[column(x, y)]; *left != 0;) {
        if (boxes.size() == boxes.capacity()) return;
        const int z = std::countr_zero(*left), run = std::min(kLongest, std::countr_one(*left >> z));
        const Layers mask = bits(z, z + run);
        const auto all_left = [&](std::size_t c) { return (left_[c] & mask) == mask; };
        CellBox box{{x, y, z}, {x + 1, y + 1, z + run}};
        while (box.high.y() < std::min(high.y(), y + kLongest) && all_left(column(x, box.high.y()))) ++box.high.y();
        while (box.high.x() < std::min(high.x(), x + kLongest) &&
               each_column({{box.high.x(), y, z}, {box.high.x() + 1, box.high.y(), z + run}}, all_left))
          ++box.high.x();
        take(box);
        boxes.push_back(box);
      }
}

}  // namespace moma
