#include "eval/cli/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace moma::cli {
namespace {

/// One shell word.
std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_-./=,:@%+").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string command_line(const std::vector<std::string>& arguments) {
  std::string line;
  for (const std::string& word : arguments) {
    if (!line.empty()) line += ' ';
    line += shell_word(word);
  }
  return line;
}

std::string shape_text(const Shape& shape) {
  const Vector3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return fmt::format("sphere, radius {:.4g}", s.x());
    case ShapeKind::kBox:
      return fmt::format("box {:.4g} x {:.4g} x {:.4g}", s.x(), s.y(), s.z());
    case ShapeKind::kCylinder:
      return fmt::format("cylinder, radius {:.4g}, length {:.4g}", s.x(), s.y());
    case ShapeKind::kCapsule:
      return fmt::format("capsule, radius {:.4g}, length {:.4g}", s.x(), s.y());
    case ShapeKind::kConvex:
      return fmt::format("convex hull of {} points", shape.hull == nullptr ? 0 : shape.hull->vertices.size());
  }
  return "";
}

std::string vector_text(const Eigen::Ref<const VectorX>& v) {
  std::string text = "(";
  for (Eigen::Index i = 0; i < v.size(); ++i) text += fmt::format("{}{:.4f}", i > 0 ? ", " : "", v[i]);
  return text + ")";
}

}  // namespace moma::cli
