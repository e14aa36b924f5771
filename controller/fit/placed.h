#pragma once

#include <optional>
#include <span>
#include <vector>

#include "controller/fit/cloud.h"
#include "controller/model/shape.h"

namespace moma::fit {

/// Least thickness of a shape [m]: twice its radius, or its edge. Flat and thin meshes become this thick.
inline constexpr double kThinnest = 1e-3;

/// A sphere, capsule or box with its pose in the link's frame L.
struct Solid {
  Shape shape;
  Isometry X_LS = Isometry::Identity();
};

/// [m^3]
double volume(const Shape& shape) noexcept;

/// Signed distance of a point from the solid's surface, negative inside [m]; exact.
double distance(const Solid& solid, const Vector3& p_L) noexcept;

/// Volume of the union [m^3]: exact for one solid; for several counted on `samples` points of a Halton sequence in the
/// box around them, with an error of about 1 % for 4,000.
double union_volume(std::span<const Solid> solids, int samples);

/// Returns about `samples` points spread evenly over the surfaces of all solids, without those inside another one.
Points union_surface(std::span<const Solid> solids, int samples);

/// Resolution of written shapes: 0.1 mm and 0.1 mrad.
inline constexpr double kGrid = 1e-4;

/// A solid as a robot file writes it. `solid` is the one that the file's reader makes of these numbers.
struct Placed {
  Solid solid;
  Vector3 position = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
};

/// Rounds position and angles of `solid` to kGrid, and then chooses the smallest sizes in steps of kGrid that still
/// enclose all `points`. Sphere, capsule or box.
Placed rounded(const Solid& solid, const Points& points);

/// Writes a shape unchanged, to the bit except for the angles of its rotation.
Placed as_it_is(const Shape& shape, const Isometry& X_LS);

/// Error of shapes around a surface. Overshoot is the distance from points spread evenly over the shapes' outer surface
/// to the convex hull of the enclosed surface; 0 inside, since several shapes can be smaller than the hull.
struct FitError {
  std::optional<double> volume_ratio;  ///< volume of the union over that of the hull; empty if the hull is flat
  double mean_overshoot = 0.0;         ///< [m]
  double most_overshoot = 0.0;         ///< [m]
  double uncovered = 0.0;              ///< largest distance of a corner outside all shapes [m]
};

/// Measures about 2,000 points.
FitError measure(const Triangles& surface, const std::vector<Placed>& shapes);

}  // namespace moma::fit
