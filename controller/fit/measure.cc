#include "controller/fit/measure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <vector>

#include "controller/config/mesh_hull.h"

namespace moma::fit {
namespace {

constexpr int kSurfaceSamples = 2000;
constexpr int kVolumeSamples = 32768;

double squared_to_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 ab = b - a;
  const double length = ab.squaredNorm();
  const double t = length > 0.0 ? std::clamp(ab.dot(p - a) / length, 0.0, 1.0) : 0.0;
  return (p - a - t * ab).squaredNorm();
}

double squared_to_triangle(const Vector3& p, const Triangle& t) {
  const Vector3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  const double area = n.squaredNorm();
  bool over = area > 0.0;
  for (std::size_t i = 0; over && i < 3; ++i) over = n.dot((t[(i + 1) % 3] - t[i]).cross(p - t[i])) >= 0.0;
  if (over) {
    const double height = n.dot(p - t[0]);
    return height * height / area;
  }
  return std::min(
      {squared_to_segment(p, t[0], t[1]), squared_to_segment(p, t[1], t[2]), squared_to_segment(p, t[2], t[0])});
}

// A convex body by its triangles, or a flat one by the triangles of the surface itself.
class Hull {
 public:
  explicit Hull(const Triangles& surface) {
    const Points points = corners(surface);
    try {
      const ConvexHull hull = config::convex_hull(points);
      Vector3 centre = Vector3::Zero();
      for (const Vector3& v : hull.vertices) centre += v / static_cast<double>(hull.vertices.size());
      double volume = 0.0;
      for (const Eigen::Vector3i& t : hull.triangles) {
        const auto at = [&](int i) { return hull.vertices[static_cast<std::size_t>(t[i])]; };
        triangles_.push_back({at(0), at(1), at(2)});
        volume += (at(0) - centre).dot((at(1) - centre).cross(at(2) - centre)) / 6.0;
      }
      volume_ = volume;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception&) {
      triangles_ = surface;
    }
  }

  std::optional<double> volume() const { return volume_; }

  /// 0 inside.
  double distance(const Vector3& p) const {
    double least = std::numeric_limits<double>::infinity();
    bool outside = false;
    for (const Triangle& t : triangles_) {
      // Only faces that look at the point can hold the nearest one.
      if (volume_ && (t[1] - t[0]).cross(t[2] - t[0]).dot(p - t[0]) <= 0.0) continue;
      outside = true;
      least = std::min(least, squared_to_triangle(p, t));
    }
    return outside ? std::sqrt(least) : 0.0;
  }

 private:
  Triangles triangles_;
  std::optional<double> volume_;
};

}  // namespace

FitError measure(const Triangles& surface, const std::vector<Placed>& shapes) {
  FitError error;
  std::vector<Solid> solids;
  for (const Placed& placed : shapes) solids.push_back(placed.solid);
  const Hull hull(surface);
  if (hull.volume() && *hull.volume() > 0.0) error.volume_ratio = union_volume(solids, kVolumeSamples) / *hull.volume();
  const Points samples = union_surface(solids, kSurfaceSamples);
  for (const Vector3& p : samples) {
    const double d = hull.distance(p);
    error.mean_overshoot += d / static_cast<double>(samples.size());
    error.most_overshoot = std::max(error.most_overshoot, d);
  }
  for (const Triangle& t : surface) {
    for (const Vector3& p : t) {
      double outside = std::numeric_limits<double>::infinity();
      for (const Solid& solid : solids) outside = std::min(outside, distance(solid, p));
      error.uncovered = std::max(error.uncovered, outside);
    }
  }
  return error;
}

}  // namespace moma::fit
