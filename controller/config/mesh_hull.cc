#include "controller/config/mesh_hull.h"

#include <coal/mesh_loader/assimp.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "controller/config/convex_hull.h"
#include "controller/config/text_file.h"
#include "controller/model/xml_check.h"

namespace moma::config {
namespace {

constexpr std::uintmax_t kMaxMeshBytes = 64U << 20U;
constexpr std::size_t kMaxMeshVertices = 2'000'000;

// A face is a line "f 1/1/1 2/2/2 ..."; a backslash at the end of a line continues it.
bool has_large_face(const std::string& obj) {
  int corners = -1;  // of the face at hand; -1: no face
  bool line_start = true;
  bool in_word = false;
  for (std::size_t i = 0; i < obj.size(); ++i) {
    const char c = obj[i];
    if (c == '\\' && i + 1 < obj.size() && (obj[i + 1] == '\n' || obj[i + 1] == '\r')) {
      ++i;
      in_word = false;
    } else if (c == '\n' || c == '\r') {
      line_start = true;
      in_word = false;
      corners = -1;
    } else if (c == ' ' || c == '\t') {
      in_word = false;
    } else {
      // Points and lines (p, l) are faces to the reader too.
      if (line_start) corners = c == 'f' || c == 'p' || c == 'l' ? 0 : -1;
      if (corners >= 0 && !in_word && ++corners > kMaxPolygon + 1) return true;
      line_start = false;
      in_word = true;
    }
  }
  return false;
}

/// Throws unless the file may be given to the library that reads meshes, which chooses its reader by the name's end
/// alone for the kinds that pass. Returns the length of the file's unit [m]: what a .dae says, as RViz and Gazebo take
/// it.
double check_mesh(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw std::runtime_error("it is not a file");
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error) throw std::runtime_error(error.message());
  if (bytes > kMaxMeshBytes)
    throw std::runtime_error("it is larger than " + std::to_string(kMaxMeshBytes >> 20U) + " MiB");
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  if (kind == ".stl") return 1.0;
  if (kind != ".dae" && kind != ".obj") throw std::runtime_error("expected a file that ends in .stl, .dae or .obj");
  const std::string text = read_text_file(file);
  if (kind == ".dae") return collada_unit(text);
  if (has_large_face(text))
    throw std::runtime_error("a face has more than " + std::to_string(kMaxPolygon) + " corners");
  return 1.0;
}

/// Extracts the reason from coal's message, which also has a place in coal's sources and a guess.
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

Mesh read_mesh(const fs::path& file, const Vector3& scale) {
  coal::internal::TriangleAndVertices loaded;  // MeshLoader would make a tree of boxes of them
  try {
    const double unit = check_mesh(file);
    coal::internal::Loader loader;
    loader.load(file.string());
    coal::internal::buildMesh(unit * scale, loader.scene, 0, loaded);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw std::runtime_error("the mesh " + file.string() + " cannot be read: " + reason_in(e.what()));
  }
  Mesh mesh;
  mesh.vertices = std::move(loaded.vertices_);
  if (mesh.vertices.empty()) throw std::runtime_error("the mesh " + file.string() + " has no vertices");
  if (mesh.vertices.size() > kMaxMeshVertices) {
    throw std::runtime_error("the mesh " + file.string() + " has more than " + std::to_string(kMaxMeshVertices) +
                             " vertices");
  }
  for (const Vector3& p : mesh.vertices)
    if (!p.allFinite()) throw std::runtime_error("the mesh " + file.string() + " has vertices that are not finite");
  for (const coal::Triangle& t : loaded.triangles_)
    mesh.triangles.emplace_back(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
  return mesh;
}

MeshSolid point_solid(std::vector<Vector3> cloud) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : cloud) box.extend(p);

  MeshSolid solid;
  solid.X_MS.translation() = box.center();
  for (Vector3& p : cloud) p -= box.center();
  solid.flat = !(box.sizes().minCoeff() > 1e-6) || in_one_plane(cloud);
  if (solid.flat) {
    solid.shape = {ShapeKind::kBox, box.sizes().cwiseMax(1e-3), nullptr};
    return solid;
  }
  std::optional<ConvexHull> hull = convex_hull(cloud);
  if (!hull || static_cast<int>(hull->vertices.size()) > kHullVertices) {
    EnclosingHull around;
    for (const int vertices : {kHullVertices, kMostHullVertices}) {
      around = enclosing_hull(hull ? hull->vertices : cloud, vertices, std::move(around.chosen));
      solid.excess = excess(around.hull, hull ? *hull : around.inside);
      if (solid.excess <= kHullExcess) break;
    }
    hull = std::move(around.hull);
  }
  solid.shape = {ShapeKind::kConvex, Vector3::Zero(), std::make_shared<ConvexHull>(*std::move(hull))};
  return solid;
}

}  // namespace moma::config
