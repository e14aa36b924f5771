#include "controller/config/mesh_check.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <utility>

#include "controller/config/text_file.h"
#include "controller/model/collada_check.h"
#include "controller/model/collada_geometry.h"

namespace moma::config {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

MeshCheck check_mesh(const fs::path& file) {
  const auto fault = [](std::string what) { return MeshCheck{std::move(what), 1.0}; };
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return fault("it is not a file");
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error) return fault(error.message());
  if (bytes > kMaxMeshBytes) return fault("it is larger than " + std::to_string(kMaxMeshBytes >> 20U) + " MiB");
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  if (kind == ".stl") return {};
  if (kind != ".dae" && kind != ".obj") return fault("expected a file that ends in .stl, .dae or .obj");
  std::string text;
  try {
    text = read_text_file(file);
  } catch (const std::runtime_error& e) {
    return fault(e.what());
  }
  if (kind == ".dae") {
    ColladaCheck collada = check_collada(text);
    return {std::move(collada.fault), collada.unit};
  }
  return fault(has_large_face(text) ? "a face has more than " + std::to_string(kMaxPolygon) + " corners" : "");
}

}  // namespace moma::config
