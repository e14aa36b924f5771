#include "controller/config/mesh_hull.h"

#include <coal/BVH/BVH_model.h>
#include <coal/mesh_loader/loader.h>
#include <coal/shape/convex.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "controller/config/mesh_check.h"

namespace moma::config {
namespace {

using Points = std::vector<coal::Vec3s>;

// Greatest `distance` of a point of `cloud`, and the first point that has it.
template <typename Measure>
std::pair<double, Vector3> furthest(const Points& cloud, const Measure& distance) {
  std::pair<double, Vector3> most(-1.0, cloud.front());
  for (const Vector3& p : cloud) {
    const double d = distance(p);
    if (d > most.first) most = {d, p};
  }
  return most;
}

// Thickness over length below 1e-7. Qhull must not see such points: coal's build of it crashes when it has something to
// complain about, since it is given a number in place of a file to write to.
bool in_one_plane(const Points& cloud) {
  constexpr double kThin = 1e-7;
  const Vector3& a = cloud.front();
  const auto [length, b] = furthest(cloud, [&](const Vector3& p) { return (p - a).norm(); });
  if (!(length > 0.0)) return true;
  const Vector3 along = (b - a) / length;
  const auto [width, c] = furthest(cloud, [&](const Vector3& p) { return (p - a).cross(along).norm(); });
  if (!(width > kThin * length)) return true;
  const Vector3 normal = along.cross(c - a).normalized();
  const double thickness = furthest(cloud, [&](const Vector3& p) { return std::abs(normal.dot(p - a)); }).first;
  return !(thickness > kThin * length);
}

std::shared_ptr<ConvexHull> hull_of(const Points& cloud) {
  if (cloud.size() < 4 || in_one_plane(cloud)) throw std::runtime_error("the points lie in one plane");
  auto points = std::make_shared<Points>(cloud);
  const std::unique_ptr<coal::ConvexBase> base(
      coal::ConvexBase::convexHull(points, static_cast<unsigned>(points->size()), true, "Qt"));
  const auto* convex = dynamic_cast<const coal::Convex<coal::Triangle>*>(base.get());
  if (convex == nullptr) throw std::runtime_error("no triangles");
  auto hull = std::make_shared<ConvexHull>();
  hull->vertices.assign(convex->points->begin(), convex->points->end());
  Vector3 centre = Vector3::Zero();
  for (const Vector3& v : hull->vertices) centre += v / static_cast<double>(hull->vertices.size());
  for (unsigned i = 0; i < convex->num_polygons; ++i) {
    const coal::Triangle& t = (*convex->polygons)[i];
    Eigen::Vector3i triangle(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
    const Vector3& a = hull->vertices[t[0]];
    const Vector3 normal = (hull->vertices[t[1]] - a).cross(hull->vertices[t[2]] - a);
    if (normal.dot(a - centre) < 0.0) std::swap(triangle[1], triangle[2]);
    hull->triangles.push_back(triangle);
  }
  return hull;
}

// The extreme points of `cloud` in `count` directions of a Fibonacci spiral on the sphere.
Points extreme_points(const Points& cloud, int count) {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::set<std::size_t> chosen;
  for (int k = 0; k < count; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / count;
    const double r = std::sqrt(1.0 - z * z);
    const Vector3 direction(r * std::cos(golden * k), r * std::sin(golden * k), z);
    std::size_t best = 0;
    for (std::size_t i = 1; i < cloud.size(); ++i)
      if (cloud[i].dot(direction) > cloud[best].dot(direction)) best = i;
    chosen.insert(best);
  }
  Points points;
  for (const std::size_t i : chosen) points.push_back(cloud[i]);
  return points;
}

// Scales the hull about its centre so that it encloses every point of `cloud`.
void enclose(ConvexHull& hull, const Points& cloud) {
  Vector3 centre = Vector3::Zero();
  for (const Vector3& v : hull.vertices) centre += v / static_cast<double>(hull.vertices.size());
  double factor = 1.0;
  for (const Eigen::Vector3i& t : hull.triangles) {
    const Vector3& a = hull.vertices[static_cast<std::size_t>(t[0])];
    const Vector3 normal =
        (hull.vertices[static_cast<std::size_t>(t[1])] - a).cross(hull.vertices[static_cast<std::size_t>(t[2])] - a);
    const double reach = normal.dot(a - centre);
    if (!(reach > 1e-12 * normal.norm())) continue;  // a sliver
    for (const Vector3& p : cloud) factor = std::max(factor, normal.dot(p - centre) / reach);
  }
  for (Vector3& v : hull.vertices) v = centre + factor * (v - centre);
}

Eigen::AlignedBox3d box_of(const Points& points) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : points) box.extend(p);
  return box;
}

/// Of what coal says of a file, the reason alone: around it are the place in coal's sources and a guess.
std::string reason_in(const std::string& words) {
  constexpr std::string_view kBefore = "Could not load resource ";
  std::size_t begin = words.find(kBefore);
  if (begin == std::string::npos) return words;
  begin = std::min(words.find('\n', begin), words.size() - 1) + 1;
  std::string reason = words.substr(begin, words.find("\nHint", begin) - begin);
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  return reason.empty() ? "its content is not understood" : reason;
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file, const Vector3& scale) {
  const MeshCheck check = check_mesh(file);
  if (!check.fault.empty()) throw std::runtime_error("the mesh " + file.string() + " cannot be read: " + check.fault);
  coal::BVHModelPtr_t loaded;
  try {
    loaded = coal::MeshLoader(coal::BV_AABB).load(file.string(), check.unit * scale);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw std::runtime_error("the mesh " + file.string() + " cannot be read: " + reason_in(e.what()));
  }
  if (!loaded || !loaded->vertices || loaded->num_vertices == 0)
    throw std::runtime_error("the mesh " + file.string() + " has no vertices");
  if (loaded->num_vertices > kMaxMeshVertices) {
    throw std::runtime_error("the mesh " + file.string() + " has more than " + std::to_string(kMaxMeshVertices) +
                             " vertices");
  }
  Mesh mesh;
  mesh.vertices.assign(loaded->vertices->begin(), loaded->vertices->begin() + loaded->num_vertices);
  for (const Vector3& p : mesh.vertices)
    if (!p.allFinite()) throw std::runtime_error("the mesh " + file.string() + " has vertices that are not finite");
  for (unsigned i = 0; loaded->tri_indices && i < loaded->num_tris; ++i) {
    const coal::Triangle& t = (*loaded->tri_indices)[i];
    mesh.triangles.emplace_back(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
  }
  return mesh;
}

ConvexHull convex_hull(const std::vector<Vector3>& points) { return *hull_of(Points(points.begin(), points.end())); }

MeshSolid mesh_solid(const std::filesystem::path& file, const Vector3& scale) {
  const Mesh mesh = read_mesh(file, scale);
  Points cloud(mesh.vertices.begin(), mesh.vertices.end());

  MeshSolid solid;
  const Eigen::AlignedBox3d box = box_of(cloud);
  solid.X_MS.translation() = box.center();
  if (box.sizes().minCoeff() > 1e-6) {
    for (coal::Vec3s& p : cloud) p -= box.center();
    try {
      std::shared_ptr<ConvexHull> hull = hull_of(cloud);
      if (static_cast<int>(hull->vertices.size()) > kMaxHullVertices) {
        const Points outer(hull->vertices.begin(), hull->vertices.end());
        hull = hull_of(extreme_points(outer, kMaxHullVertices));
        enclose(*hull, outer);
      }
      solid.shape = {ShapeKind::kConvex, Vector3::Zero(), hull};
      return solid;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception&) {
      // In one plane: the box below stands for them.
    }
  }
  solid.flat = true;
  solid.shape = {ShapeKind::kBox, box.sizes().cwiseMax(1e-3), nullptr};
  return solid;
}

}  // namespace moma::config
