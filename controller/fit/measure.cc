#include "controller/fit/measure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <vector>

#include "controller/config/convex_hull.h"

namespace moma::fit {
namespace {

constexpr int kSurfaceSamples = 2000;
constexpr int kVolumeSamples = 32768;

// A convex body by its triangles, or a flat one by the triangles of the surface itself.
class Hull {
 public:
  explicit Hull(const Triangles& surface) : surface_(surface) {
    try {
      hull_ = config::convex_hull(corners(surface));
      const Vector3& centre = hull_->vertices.front();
      double volume = 0.0;
      for (const Eigen::Vector3i& t : hull_->triangles) {
        const auto at = [&](int i) { return hull_->vertices[static_cast<std::size_t>(t[i])] - centre; };
        volume += at(0).dot(at(1).cross(at(2))) / 6.0;
      }
      volume_ = volume;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception&) {
    }
  }

  std::optional<double> volume() const { return volume_; }

  /// Distance to the hull; 0 inside.
  double distance(const Vector3& p) const {
    if (hull_) return config::distance_outside(*hull_, p);
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : surface_) least = std::min(least, config::distance_to_triangle(t, p));
    return least;
  }

 private:
  const Triangles& surface_;
  std::optional<ConvexHull> hull_;
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
