#pragma once

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace moma::reports {

using Point3 = std::array<double, 3>;

/// A surface; what no triangle uses may be among its vertices.
struct Surface {
  std::vector<Point3> vertices;               ///< [m]
  std::vector<std::array<int, 3>> triangles;  ///< indices into `vertices`
};

/// A part of what a robot looks like: a mesh, or a primitive where `shape` is not null.
struct VisualPart {
  std::string link;
  Point3 position{};                 ///< of the part's frame in the link's [m]
  std::array<double, 9> rotation{};  ///< row by row
  std::optional<Point3> colour;      ///< red, green, blue, each from 0 to 1
  nlohmann::ordered_json shape;      ///< {"shape", "size"} as robots have it
  Surface surface;                   ///< where `shape` is null
};

/// Returns a robot's visual parts by its resolved form; none if its URDF has none.
using Look = std::function<std::vector<VisualPart>(const nlohmann::ordered_json& robot)>;

/// Triangles of one robot in the page, at most.
inline constexpr std::size_t kMostTriangles = 20000;

/// Vertex clustering (Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex scenes, 1993):
/// all vertices in one cube of a grid of `cell` metres become their mean; triangles that lose a corner, and doubles,
/// go. No point moves by more than the cube's diagonal. Same input, same output.
Surface clustered(const Surface& surface, double cell);

/// `[{"link", "position", "rotation", "colour"?, then "shape", "size" or "n", "low", "step", "vertices",
/// "triangles"}]`. All meshes are clustered with the finest of the cells 0.5 mm * 1.25^k at which they have `most`
/// triangles together. Vertices are low + step * u with u of 16 bits; "vertices" are those, first all low bytes, then
/// all high bytes, x y z by turns; "triangles" the differences of their indices, one after the other, of 16 bits in the
/// same way; both as packed().
nlohmann::ordered_json mesh_data(const std::vector<VisualPart>& parts, std::size_t most = kMostTriangles);

}  // namespace moma::reports
