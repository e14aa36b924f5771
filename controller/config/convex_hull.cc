#include "controller/config/convex_hull.h"

#include <coal/shape/convex.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

namespace moma::config {
namespace {

using Vertices = std::vector<Vector3>;

/// Greatest `measure` of a point of the cloud, and the first point that has it.
template <typename Measure>
std::pair<double, std::size_t> furthest(const Vertices& cloud, const Measure& measure) {
  std::pair<double, std::size_t> most(-1.0, 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double d = measure(cloud[i]);
    if (d > most.first) most = {d, i};
  }
  return most;
}

/// Four points of the cloud that span a tetrahedron; none where thickness over length is below 1e-7. Qhull must not see
/// such clouds: coal's build of it crashes when it has something to complain about, since it is given a number in place
/// of a file to write to.
std::optional<std::array<std::size_t, 4>> tetrahedron(const Vertices& cloud) {
  constexpr double kThin = 1e-7;
  if (cloud.size() < 4) return std::nullopt;
  const Vector3& a = cloud.front();
  const auto [length, b] = furthest(cloud, [&](const Vector3& p) { return (p - a).norm(); });
  if (!(length > 0.0)) return std::nullopt;
  const Vector3 along = (cloud[b] - a) / length;
  const auto [width, c] = furthest(cloud, [&](const Vector3& p) { return (p - a).cross(along).norm(); });
  if (!(width > kThin * length)) return std::nullopt;
  const Vector3 normal = along.cross(cloud[c] - a).normalized();
  const auto [thickness, d] = furthest(cloud, [&](const Vector3& p) { return std::abs(normal.dot(p - a)); });
  if (!(thickness > kThin * length)) return std::nullopt;
  return std::array<std::size_t, 4>{0, b, c, d};
}

Vector3 mean(const Vertices& points) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& p : points) sum += p / static_cast<double>(points.size());
  return sum;
}

/// Length of the diagonal of the points' box [m].
double length_of(const Vertices& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3& v : points) box.extend(v);
  return box.diagonal().norm();
}

/// Outward normal of length 1; zero for a sliver, lower than a millionth of the hull's length, whose normal is rounding
/// alone. Its neighbours stand for it.
Vector3 face_normal(const Triangle3& t, double length) {
  const Vector3 area = (t[1] - t[0]).cross(t[2] - t[0]);
  const double edge = std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
  if (!(area.norm() > 1e-6 * length * edge)) return Vector3::Zero();
  return area.normalized();
}

/// A face's plane n . x = offset, n of length 1 and outwards; and the point of a cloud furthest beyond it.
struct Plane {
  Vector3 normal;
  double offset;
  std::size_t furthest = 0;
  double beyond = 0.0;  ///< of that point [m]
};

Plane plane_of(const Triangle3& at, const Vertices& cloud, double length) {
  Plane plane{face_normal(at, length), 0.0};
  const Vector3& n = plane.normal;
  plane.offset = std::max({n.dot(at[0]), n.dot(at[1]), n.dot(at[2])});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double beyond = n.dot(cloud[i]) - plane.offset;
    if (beyond > plane.beyond) plane.furthest = i, plane.beyond = beyond;
  }
  return plane;
}

/// Planes of the faces of hulls of some of a cloud's points. A plane asks every point, so those of faces that the hull
/// before had as well are kept.
class Planes {
 public:
  explicit Planes(const Vertices& cloud) : cloud_(cloud), length_(length_of(cloud)) {}

  std::vector<Plane> of(const ConvexHull& hull) {
    std::vector<Plane> planes;
    std::map<std::array<double, 9>, Plane> known;
    for (const Eigen::Vector3i& t : hull.triangles) {
      const Triangle3 at = corners(hull.vertices, t);
      std::array<double, 9> key;
      for (std::size_t i = 0; i < 3; ++i) Eigen::Map<Vector3>{&key[3 * i]} = at[i];
      const auto before = known_.find(key);
      planes.push_back(before != known_.end() ? before->second : plane_of(at, cloud_, length_));
      known.emplace(key, planes.back());
    }
    known_ = std::move(known);
    return planes;
  }

