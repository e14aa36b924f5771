#pragma once

#include <span>

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

/// Volume of the union: exact for one solid; for several counted on `samples` points of a Halton sequence (bases 2, 3,
/// 5) in the box around them, with an error of about 1 % for 4,000.
double union_volume(std::span<const Solid> solids, int samples);

/// Returns about `samples` points spread evenly over the surfaces of all solids, without those inside another one.
Points union_surface(std::span<const Solid> solids, int samples);

}  // namespace moma::fit
