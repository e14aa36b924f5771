#pragma once

#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

#include <memory>

#include "controller/model/proximity.h"

namespace moma {

/// The geometry that coal works on. A convex hull is copied once.
std::unique_ptr<coal::ShapeBase> make_coal_shape(const Shape& shape);

inline coal::Transform3s to_coal(const Isometry& X) { return coal::Transform3s(X.linear(), X.translation()); }

/// coal's distance function of one pair of shape kinds: built once (its solver owns buffers), then used for any two
/// geometries of these kinds. Not shared among threads.
class CoalPair final : public coal::ComputeDistance {
 public:
  CoalPair(const coal::ShapeBase& first, const coal::ShapeBase& second);

  /// Signed distance; does not allocate. Starts from coal's default guess, so earlier calls leave no trace.
  Distance distance(const coal::ShapeBase& first, const Isometry& X_W1, const coal::ShapeBase& second,
                    const Isometry& X_W2) noexcept;

 private:
  coal::DistanceRequest request_;
  coal::DistanceResult result_;
};

}  // namespace moma
