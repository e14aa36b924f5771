#pragma once

#include <filesystem>
#include <vector>

#include "controller/model/shape.h"

namespace moma::config {

/// Most vertices of a hull made from a mesh. A query climbs along the hull's edges, so its cost grows with them.
inline constexpr int kMaxHullVertices = 96;

/// A solid made from a mesh, and where it stands in the mesh's frame M.
struct MeshSolid {
  Shape shape;
  Isometry X_MS = Isometry::Identity();
  bool flat = false;  ///< the mesh has no volume: `shape` is its bounding box, at least 1 mm thick
};

/// A surface as its file has it, in the mesh's frame M [m]; it need not be closed, and orientation means nothing.
struct Mesh {
  std::vector<Vector3> vertices;
  std::vector<Eigen::Vector3i> triangles;  ///< indices into `vertices`
};

/// Reads a mesh file (.stl, .dae, .obj; nothing else is tried), scaled; a .dae is in the unit that it names. At least
/// one vertex, all of them finite; there may be no triangles. Throws std::runtime_error: not a plain file of those
/// kinds, larger or with more in it than controller/config/mesh_check.h accepts, unreadable, empty, not finite.
Mesh read_mesh(const std::filesystem::path& file, const Vector3& scale);

/// Convex hull (Qhull, through coal), exact to rounding; its vertices are some of `points`. Throws std::runtime_error
/// where the points lie in one plane.
ConvexHull convex_hull(const std::vector<Vector3>& points);

/// Convex hull of all vertices of a mesh file.
/// The hull's frame is at the centre of its bounding box. A hull of more than kMaxHullVertices is replaced by the
/// hull of its extreme points in as many evenly spread directions, blown up about its centre until it encloses the
/// whole mesh again (typically by 1 or 2 %). Throws std::runtime_error: unreadable, empty, not finite.
MeshSolid mesh_solid(const std::filesystem::path& file, const Vector3& scale);

}  // namespace moma::config
