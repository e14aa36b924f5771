#include "world/scenario/object_mix.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moma {
namespace {

/// Uniform over all orientations. Source: Shoemake, Graphics Gems III, 1992.
Eigen::Quaterniond random_rotation(Draws& draws) {
  const double u = draws.uniform();
  const double a = 2.0 * std::numbers::pi * draws.uniform();
  const double b = 2.0 * std::numbers::pi * draws.uniform();
  const double s = std::sqrt(1.0 - u);
  const double c = std::sqrt(u);
  return {c * std::cos(b), s * std::sin(a), s * std::cos(a), c * std::sin(b)};
}

}  // namespace

void ObjectMix::read(config::MapReader& in) {
  const auto positive = config::Range::positive();
  if (const config::Node* node = in.get("shapes")) {
    const std::string key = in.key_of("shapes");
    shapes.clear();
    if (node->kind != config::Node::Kind::kSequence || node->items.empty())
      config::fail(node->mark, key, "expected a list of sphere, box, capsule");
    for (const config::Node& item : node->items) {
      const std::string name = config::read_string(item, key);
      bool known = false;
      for (const ShapeKind kind : {ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCapsule}) {
        if (name != to_string(kind)) continue;
        shapes.push_back(kind);
        known = true;
      }
      if (!known) config::fail(item.mark, key, "found '" + name + "', expected one of: sphere, box, capsule");
    }
  }
  in.read("standing", standing, {0.0, 1.0});
  moma::read(in, "sphere_radius", sphere_radius, positive);
  moma::read(in, "box_edge", box_edge, positive);
  moma::read(in, "capsule_radius", capsule_radius, positive);
  moma::read(in, "capsule_length", capsule_length, positive);
  moma::read(in, "standing_height", standing_height, positive);
  moma::read(in, "height", height);
}

void ObjectMix::write(nlohmann::ordered_json& out) const {
  out["shapes"] = nlohmann::ordered_json::array();
  for (const ShapeKind kind : shapes) out["shapes"].push_back(to_string(kind));
  out["standing"] = standing;
  out["sphere_radius"] = sphere_radius.to_json();
  out["box_edge"] = box_edge.to_json();
  out["capsule_radius"] = capsule_radius.to_json();
  out["capsule_length"] = capsule_length.to_json();
  out["standing_height"] = standing_height.to_json();
  out["height"] = height.to_json();
}

void ObjectMix::sample(Draws& draws, double x, double y, WorldObject& object) const {
  // Everything is drawn whatever the shape, so that each quantity has its own place in the stream.
  const ShapeKind kind = shapes[draws.choice(shapes.size())];
  const bool stands = draws.uniform() < standing && kind != ShapeKind::kSphere;
  const double total_height = standing_height.sample(draws);
  const double center_height = height.sample(draws);
  const double yaw = draws.uniform(-std::numbers::pi, std::numbers::pi);
  const Eigen::Quaterniond tumbled = random_rotation(draws);
  const double radius = kind == ShapeKind::kSphere ? sphere_radius.sample(draws) : capsule_radius.sample(draws);
  Vector3 edges;
  for (int i = 0; i < 3; ++i) edges[i] = box_edge.sample(draws);
  const double length = capsule_length.sample(draws);

  object.shape.kind = kind;
  if (kind == ShapeKind::kSphere) object.shape.size = {radius, 0.0, 0.0};
  if (kind == ShapeKind::kBox) object.shape.size = {edges.x(), edges.y(), stands ? total_height : edges.z()};
  if (kind == ShapeKind::kCapsule)
    object.shape.size = {radius, stands ? std::max(total_height - 2.0 * radius, 1e-3) : length, 0.0};
  object.motion = StaticMotion{};

  const Eigen::Quaterniond upright(std::cos(0.5 * yaw), 0.0, 0.0, std::sin(0.5 * yaw));
  set_pose(object, {x, y, center_height}, stands ? upright : tumbled);
  const double lowest = lowest_point(object.shape, object.X_WO);
  const double shift = stands ? -lowest : std::max(0.0, -lowest);
  set_pose(object, {x, y, center_height + shift}, object.file_rotation);
}

}  // namespace moma
