#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "reports/render/json.h"

namespace moma::reports {

using Point3 = std::array<double, 3>;

/// A triangle mesh; vertices without a triangle are allowed.
struct Surface {
  std::vector<Point3> vertices;               ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< indices into `vertices`
};

/// A visual of a robot: a mesh, or a primitive if `shape` is not null.
struct VisualPart {
  std::string link;
  Point3 position{};                 ///< of the part's frame in the link's [m]
  std::array<double, 9> rotation{};  ///< row by row
  std::optional<Point3> colour;      ///< red, green, blue, each from 0 to 1
  Json shape;                        ///< {"shape", "size"} as robots have it
  Surface surface;                   ///< where `shape` is null
};

/// Returns a robot's visual parts by its resolved form; none if its URDF has none.
using Look = std::function<std::vector<VisualPart>(const Json& robot)>;

/// Largest number of triangles of one robot in the page.
inline constexpr std::size_t kMostTriangles = 20000;

/// Simplifies a mesh by vertex clustering (Rossignac and Borrel, Multi-resolution 3D approximations for rendering
/// complex scenes, 1993): the vertices in each cube of a grid of `cell` metres merge into their mean; degenerate and
/// duplicate triangles are removed. No vertex moves further than the cube's diagonal. Deterministic.
Surface clustered(const Surface& surface, double cell);

/// Returns `[{"link", "position", "rotation", "colour"?, then "shape", "size" or "n", "low", "step", "vertices",
/// "triangles"}]`. All meshes are clustered with the finest cell 0.5 mm * 1.25^k that leaves at most `most` triangles
/// in total. Vertices are quantized as low + step * u; "vertices" holds the 16-bit u, all low bytes before all high
/// bytes, interleaved x y z. "triangles" holds the 16-bit differences of consecutive indices in the same layout. Both
/// are packed().
Json mesh_data(const std::vector<VisualPart>& parts, std::size_t most = kMostTriangles);

}  // namespace moma::reports
