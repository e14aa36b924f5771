#pragma once

#include <span>

#include "controller/fit/cloud.h"
#include "controller/model/shape.h"

namespace moma::fit {

/// Thinnest that a shape gets [m]: half of it as radius, all of it as edge. Flat and thin meshes become so thick.
inline constexpr double kThinnest = 1e-3;

/// A sphere, capsule or box somewhere in the link's frame L.
struct Solid {
  Shape shape;
  Isometry X_LS = Isometry::Identity();
};

/// [m^3]
double volume(const Shape& shape) noexcept;

/// Signed distance of a point from the solid's surface, negative inside [m]; exact outside, and inside too.
double distance(const Solid& solid, const Vector3& p_L) noexcept;

/// Volume of the union: exact for one solid; for more counted on `samples` points of a Halton sequence (bases 2, 3, 5)
/// in the box around them, off by about 1 % for 4,000.
double union_volume(std::span<const Solid> solids, int samples);

/// About `samples` points spread evenly over the surfaces of all the solids, without those inside another one.
Points union_surface(std::span<const Solid> solids, int samples);

}  // namespace moma::fit
