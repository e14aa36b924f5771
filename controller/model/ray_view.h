#pragma once

#include <vector>

#include "controller/model/sensor.h"
#include "controller/model/shape.h"

namespace moma {

/// Distance from `from_S` along the unit vector `u_S` to the solid's surface, both in the solid's frame [m]; infinite
/// if the ray misses, or begins inside the solid. Exact for every kind; a hull is the intersection of the half-spaces
/// of its triangles.
double ray_distance(const Shape& shape, const Vector3& from_S, const Vector3& u_S) noexcept;

/// A sensor's frame: the nearest solid for each of its rays. Solids are drawn one after the other, each only in the
/// window of azimuth and elevation of its bounding ball: the cost is that of the rays near it. Only the constructor
/// allocates.
class RayView {
 public:
  static constexpr int kNothing = -1;  ///< id of a ray without a hit

  explicit RayView(const Sensor& sensor);

  /// Begins an empty frame from this pose.
  void begin(const Isometry& X_WC) noexcept;
  /// Draws a solid; its rays get `id`.
  void draw(const Shape& shape, const Isometry& X_WS, int id) noexcept;

  int columns() const noexcept { return columns_; }
  int rows() const noexcept { return rows_; }
  /// Rays in rows of equal elevation, the lowest first; in each row by increasing azimuth.
  const std::vector<Vector3>& directions_C() const noexcept { return directions_; }
  const std::vector<double>& distances() const noexcept { return distances_; }  ///< infinite: nothing in range [m]
  const std::vector<int>& ids() const noexcept { return ids_; }                 ///< or kNothing

 private:
  struct Window {
    double from, to;  // [rad]
  };
  void draw_columns(const Shape& shape, const Isometry& X_SC, int row, const Window& azimuth, int id) noexcept;

  int columns_, rows_;
  double range_, azimuth_, elevation_;  // half angles
  std::vector<Vector3> directions_;
  std::vector<double> distances_;
  std::vector<int> ids_;
  Isometry X_WC_ = Isometry::Identity();
};

}  // namespace moma
