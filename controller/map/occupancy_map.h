#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "controller/map/params.h"
#include "controller/types.h"

namespace moma {

/// Cells [low, high) of each axis.
struct CellBox {
  Eigen::Vector3i low = Eigen::Vector3i::Zero();
  Eigen::Vector3i high = Eigen::Vector3i::Zero();
};

/// A grid of free, occupied and unseen cells in a window that moves with the robot. Each cell has log-odds of its
/// occupancy; a frame changes a cell once, and a hit counts more than the frame's passing rays (Hornung et al.,
/// OctoMap, Autonomous Robots 34, 2013). Rays walk from cell to cell (Amanatides & Woo, Eurographics 1987). Points are
/// in the axes of the measured base pose, and the window's floor is z = 0. Only the constructor and clear() allocate.
///
/// A column of cells has a bit for each of its layers: which are occupied, unseen, settled (at the lower bound of the
/// log-odds, where a passing ray changes nothing). A ray jumps over the blocks of columns whose cells on its way are
/// all settled. Boxes grow by whole columns.
class OccupancyMap {
 public:
  explicit OccupancyMap(const MapParams& params);

  /// Forgets everything; the window's middle is near (x, y).
  void clear(double x, double y);
  /// Moves the window, if (x, y) is more than kRoll from its middle. Cells that come into it are unseen. True if it
  /// moved.
  bool centre(double x, double y) noexcept;

  /// A frame: all its hits, then all its rays, then end(), with which the rays count. `p` is a ray's end, `along` its
  /// direction, of unit length.
  void hit(const Vector3& p, const Vector3& along) noexcept;
  /// A ray from the sensor to its end, or to its range; the end's cell stays.
  void pass(const Vector3& from, const Vector3& to) noexcept;
  void end() noexcept;
  /// Takes a cell for free, if nothing else is known of it; `surely`: whatever is known.
  void take_for_free(const Eigen::Vector3i& cell, bool surely) noexcept;
  /// True if that changes nothing.
  bool freed_already(const Eigen::Vector3i& cell, bool surely) const noexcept;

  bool occupied(const Eigen::Vector3i& cell) const noexcept { return inside(cell) && odds_[at(cell)] > 0; }
  bool unseen(const Eigen::Vector3i& cell) const noexcept { return inside(cell) && odds_[at(cell)] == kUnseen; }
  /// Log-odds in units of kUnit; kUnseen where no ray has been.
  int odds(const Eigen::Vector3i& cell) const noexcept { return inside(cell) ? odds_[at(cell)] : kUnseen; }
  Eigen::Vector3i cell_of(const Vector3& p) const noexcept;
  Vector3 low_corner(const Eigen::Vector3i& cell) const noexcept { return size_ * (cell + origin_).cast<double>(); }
  double cell() const noexcept { return size_; }
  Eigen::Vector3i cells() const noexcept { return {count_, count_, layers_}; }
  /// The window's first cell, in cells; it changes as the window moves.
  const Eigen::Vector3i& origin() const noexcept { return origin_; }
  /// True if the window moved since the last cover() of occupied cells, or a cell inside its region and outside its
  /// boxes became occupied.
  bool uncovered() const noexcept { return uncovered_; }

  enum class Kind { kOccupied, kUnseen };
  /// Covers the cells of a kind inside `region` with disjoint boxes of at most kLongest cells an edge, at most as many
  /// as `boxes` has capacity for. Keeps the given boxes that touch the region and have cells of the kind alone. Unseen
  /// cells count only in a cube with edges of `unseen.least` without a free cell, since nothing larger than the cube
  /// can hide in the others, and up to `unseen.behind` behind a hit. What lies outside the window is not free.
  void cover(Kind kind, CellBox region, std::vector<CellBox>& boxes) noexcept;

  static constexpr int kUnseen = -128;
  static constexpr double kUnit = 0.05;
  static constexpr int kMostLayers = 64;
  static constexpr int kRoll = 8;      // cells
  static constexpr int kLongest = 16;  // cells

 private:
  bool inside(const Eigen::Vector3i& c) const noexcept {
    return (c.array() >= 0).all() && c.x() < count_ && c.y() < count_ && c.z() < layers_;
  }
  using Layers = std::uint64_t;  // a bit for each
  struct Column {
    Layers occupied = 0, unseen = ~Layers{0}, settled = 0, behind = 0;
  };
  static constexpr int kBlock = 8;  // columns
  struct Block {
    Layers settled = 0;                             // layers in which all of its columns are settled
    std::array<std::uint8_t, kMostLayers> count{};  // settled cells of each layer
    bool changed = false;                           // it is in changed_
  };

  std::size_t column(int x, int y) const noexcept { return static_cast<std::size_t>(x * count_ + y); }
  std::size_t block(int x, int y) const noexcept {
    const auto in_row = [](int i) { return static_cast<unsigned>(i) / kBlock; };
    return in_row(x) * in_row(count_) + in_row(y);
  }
  std::size_t at(const Eigen::Vector3i& c) const noexcept {
    return column(c.x(), c.y()) * static_cast<std::size_t>(layers_) + static_cast<std::size_t>(c.z());
  }
  void set(std::size_t column, std::size_t block, int z, int odds) noexcept;
  void change(std::size_t block) noexcept;
  /// Takes the cells from left_ that are in no such cube.
  void leave_out_pockets(const CellBox& region) noexcept;

  double size_;
  int count_, layers_;
  int hit_, pass_, least_, most_;                     // in units
  int pocket_;                                        // edge of the cubes, in cells
  int behind_;                                        // depth behind a hit, in cells
  Eigen::Vector3i origin_ = Eigen::Vector3i::Zero();  // of the window's first cell, in cells
  std::vector<std::int8_t> odds_;
  std::vector<Column> columns_;
  std::vector<Block> blocks_;
  std::vector<Layers> left_;     // cells of each column that cover() has not covered yet
  std::vector<Layers> cubes_;    // cells of each column in cubes without a free cell
  std::vector<Layers> covered_;  // cells of each column in a box of the last cover() of occupied cells
  CellBox region_;               // of that call
  bool uncovered_ = false;
  std::vector<Layers> passed_, hits_;  // cells of each column that the present frame has met
  std::vector<std::size_t> changed_;   // blocks with such cells
};

}  // namespace moma
