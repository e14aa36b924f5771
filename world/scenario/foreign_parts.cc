#include "world/scenario/foreign_parts.h"

#include <fmt/format.h>

#include "controller/config/reader.h"

namespace moma::foreign {

using config::Node;

const Node& need(const Node& map, const std::string& name, const std::string& what) {
  const Node* node = map.find(name);
  if (node == nullptr || node->kind == Node::Kind::kNull) config::fail(map.mark, name, "missing; expected " + what);
  return *node;
}

const std::vector<Node>& list_of(const Node& map, const std::string& name) {
  static const std::vector<Node> kNone;
  const Node* node = map.find(name);
  if (node == nullptr || node->kind == Node::Kind::kNull) return kNone;
  if (node->kind != Node::Kind::kSequence) config::fail(node->mark, name, "expected a list");
  return node->items;
}

VectorX read_letters(const Node& node, const std::string& key, std::string_view letters) {
  VectorX v(static_cast<Eigen::Index>(letters.size()));
  if (node.kind == Node::Kind::kMap) {
    for (std::size_t i = 0; i < letters.size(); ++i) {
      const std::string letter(1, letters[i]);
      v[static_cast<Eigen::Index>(i)] = config::read_number(need(node, letter, "a number"), key + "." + letter);
    }
    return v;
  }
  const std::vector<double> list = config::read_numbers(node, key, static_cast<int>(letters.size()));
  return Eigen::Map<const VectorX>(list.data(), v.size());
}

Isometry read_pose(const Node& node, const std::string& key) {
  const Node* orientation = node.find(key);
  Eigen::Vector4d xyzw(0.0, 0.0, 0.0, 1.0);
  if (orientation != nullptr) xyzw = read_letters(*orientation, key, "xyzw");
  if (!(xyzw.norm() > 1e-6)) config::fail(node.mark, key, "expected a quaternion x, y, z, w that is not zero");
  const Eigen::Quaterniond rotation(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  return pose_of(rotation.normalized().toRotationMatrix(),
                 read_letters(need(node, "position", "x, y, z"), "position", "xyz"));
}

void add(Scene& scene, const std::string& name, const Isometry& X_WO, const std::vector<Part>& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    WorldObject object;
    object.name = parts.size() == 1 ? name : fmt::format("{}/{}", name, i + 1);
    object.shape = parts[i].shape;
    set_pose(object, X_WO * parts[i].X);
    scene.objects.push_back(std::move(object));
  }
}

}  // namespace moma::foreign
