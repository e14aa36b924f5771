#include "controller/draft/urdf_facts.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "controller/config/mesh_hull.h"

namespace moma::draft {

namespace {

// Adds the folder of a mesh's package to `urdf.packages` if a robot file could not find it by itself.
void find_package(UrdfFacts& urdf, const std::string& uri) {
  constexpr std::string_view kPackage = "package://";
  const std::size_t slash = uri.find('/', kPackage.size());
  if (uri.rfind(kPackage, 0) != 0 || slash == std::string::npos) return;
  const std::string name = uri.substr(kPackage.size(), slash - kPackage.size());
  const fs::path inside = uri.substr(slash + 1);
  if (urdf.packages.named.count(name) != 0) return;
  const fs::path& directory = urdf.packages.directory;
  std::error_code error;
  fs::path folder;
  try {
    folder = fs::absolute(config::PackagePaths{{}, directory}.resolve(uri)).lexically_normal();
    for (auto part = inside.begin(); part != inside.end(); ++part) folder = folder.parent_path();
    const fs::path from = directory.lexically_relative(folder.parent_path());
    if (!from.empty() && *from.begin() != "..") return;  // beside or above the URDF
  } catch (const std::runtime_error&) {
    for (folder = directory; !fs::is_regular_file(folder / inside, error); folder = folder.parent_path())
      if (folder == folder.parent_path()) return;
    urdf.renamed.push_back(name);
  }
  urdf.packages.named[name] = folder;
}

}  // namespace

UrdfFacts facts_of(const std::string& text, UrdfReading reading, const fs::path& directory) {
  UrdfFacts facts;
  facts.tree = read_urdf(text, reading);
  facts.visuals = read_urdf_visuals(text);
  facts.packages.directory = fs::absolute(directory.empty() ? "." : directory).lexically_normal();
  facts.children.resize(facts.tree.links.size());
  facts.X_RL.assign(facts.tree.links.size(), Isometry::Identity());
  for (int i = 1; i < facts.size(); ++i) {
    const int parent = facts.link(i).parent;
    facts.children[static_cast<std::size_t>(parent)].push_back(i);
    facts.X_RL[static_cast<std::size_t>(i)] = facts.X_R(parent) * facts.link(i).joint.X_PJ;
  }
  for (const UrdfLink& link : facts.tree.links)
    for (const UrdfGeometry& shape : link.collision) find_package(facts, shape.mesh);
  for (const UrdfVisual& visual : facts.visuals) find_package(facts, visual.geometry.mesh);
  return facts;
}

std::vector<Vector3> outline(const UrdfFacts& urdf, const UrdfGeometry& shape) {
  std::vector<Vector3> points;
  const Vector3& size = shape.shape.size;
  if (!shape.mesh.empty()) {
    try {
      points = config::read_mesh(urdf.packages.resolve(shape.mesh), shape.scale).vertices;
    } catch (const std::runtime_error&) {
      return {};
    }
  } else if (shape.shape.kind == ShapeKind::kBox) {
    for (int corner = 0; corner < 8; ++corner)
      points.push_back(0.5 * Vector3((corner & 1) != 0 ? size.x() : -size.x(), (corner & 2) != 0 ? size.y() : -size.y(),
                                     (corner & 4) != 0 ? size.z() : -size.z()));
  } else {
    constexpr int kRing = 72;
    for (int i = 0; i < kRing; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kRing;
      const double x = size.x() * std::cos(angle), y = size.x() * std::sin(angle);
      if (shape.shape.kind == ShapeKind::kSphere)
        points.insert(points.end(), {{x, y, 0.0}, {0.0, x, y}, {y, 0.0, x}});
      else
        points.insert(points.end(), {{x, y, -0.5 * size.y()}, {x, y, 0.5 * size.y()}});
    }
  }
  for (Vector3& point : points) point = shape.X_LS * point;
  return points;
}

bool drivable(const UrdfJoint& joint) {
  return !joint.mimic && (joint.type == UrdfJointType::kRevolute || joint.type == UrdfJointType::kContinuous ||
                          joint.type == UrdfJointType::kPrismatic);
}

bool named(std::string_view name, std::initializer_list<std::string_view> words) {
  std::string small(name);
  std::transform(small.begin(), small.end(), small.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return small.find(word) != std::string::npos; });
}

}  // namespace moma::draft
