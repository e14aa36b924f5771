#include "controller/map/occupancy_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace moma {
namespace {

int units(double log_odds) noexcept { return static_cast<int>(std::lround(log_odds / OccupancyMap::kUnit)); }

// Bits from `low` up to below `high`; 0 <= low < high <= 64.
std::uint64_t bits(int low, int high) noexcept { return (~std::uint64_t{0} >> (64 - (high - low))) << low; }

// By value, which compiles to one instruction.
double less(double a, double b) noexcept { return a < b ? a : b; }
double greater(double a, double b) noexcept { return a > b ? a : b; }

}  // namespace

OccupancyMap::OccupancyMap(const MapParams& params)
    : size_(params.cell),
      count_(std::max(4 * kRoll, static_cast<int>(std::lround(params.window / params.cell)))),
      layers_(std::clamp(static_cast<int>(std::lround(params.height / params.cell)), 1, kMostLayers)),
      hit_(units(params.evidence.hit)),
      pass_(units(params.evidence.pass)),
      least_(-units(params.evidence.least)),
      most_(units(params.evidence.most)),
      pocket_(static_cast<int>(std::lround(params.unseen.least / params.cell))),
      behind_(static_cast<int>(std::lround(params.unseen.behind / params.cell))) {
  count_ += (kBlock - count_ % kBlock) % kBlock;
  clear(0.0, 0.0);
}

