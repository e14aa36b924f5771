#include "tests/support/coal_distance.h"

#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

#include <memory>
#include <stdexcept>

namespace moma::test {
namespace {

std::unique_ptr<coal::ShapeBase> solid(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return std::make_unique<coal::Sphere>(shape.size.x());
    case ShapeKind::kBox:
      return std::make_unique<coal::Box>(shape.size.x(), shape.size.y(), shape.size.z());
    case ShapeKind::kCylinder:
      return std::make_unique<coal::Cylinder>(shape.size.x(), shape.size.y());
    case ShapeKind::kCapsule:
      return std::make_unique<coal::Capsule>(shape.size.x(), shape.size.y());
    case ShapeKind::kConvex:
      break;
  }
  throw std::invalid_argument("coal_distance: a convex hull");
}

}  // namespace

double coal_distance(const Shape& first, const Isometry& X_W1, const Shape& second, const Isometry& X_W2) {
  const auto a = solid(first);
  const auto b = solid(second);
  coal::DistanceRequest request;
  request.enable_signed_distance = true;
  request.gjk_tolerance = 1e-9;
  coal::DistanceResult result;
  return coal::distance(a.get(), coal::Transform3s(X_W1.linear(), X_W1.translation()), b.get(),
                        coal::Transform3s(X_W2.linear(), X_W2.translation()), request, result);
}

}  // namespace moma::test
