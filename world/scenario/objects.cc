#include "world/scenario/objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

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

constexpr std::array kDrawnKinds{ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCapsule};

}  // namespace

void read_value(const config::Node& node, const std::string& key, SolidKinds& value, const About&) {
  if (node.kind != config::Node::Kind::kSequence || node.items.empty())
    config::fail(node.mark, key, "expected a list of sphere, box, capsule");
  value.kinds.clear();
  for (const config::Node& item : node.items)
    value.kinds.push_back(config::read_word<ShapeKind>(item, key, kDrawnKinds));
}

Json write_value(const SolidKinds& value, const About&) {
  Json list = Json::array();
  for (const ShapeKind kind : value.kinds) list.push_back(to_string(kind));
  return list;
}

std::string accepted(Of<SolidKinds>, const About&) { return "a list of sphere, box, capsule"; }

std::string text_of(const SolidKinds& value) {
  std::string text;
  for (const ShapeKind kind : value.kinds) text += (text.empty() ? "[" : ", ") + std::string(to_string(kind));
  return text + "]";
}

void ObjectMix::sample(Draws& draws, double x, double y, WorldObject& object) const {
  // All quantities are drawn for every shape, so that each has its own place in the stream.
  const ShapeKind kind = shapes.kinds[draws.choice(shapes.kinds.size())];
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

bool ObjectPlacing::place(SceneBuilder& builder, World& world,
                          const std::function<bool(const ObjectTry& at, WorldObject& object)>& draw) const {
  for (int i = 0; i < count; ++i) {
    WorldObject object;
    object.name = name + std::to_string(i + 1);
    bool placed = false;
    for (int k = 0; k < tries && !placed; ++k) {
      placed = draw({k, 1 + static_cast<std::uint64_t>(i * tries + k)}, object);
      if (!placed) builder.drawn_again(drawn_again);
    }
    if (i == 0) builder.first_object(placed, tries);
    if (!placed) return builder.reject(out_of_tries);
    world.objects.push_back(std::move(object));
  }
  return true;
}

Way straight_way(const SceneBuilder& builder, const World& world) {
  Way out;
  out.from = builder.mobile() ? Vector3(world.start.base.x(), world.start.base.y(), 0.0) : builder.start_tip();
  Vector3 way = world.goal.X_WG.translation() - out.from;
  way.z() = 0.0;
  out.length = way.norm();
  if (out.length > 1e-6) out.forward = way / out.length;
  return out;
}

bool SolidsAlong::place(SceneBuilder& builder, World& world) const {
  const Way way = straight_way(builder, world);
  Draws number = builder.draws(Stream::kObjects);
  const ObjectPlacing placing{.count = objects.sample(number),
                              .tries = 100,
                              .name = "object",
                              .drawn_again = "an object not clear of start and goal",
                              .out_of_tries = "objects: no place clear of start and goal (worlds.clearance)"};
  double place = 0.0;
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& object) {
    Draws draws = builder.draws(Stream::kObjects, at.item);
    // The position along the way is kept over the tries; otherwise objects that do not fit near start and goal would
    // crowd in the middle.
    const double again = along.sample(draws);
    if (at.number == 0) place = again;
    const Vector3 p = way.from + place * way.length * way.forward + lateral.sample(draws) * way.left();
    mix.sample(draws, p.x(), p.y(), object);
    return builder.stands_clear(object, builder.clearance());
  });
}

}  // namespace moma
