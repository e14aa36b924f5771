#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/paths.h"
#include "controller/model/shape.h"

namespace moma::config {

/// Number of vertices of a mesh's hull, with which the cost of a distance grows; and the larger number for hulls that
/// would reach further out of the exact one than kHullExcess [m].
inline constexpr int kHullVertices = 96, kMostHullVertices = 192;
inline constexpr double kHullExcess = 2.5e-3;

/// A solid made from a mesh, and where it stands in the mesh's frame M.
struct MeshSolid {
  Shape shape;
  Isometry X_MS = Isometry::Identity();
  double excess = 0.0;  ///< how far `shape` reaches out of the hull of all vertices [m]
  bool flat = false;    ///< the mesh has no volume: `shape` is its bounding box, at least 1 mm thick
};

/// Solids of mesh files by file and scale, kept by whoever reads the same robot several times.
using MeshSolids = std::map<std::pair<std::string, std::array<double, 3>>, MeshSolid>;

/// A surface as its file has it, in the mesh's frame M [m]; it need not be closed, and orientation means nothing.
struct Mesh {
  std::vector<Vector3> vertices;
  std::vector<Eigen::Vector3i> triangles;  ///< indices into `vertices`
};

/// Reads a mesh file (.stl, .dae, .obj), scaled; a .dae is in the unit that it names. The result has at least one
/// vertex, finite ones only, and possibly no triangles. Throws std::runtime_error: not a plain file of those kinds,
/// larger than 64 MiB, refused by a guard (docs/adr/0011), unreadable, empty, not finite.
Mesh read_mesh(const fs::path& file, const Vector3& scale);

/// Convex hull of points (one or more, finite), in a frame at the centre of their bounding box. A hull of more than
/// kHullVertices is replaced by an enclosing_hull() of so many, or of kMostHullVertices where it would reach further
/// out than kHullExcess.
MeshSolid point_solid(std::vector<Vector3> cloud);

}  // namespace moma::config