void OccupancyMap::clear(double x, double y) {
  const std::size_t columns = static_cast<std::size_t>(count_) * static_cast<std::size_t>(count_);
  odds_.assign(columns * static_cast<std::size_t>(layers_), kUnseen);
  passed_.assign(columns, 0);
  hits_.assign(columns, 0);
  changed_.clear();
  changed_.reserve(columns / (kBlock * kBlock));
  columns_.assign(columns, Column{});
  left_.assign(columns, 0);
  cubes_.assign(columns, 0);
  covered_.assign(columns, 0);
  blocks_.assign(columns / (kBlock * kBlock), Block{});
  region_ = {};
  uncovered_ = false;
  origin_ = {static_cast<int>(std::floor(x / size_)) - count_ / 2, static_cast<int>(std::floor(y / size_)) - count_ / 2,
             0};
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
    std::int8_t* odds = odds_.data() + to * layers;
    if (from < 0) {
      std::fill_n(odds, layers, static_cast<std::int8_t>(kUnseen));
      columns_[to] = Column{};
    } else {
      std::copy_n(odds_.data() + static_cast<std::size_t>(from) * layers, layers, odds);
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
  Eigen::Vector3i cell;
  for (int i = 0; i < 3; ++i) {
    const double at = less(greater(p[i] / size_, -kFar), kFar);
    const int toward_zero = static_cast<int>(at);
    cell[i] = toward_zero - (at < toward_zero ? 1 : 0) - origin_[i];
  }
  return cell;
}

void OccupancyMap::set(std::size_t column, std::size_t block, int z, int odds) noexcept {
  const Layers bit = Layers{1} << z;
  odds_[column * static_cast<std::size_t>(layers_) + static_cast<std::size_t>(z)] = static_cast<std::int8_t>(odds);
  Column& c = columns_[column];
  c.unseen &= ~bit;
  c.occupied = odds > 0 ? c.occupied | bit : c.occupied & ~bit;
  const bool settles = odds == least_;
  if (settles == ((c.settled & bit) != 0)) return;
  c.settled ^= bit;
  Block& in = blocks_[block];
  std::uint8_t& count = in.count[static_cast<std::size_t>(z)];
  count = static_cast<std::uint8_t>(settles ? count + 1 : count - 1);
  in.settled = count == kBlock * kBlock ? in.settled | bit : in.settled & ~bit;
}

void OccupancyMap::hit(const Vector3& p, const Vector3& along) noexcept {
  const Eigen::Vector3i at_cell = cell_of(p);
  if (!inside(at_cell)) return;
  const std::size_t in = column(at_cell.x(), at_cell.y());
  const Layers bit = Layers{1} << at_cell.z();
  if ((hits_[in] & bit) != 0) return;
  hits_[in] |= bit;
  for (int k = 1; k <= behind_; ++k) {
    const Eigen::Vector3i hidden = cell_of(p + k * size_ * along);
    if (inside(hidden)) columns_[column(hidden.x(), hidden.y())].behind |= Layers{1} << hidden.z();
  }
  const std::size_t at_block = block(at_cell.x(), at_cell.y());
  change(at_block);
  const int is = odds_[at(at_cell)], before = is == kUnseen ? 0 : is, after = std::min(before + hit_, most_);
  if (after == before) return;
  set(in, at_block, at_cell.z(), after);
  const bool uncovered = after > 0 && (covered_[in] >> at_cell.z() & 1) == 0;
  if (uncovered && (at_cell.array() >= region_.low.array()).all() && (at_cell.array() < region_.high.array()).all())
    uncovered_ = true;
}

void OccupancyMap::pass(const Vector3& from, const Vector3& to) noexcept {
  const Eigen::Vector3i first = cell_of(from), last = cell_of(to);
  if (!inside(first)) return;
  const bool leaves = !inside(last);
  const Vector3 way = to - from, low = low_corner(first);
  double end = 1.0;  // share of the ray at which it ends or leaves the window
  // An axis in shares of the ray: of the first step between cells, and between two; `per` steps in a ray.
  struct Axis {
    int cell, step;
    double next, each, per;
    int until(double share) const noexcept { return static_cast<int>(greater(0.0, (share - next) * per + 1.0)); }
    int after(int steps) const noexcept { return cell + step * steps; }
    double share(int steps) const noexcept { return next + steps * each; }
    // Steps with which the ray leaves its first block.
    int leave() const noexcept { return step > 0 ? kBlock - (cell & (kBlock - 1)) : (cell & (kBlock - 1)) + 1; }
  };
  const auto along = [&](int i) {
    constexpr double kNever = 1e30;
    if (way[i] == 0.0) return Axis{first[i], 1, kNever, 0.0, 1.0};
    const bool up = way[i] > 0.0;
    const double per_way = 1.0 / way[i], each = size_ * std::abs(per_way);
    const double next = (low[i] + (up ? size_ : 0.0) - from[i]) * per_way;
    if (leaves)
      end = less(end, next + (up ? cells()[i] - 1 - first[i] : first[i]) * each - 1e-9);  // inside, by rounding
    return Axis{first[i], up ? 1 : -1, next, each, std::abs(way[i]) / size_};
  };
  const Axis x = along(0), y = along(1), z = along(2);
  const bool rises = z.step > 0;
  const int z_end = leaves ? (rises ? layers_ - 1 : 0) : last.z();
  const int lowest = std::min(z.cell, z_end), highest = std::max(z.cell, z_end);
  const auto layer = [&](double share) { return std::clamp(z.after(z.until(share)), lowest, highest); };
  const auto between = [rises](int a, int b) { return rises ? bits(a, b + 1) : bits(b, a + 1); };
  const int steps = std::abs(last.x() - first.x()) + std::abs(last.y() - first.y());
  // The ray leaves the present block with these steps, at this share of its length, and has come in at that one.
  int out_x = x.leave(), out_y = y.leave();
  double next_x = x.share(out_x - 1), next_y = y.share(out_y - 1), in = -1.0;
  bool in_by_x = true;
  std::size_t at_block = block(x.cell, y.cell);
  for (int in_z = z.cell;;) {
    const bool by_x = next_x <= next_y;
    const double out = less(end, by_x ? next_x : next_y);
    const int out_z = layer(out);
    if ((between(in_z, out_z) & ~blocks_[at_block].settled) != 0) {
      change(at_block);
      const auto steps_before = [&](const Axis& axis, int leave, bool by) {
        if (in < 0.0) return 0;
        return by ? leave - kBlock : std::clamp(axis.until(in), std::max(0, leave - kBlock), leave - 1);
      };
      const int steps_x = steps_before(x, out_x, in_by_x), steps_y = steps_before(y, out_y, !in_by_x);
      int left = steps - steps_x - steps_y;
      double column_x = x.share(steps_x), column_y = y.share(steps_y);
      std::size_t at_column = column(x.after(steps_x), y.after(steps_y));
      // From column to column, without branches: which axis is next cannot be guessed. Sums differ from products by
      // rounding.
      const double leave = out - 1e-12;
      int z_before = in_z;
      double t = less(column_x, column_y);
      for (; left > 0 && t < end; --left) {
        const bool on_x = column_x <= column_y;
        const int z_after = layer(t);
        passed_[at_column] |= between(z_before, z_after);
        if (t >= leave) break;
        z_before = z_after;
        column_x += on_x ? x.each : 0.0;
        column_y += on_x ? 0.0 : y.each;
        at_column += static_cast<std::size_t>(on_x ? x.step * count_ : y.step);
        t = less(column_x, column_y);
      }
      if (left == 0 || t >= end) {
        const Layers ends = leaves ? between(z_before, layer(end)) : between(z_before, z_end) & ~(Layers{1} << z_end);
        passed_[at_column] |= ends;
        return;
      }
      if (left < 0) return;
    }
    if (out >= end) return;
    in_z = out_z;
    in = out;
    in_by_x = by_x;
    out_x += by_x ? kBlock : 0;
    out_y += by_x ? 0 : kBlock;
    next_x += by_x ? kBlock * x.each : 0.0;
    next_y += by_x ? 0.0 : kBlock * y.each;
    at_block += static_cast<std::size_t>(by_x ? count_ / kBlock * x.step : y.step);
  }
}

void OccupancyMap::change(std::size_t block) noexcept {
  if (std::exchange(blocks_[block].changed, true)) return;
  changed_.push_back(block);
}

void OccupancyMap::end() noexcept {
  for (const std::size_t in : changed_) {
    blocks_[in].changed = false;
    const int in_row = count_ / kBlock, b = static_cast<int>(in), x = b / in_row * kBlock, y = b % in_row * kBlock;
    for (int i = 0; i < kBlock * kBlock; ++i) {
      const std::size_t c = column(x + i / kBlock, y + i % kBlock);
      Layers layers = std::exchange(passed_[c], 0) & ~(columns_[c].settled | std::exchange(hits_[c], 0));
      for (std::int8_t* odds = &odds_[c * static_cast<std::size_t>(layers_)]; layers != 0; layers &= layers - 1) {
        const int z = std::countr_zero(layers), before = odds[z];
        const int after = std::max((before == kUnseen ? 0 : before) - pass_, least_);
        // Most are free, and stay so above the lower bound.
        if (before < 0 && before != kUnseen && after > least_)
          odds[z] = static_cast<std::int8_t>(after);
        else
          set(c, in, z, after);
      }
    }
  }
  changed_.clear();
}

bool OccupancyMap::freed_already(const Eigen::Vector3i& cell, bool surely) const noexcept {
  if (!inside(cell)) return true;
  const int odds = odds_[at(cell)];
  return surely ? odds != kUnseen && odds <= -pass_ : odds != kUnseen;
}

void OccupancyMap::take_for_free(const Eigen::Vector3i& cell, bool surely) noexcept {
  if (!freed_already(cell, surely)) set(column(cell.x(), cell.y()), block(cell.x(), cell.y()), cell.z(), -pass_);
}

// A cell is the low corner of a cube without a free cell unless a free cell lies in that cube: free cells grow
// downwards, and the corners that they leave grow upwards to cubes.
void OccupancyMap::leave_out_pockets(const CellBox& region) noexcept {
  const int more = pocket_ - 1;
  if (more <= 0) return;
  const Eigen::Vector3i low = (region.low.array() - more).cwiseMax(0), high = (region.high.array() + more).min(count_);
  const Layers outside = ~bits(0, layers_);
  const auto each_column = [&](bool upwards, auto&& of) {
    for (int i = 0; i < high.x() - low.x(); ++i)
      for (int j = 0; j < high.y() - low.y(); ++j)
        upwards ? of(low.x() + i, low.y() + j) : of(high.x() - 1 - i, high.y() - 1 - j);
  };
  // By a cell, in place: in the order in which no changed cell is read.
  const auto grow = [&](bool downwards, Layers beyond) {
    const int side = downwards ? 1 : -1;
    const auto in = [&](int x, int y) {
      return x >= low.x() && y >= low.y() && x < high.x() && y < high.y() ? cubes_[column(x, y)] : beyond;
    };
    for (int k = 0; k < more; ++k)
      each_column(downwards, [&](int x, int y) {
        const Layers any = in(x, y) | in(x + side, y) | in(x, y + side) | in(x + side, y + side);
        cubes_[column(x, y)] = any | (downwards ? any >> 1 : any << 1);
      });
  };
  each_column(true, [&](int x, int y) {
    const Column& c = columns_[column(x, y)];
    cubes_[column(x, y)] = ~(c.unseen | c.occupied | outside);
  });
  grow(true, 0);
  each_column(true, [&](int x, int y) { cubes_[column(x, y)] = ~cubes_[column(x, y)]; });
  grow(false, ~Layers{0});
  for (int x = region.low.x(); x < region.high.x(); ++x)
    for (int y = region.low.y(); y < region.high.y(); ++y)
      left_[column(x, y)] &= cubes_[column(x, y)] | columns_[column(x, y)].behind;
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
  if (!occupied) leave_out_pockets(region);
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
