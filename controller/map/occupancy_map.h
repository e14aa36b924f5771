#pragma once

#include <cstdint>
#include <span>
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
class OccupancyMap {
 public:
  explicit OccupancyMap(const MapParams& params);

  /// Forgets everything; the window's middle is near (x, y).
  void clear(double x, double y);
  /// Moves the window, if (x, y) is more than kRoll from its middle. Cells that come into it are unseen. True if it
  /// moved.
  bool centre(double x, double y) noexcept;

  /// A frame: begin(), then all its hits, then all its rays.
  void begin() noexcept;
  void hit(const Vector3& p) noexcept;
  /// A ray from the sensor to its end, or to its range; the end's cell stays.
  void pass(const Vector3& from, const Vector3& to) noexcept;
  /// Takes a cell for free, if nothing else is known of it; `surely`: whatever is known.
  void take_for_free(const Eigen::Vector3i& cell, bool surely) noexcept;

  bool occupied(const Eigen::Vector3i& cell) const noexcept { return inside(cell) && cells_[at(cell)].odds > 0; }
  bool unseen(const Eigen::Vector3i& cell) const noexcept { return inside(cell) && cells_[at(cell)].odds == kUnseen; }
  /// Log-odds in units of kUnit; kUnseen where no ray has been.
  int odds(const Eigen::Vector3i& cell) const noexcept { return inside(cell) ? cells_[at(cell)].odds : kUnseen; }
  Eigen::Vector3i cell_of(const Vector3& p) const noexcept;
  Vector3 low_corner(const Eigen::Vector3i& cell) const noexcept { return size_ * (cell + origin_).cast<double>(); }
  double cell() const noexcept { return size_; }
  Eigen::Vector3i cells() const noexcept { return {count_, count_, layers_}; }
  /// True if each cell inside `region` that became occupied since the last call is in one of the boxes. False where
  /// these are more than kFresh.
  bool covers_fresh(std::span<const CellBox> boxes, const CellBox& region) noexcept;

  enum class Kind { kOccupied, kUnseen };
  /// Covers the cells of a kind inside `region` with disjoint boxes of at most kLongest cells an edge, at most as many
  /// as `boxes` has capacity for.
  void cover(Kind kind, CellBox region, std::vector<CellBox>& boxes) noexcept;

  static constexpr int kUnseen = -128;
  static constexpr double kUnit = 0.05;
  static constexpr std::size_t kFresh = 2000;
  static constexpr int kRoll = 8;      // cells
  static constexpr int kLongest = 16;  // cells

 private:
  struct Cell {
    std::int8_t odds = kUnseen;
    std::uint8_t frame = 0;  // that changed it last
  };
  bool inside(const Eigen::Vector3i& c) const noexcept {
    return (c.array() >= 0).all() && c.x() < count_ && c.y() < count_ && c.z() < layers_;
  }
  std::size_t column(int x, int y) const noexcept { return static_cast<std::size_t>(x * count_ + y); }
  std::size_t at(const Eigen::Vector3i& c) const noexcept {
    return column(c.x(), c.y()) * static_cast<std::size_t>(layers_) + static_cast<std::size_t>(c.z());
  }
  void change(std::size_t index, int by) noexcept;
  void set(std::size_t index, int odds) noexcept;
  bool counts(Kind kind, std::size_t index) const noexcept {
    return kind == Kind::kOccupied ? cells_[index].odds > 0 : cells_[index].odds == kUnseen;
  }

  double size_;
  int count_, layers_;
  int hit_, pass_, least_, most_;                     // in units
  Eigen::Vector3i origin_ = Eigen::Vector3i::Zero();  // of the window's first cell, in cells
  std::vector<Cell> cells_;
  std::vector<std::int16_t> occupied_;  // number of occupied cells of each column
  std::vector<char> left_;              // cells that cover() has not covered yet
  std::vector<int> fresh_;              // cells that became occupied
  std::uint8_t frame_ = 0;
};

}  // namespace moma
