#include "controller/model/coal_pair.h"

#include <coal/shape/convex.h>

#include <cmath>

namespace moma {

std::unique_ptr<coal::ShapeBase> make_coal_shape(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::kSphere: return std::make_unique<coal::Sphere>(shape.size.x());
    case ShapeKind::kBox: return std::make_unique<coal::Box>(shape.size);
    case ShapeKind::kCylinder: return std::make_unique<coal::Cylinder>(shape.size.x(), shape.size.y());
    case ShapeKind::kCapsule: return std::make_unique<coal::Capsule>(shape.size.x(), shape.size.y());
    case ShapeKind::kConvex: break;
  }
  auto points = std::make_shared<std::vector<coal::Vec3s>>();
  auto triangles = std::make_shared<std::vector<coal::Triangle>>();
  if (shape.hull) {
    points->assign(shape.hull->vertices.begin(), shape.hull->vertices.end());
    for (const Eigen::Vector3i& t : shape.hull->triangles)
      triangles->emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                              static_cast<std::size_t>(t[2]));
  }
  const auto num_points = static_cast<unsigned>(points->size());
  const auto num_triangles = static_cast<unsigned>(triangles->size());
  return std::make_unique<coal::Convex<coal::Triangle>>(points, num_points, triangles, num_triangles);
}

CoalPair::CoalPair(const coal::ShapeBase& first, const coal::ShapeBase& second)
    : coal::ComputeDistance(&first, &second), request_(true, true) {
  // The default gap of 1e-6 leaves 1e-3 rad in the direction at round shapes. Much below 1e-10 it fails to converge
  // for about one pair of 100,000 with a cylinder.
  request_.gjk_tolerance = 1e-10;
  request_.gjk_max_iterations = 512;
  request_.gjk_initial_guess = coal::GJKInitialGuess::DefaultGuess;
}

Distance CoalPair::distance(const coal::ShapeBase& first, const Isometry& X_W1, const coal::ShapeBase& second,
                            const Isometry& X_W2) noexcept {
  Distance distance;
  bool good = false;
  try {
    o1 = &first;
    o2 = &second;
    result_.clear();
    (*this)(to_coal(X_W1), to_coal(X_W2), request_, result_);
    distance.d = result_.min_distance;
    distance.n_W = -result_.normal;   // coal's points from the first to the second
    distance.p_first_W = result_.nearest_points[0];
    distance.p_second_W = result_.nearest_points[1];
    const double length = distance.n_W.norm();
    good = std::isfinite(distance.d) && std::abs(length - 1.0) < 1e-3 && distance.p_first_W.allFinite() &&
           distance.p_second_W.allFinite();
    if (good) distance.n_W /= length;
  } catch (...) {
    // Left to the fallback: a control step has to go on.
  }
  if (!good) {
    // No direction was found, which happens only in deep contact: apart along the line of centres.
    if (!std::isfinite(distance.d)) distance.d = 0.0;
    const Vector3 between = X_W1.translation() - X_W2.translation();
    const double length = between.norm();
    distance.n_W = length > 1e-12 ? Vector3(between / length) : Vector3(Vector3::UnitZ());
    distance.p_second_W = 0.5 * (X_W1.translation() + X_W2.translation());
    distance.p_first_W = distance.p_second_W + distance.d * distance.n_W;
  }
  return distance;
}

}  // namespace moma