  double length() const { return length_; }

 private:
  const Vertices& cloud_;
  double length_;
  std::map<std::array<double, 9>, Plane> known_;
};

/// Shortest d with n_f . d >= beyond_f for all faces f of a vertex: Hildreth's dual coordinate ascent.
Vector3 shortest_way_beyond(const std::vector<Plane>& faces) {
  constexpr int kRounds = 200;
  Vector3 d = Vector3::Zero();
  std::vector<double> multipliers(faces.size(), 0.0);
  for (int round = 0; round < kRounds; ++round) {
    double change = 0.0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const double step = std::max(-multipliers[f], faces[f].beyond - faces[f].normal.dot(d));
      multipliers[f] += step;
      d += step * faces[f].normal;
      change = std::max(change, std::abs(step));
    }
    if (!(change > 1e-12)) break;
  }
  return d;
}

/// Scales the hull about the mean of its vertices so that it encloses every point of `cloud`, in spite of rounding.
void enclose(ConvexHull& hull, const Vertices& cloud) {
  const Vector3 centre = mean(hull.vertices);
  double factor = 1.0;
  for (const Plane& plane : Planes(cloud).of(hull)) {
    const double reach = plane.offset - plane.normal.dot(centre);
    if (plane.beyond > 0.0 && reach > 0.0) factor = std::max(factor, 1.0 + plane.beyond / reach);
  }
  for (Vector3& v : hull.vertices) v = centre + factor * (v - centre);
}

double squared_to_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 ab = b - a;
  const double length = ab.squaredNorm();
  const double t = length > 0.0 ? std::clamp(ab.dot(p - a) / length, 0.0, 1.0) : 0.0;
  return (p - a - t * ab).squaredNorm();
}

}  // namespace

Triangle3 corners(const std::vector<Vector3>& vertices, const Eigen::Vector3i& triangle) {
  const auto at = [&](int i) { return vertices[static_cast<std::size_t>(triangle[i])]; };
  return {at(0), at(1), at(2)};
}

bool in_one_plane(const std::vector<Vector3>& points) { return !tetrahedron(points); }

std::optional<ConvexHull> convex_hull(const std::vector<Vector3>& points) {
  if (in_one_plane(points)) return std::nullopt;
  auto cloud = std::make_shared<std::vector<coal::Vec3s>>(points.begin(), points.end());
  std::unique_ptr<coal::ConvexBase> base;
  try {
    base.reset(coal::ConvexBase::convexHull(cloud, static_cast<unsigned>(cloud->size()), true, "Qt"));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return std::nullopt;
  }
  const auto* convex = dynamic_cast<const coal::Convex<coal::Triangle>*>(base.get());
  if (convex == nullptr) return std::nullopt;
  ConvexHull hull;
  hull.vertices.assign(convex->points->begin(), convex->points->end());
  const Vector3 centre = mean(hull.vertices);
  for (unsigned i = 0; i < convex->num_polygons; ++i) {
    const coal::Triangle& t = (*convex->polygons)[i];
    Eigen::Vector3i triangle(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
    const Vector3& a = hull.vertices[t[0]];
    const Vector3 normal = (hull.vertices[t[1]] - a).cross(hull.vertices[t[2]] - a);
    if (normal.dot(a - centre) < 0.0) std::swap(triangle[1], triangle[2]);
    hull.triangles.push_back(triangle);
  }
  return hull;
}

bool is_hull(const ConvexHull& hull) {
  if (in_one_plane(hull.vertices)) return false;
  const double length = length_of(hull.vertices);
  std::map<std::pair<int, int>, int> edges;
  std::map<int, int> faces;  // of each vertex
  for (const Eigen::Vector3i& t : hull.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}], ++faces[t[i]];
    const Triangle3 at = corners(hull.vertices, t);
    const Vector3 normal = face_normal(at, length);
    for (const Vector3& v : hull.vertices)
      if (normal.dot(v - at[0]) > 1e-6 * length) return false;
  }
  return faces.size() == hull.vertices.size() &&
         std::all_of(faces.begin(), faces.end(), [](const auto& vertex) { return vertex.second <= 255; }) &&
         std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
           const auto& [from, to] = edge.first;
           return edge.second == 1 && from != to && edges.count({to, from}) == 1;
         });
}

