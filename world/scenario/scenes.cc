#include "world/scenario/scenes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "controller/config/reader.h"
#include "world/scenario/scene_builder.h"
#include "world/scenario/worlds.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;

std::vector<std::string> read_joints(const Node& node, const std::string& key) {
  if (node.kind != Node::Kind::kSequence || node.items.empty())
    config::fail(node.mark, key, "expected a list of joints, in the order of the configurations' numbers");
  std::vector<std::string> joints;
  for (const Node& item : node.items) {
    joints.push_back(config::read_string(item, key));
    if (std::ranges::count(joints, joints.back()) > 1)
      config::fail(item.mark, key, "'" + joints.back() + "' is named twice");
  }
  return joints;
}

Vector3 three(const Node& node, const std::string& key, const Range& range = {}) {
  const std::vector<double> v = config::read_numbers(node, key, 3, range);
  return {v[0], v[1], v[2]};
}

WorldObject read_box(const std::string& name, const Node& node, const std::string& key) {
  MapReader in(node, key);
  WorldObject box;
  box.name = name;
  box.shape.kind = ShapeKind::kBox;
  box.shape.size = three(in.require("size", "three edge lengths [m]"), in.key_of("size"), Range::positive());
  set_pose(box, three(in.require("center", "[x, y, z]"), in.key_of("center")), Eigen::Quaterniond::Identity());
  in.finish();
  return box;
}

Scenes::Scene read_scene(const std::string& name, const Node& node, const std::string& key, int joints) {
  MapReader in(node, key);
  Scenes::Scene scene;
  scene.name = name;
  scene.base = three(in.require("base", "[x, y, phi] of the robot's base"), in.key_of("base"));
  const Node& boxes = in.require("boxes", "a map {NAME: {size, center}}");
  if (boxes.kind != Node::Kind::kMap)
    config::fail(boxes.mark, in.key_of("boxes"), "expected a map {NAME: {size, center}}");
  for (const auto& [box, at] : boxes.entries) scene.boxes.push_back(read_box(box, at, in.key_of("boxes") + "." + box));
  constexpr const char* kList = "a list of two or more lists of joint values";
  const Node& list = in.require("configurations", kList);
  config::for_items(list, in.key_of("configurations"), kList, [&](const Node& item, const std::string& at) {
    const std::vector<double> q = config::read_numbers(item, at, joints);
    scene.configurations.emplace_back(Eigen::Map<const VectorX>(q.data(), joints));
  });
  in.check(scene.configurations.size() >= 2, "configurations", std::string("expected ") + kList);
  in.finish();
  return scene;
}

Json list_of(const Eigen::Ref<const VectorX>& v) { return Json(std::vector<double>(v.data(), v.data() + v.size())); }

Json boxes_json(const Scenes::Scene& scene) {
  Json boxes = Json::object();
  for (const WorldObject& box : scene.boxes)
    boxes[box.name] = {{"size", list_of(box.shape.size)}, {"center", list_of(box.X_WO.translation())}};
  return boxes;
}

std::uint64_t pairs_of(const Scenes::Scene& scene) {
  const std::uint64_t n = scene.configurations.size();
  return n * (n - 1) / 2;
}

}  // namespace

Scenes Scenes::read(const Node& node, const std::string& key) {
  if (node.kind == Node::Kind::kScalar) {
    const Node file = config::load_yaml(config::directory_of(node.mark) / config::read_string(node, key));
    return read(file, key);
  }
  MapReader in(node, key);
  Scenes out;
  out.joints_ = read_joints(in.require("joints", "a list of the robot's joints"), in.key_of("joints"));
  const Node& scenes = in.require("scenes", "a map {NAME: {base, boxes, configurations}}");
  const std::string at = in.key_of("scenes");
  if (scenes.kind != Node::Kind::kMap || scenes.entries.empty())
    config::fail(scenes.mark, at, "expected a map {NAME: {base, boxes, configurations}}");
  for (const auto& [name, scene] : scenes.entries) {
    out.scenes_.push_back(read_scene(name, scene, at + "." + name, static_cast<int>(out.joints_.size())));
    out.size_ += pairs_of(out.scenes_.back());
  }
  in.finish();
  return out;
}

Json Scenes::to_json() const {
  Json scenes = Json::object();
  for (const Scene& scene : scenes_) {
    Json configurations = Json::array();
    for (const VectorX& q : scene.configurations) configurations.push_back(list_of(q));
    scenes[scene.name] = {
        {"base", list_of(scene.base)}, {"boxes", boxes_json(scene)}, {"configurations", std::move(configurations)}};
  }
  return {{"joints", joints_}, {"scenes", std::move(scenes)}};
}

Scenes::Place Scenes::place(std::uint64_t index) const {
  for (const Scene& scene : scenes_) {
    const std::uint64_t pairs = pairs_of(scene);
    if (index >= pairs) {
      index -= pairs;
      continue;
    }
    std::size_t from = 0;
    for (std::uint64_t row = scene.configurations.size() - 1; index >= row; --row) {
      index -= row;
      ++from;
    }
    return {&scene, from, from + 1 + static_cast<std::size_t>(index)};
  }
  throw GenerationError(fmt::format("worlds.scenes: there is no problem beyond {}", size_));
}

World Scenes::make(const std::shared_ptr<const RobotModel>& model, std::uint64_t index) const {
  const Place at = place(index);
  SceneBuilder builder(model, 0, index, {});
  World world;
  builder.begin(0, world);
  world.family = at.scene->name;
  world.start = {at.scene->base, VectorX::Zero(model->num_joints())};
  world.witness = world.start;
  for (int i = 0; i < model->num_joints(); ++i) {
    const std::string& joint = model->joint(i).name;
    const auto found = std::ranges::find(joints_, joint);
    if (found == joints_.end() || static_cast<int>(joints_.size()) != model->num_joints())
      throw GenerationError(fmt::format("worlds.scenes: the problems are of the joints {}, and robot {} controls {}{}",
                                        fmt::join(joints_, ", "), model->name, model->num_joints(),
                                        found == joints_.end() ? ", among them " + joint : " of them"));
    const auto k = static_cast<Eigen::Index>(found - joints_.begin());
    world.start.q[i] = at.scene->configurations[at.from][k];
    world.witness.q[i] = at.scene->configurations[at.to][k];
  }
  world.objects = at.scene->boxes;
  builder.take_robot(world);
  builder.measure(world);
  return world;
}

Json Scenes::identity(std::uint64_t index) const {
  const Place at = place(index);
  return {{"joints", joints_},
          {"base", list_of(at.scene->base)},
          {"boxes", boxes_json(*at.scene)},
          {"start", list_of(at.scene->configurations[at.from])},
          {"goal", list_of(at.scene->configurations[at.to])}};
}

}  // namespace moma
