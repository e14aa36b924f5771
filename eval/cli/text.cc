#include "eval/cli/text.h"

#include <fmt/format.h>

namespace moma::cli {
std::string shape_text(const Shape& shape) {
  const Vector3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return fmt::format("sphere, radius {:.4g}", s.x());
    case ShapeKind::kBox:
      return fmt::format("box {:.4g} x {:.4g} x {:.4g}", s.x(), s.y(), s.z());
    case ShapeKind::kCylinder:
      return fmt::format("cylinder, radius {:.4g}, length {:.4g}", s.x(), s.y());
    case ShapeKind::kCapsule:
      return fmt::format("capsule, radius {:.4g}, length {:.4g}", s.x(), s.y());
    case ShapeKind::kConvex:
      return fmt::format("convex hull of {} points", shape.hull == nullptr ? 0 : shape.hull->vertices.size());
  }
  return "";
}

std::string vector_text(const Eigen::Ref<const VectorX>& v) {
  std::string text = "(";
  for (Eigen::Index i = 0; i < v.size(); ++i) text += fmt::format("{}{:.4f}", i > 0 ? ", " : "", v[i]);
  return text + ")";
}

}  // namespace moma::cli