EnclosingHull enclosing_hull(const std::vector<Vector3>& cloud, int most_vertices, std::vector<Vector3> chosen) {
  const auto hull_of = [](const Vertices& points) {
    std::optional<ConvexHull> hull = convex_hull(points);
    if (!hull) throw std::runtime_error("the points have no convex hull with at most 255 faces at each vertex");
    return *std::move(hull);
  };
  if (chosen.empty()) {
    const auto corner = tetrahedron(cloud);
    if (!corner) throw std::runtime_error("the points lie in one plane");
    for (const std::size_t i : *corner) chosen.push_back(cloud[i]);
  }
  EnclosingHull result;
  ConvexHull& inside = result.inside;
  Planes faces_of(cloud);
  std::vector<Plane> planes;
  while (true) {
    inside = hull_of(chosen);
    planes = faces_of.of(inside);
    const auto worst = std::max_element(planes.begin(), planes.end(),
                                        [](const Plane& a, const Plane& b) { return a.beyond < b.beyond; });
    if (chosen.size() >= static_cast<std::size_t>(most_vertices) || !(worst->beyond > 1e-9 * faces_of.length())) break;
    chosen.push_back(cloud[worst->furthest]);
  }
  std::vector<std::vector<Plane>> faces(inside.vertices.size());
  for (std::size_t f = 0; f < planes.size(); ++f)
    for (const int vertex : inside.triangles[f]) faces[static_cast<std::size_t>(vertex)].push_back(planes[f]);
  Vertices moved = inside.vertices;
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += shortest_way_beyond(faces[i]);
  result.hull = hull_of(moved);
  enclose(result.hull, cloud);
  result.chosen = std::move(chosen);
  return result;
}

double distance_to_triangle(const Triangle3& t, const Vector3& p) noexcept {
  const Vector3 area = (t[1] - t[0]).cross(t[2] - t[0]);
  bool over = area.squaredNorm() > 0.0;
  for (std::size_t i = 0; over && i < 3; ++i) over = area.dot((t[(i + 1) % 3] - t[i]).cross(p - t[i])) >= 0.0;
  if (over) return std::abs(area.dot(p - t[0])) / area.norm();
  return std::sqrt(std::min(
      {squared_to_segment(p, t[0], t[1]), squared_to_segment(p, t[1], t[2]), squared_to_segment(p, t[2], t[0])}));
}

DistanceOutside::DistanceOutside(const ConvexHull& hull) : hull_(hull) {
  const double length = length_of(hull.vertices);
  rounding_ = 1e-9 * length;
  for (const Eigen::Vector3i& t : hull.triangles) normals_.push_back(face_normal(corners(hull.vertices, t), length));
}

double DistanceOutside::of(const Vector3& p) const noexcept {
  double least = std::numeric_limits<double>::infinity();
  bool outside = false;
  for (std::size_t i = 0; i < normals_.size(); ++i) {
    const Triangle3 at = corners(hull_.vertices, hull_.triangles[i]);
    const double height = normals_[i].dot(p - at[0]);
    if (normals_[i].isZero() || height < -rounding_) continue;  // only faces that look at p can hold the nearest point
    outside |= height > rounding_;
    least = std::min(least, distance_to_triangle(at, p));
  }
  return outside ? least : 0.0;
}

double excess(const ConvexHull& outer, const ConvexHull& inner) {
  const DistanceOutside distance(inner);
  double most = 0.0;
  for (const Vector3& v : outer.vertices) most = std::max(most, distance.of(v));
  return most;
}

}  // namespace moma::config
