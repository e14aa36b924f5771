#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/mesh_hull.h"
#include "controller/config/node.h"
#include "controller/config/object_file.h"
#include "controller/config/robot_build.h"
#include "controller/config/write_described.h"
#include "controller/model/proximity.h"

namespace moma::config {
namespace {

// Unlike write_shape(), with the coordinates of a hull in one list.
Json shape_to_json(const RobotModel& model, const CollisionShape& shape) {
  Json json{{"link", model.link(shape.link).name}, {"shape", to_string(shape.shape.kind)}};
  if (shape.shape.hull) {
    auto& vertices = json["vertices"] = Json::array();
    auto& triangles = json["triangles"] = Json::array();
    for (const Vector3& v : shape.shape.hull->vertices) vertices.insert(vertices.end(), {v.x(), v.y(), v.z()});
    for (const Eigen::Vector3i& t : shape.shape.hull->triangles)
      triangles.insert(triangles.end(), {t.x(), t.y(), t.z()});
  } else {
    const auto count = static_cast<std::size_t>(num_sizes(shape.shape.kind));
    json["size"] = description::list_to_json({shape.shape.size.data(), count});
  }
  json["position"] = description::list_to_json(numbers_of(Vector3(shape.X_LS.translation())));
  const Matrix3 transposed = shape.X_LS.linear().transpose();  // row by row
  json["rotation"] = description::list_to_json({transposed.data(), 9});
  return json;
}

class CollisionReader {
 public:
  CollisionReader(MapReader& robot, RobotBuild& build) : robot_(robot), build_(build), model_(build.model) {}

  void read() {
    read_footprint();
    add_wheels();
    MapReader in(robot_, "collision");
    written_["shapes"] = Json::array();
    for (const char* key : {"shapes", "more"})
      if (const Node* list = in.get(key)) read_shapes(*list, in.key_of(key));
    std::string from;
    in.read("from", from);
    in.check(from.empty() || from == "urdf", "from", "found '" + from + "', expected urdf");
    const std::set<int> links = read_links(in, from);
    if (from == "urdf") take_urdf(in, links);
    check_arm(in, from);
    read_self(in);
    in.finish();
    build_.resolved["collision"] = std::move(written_);
  }

 private:
  void add(int link, const Shape& shape, const Isometry& X_LS) {
    CollisionShape added;
    const std::string& name = model_.link(link).name;
    const int number = ++count_[link];
    added.name = number == 1 ? name : name + "/" + std::to_string(number);
    added.link = link;
    added.shape = shape;
    added.X_LS = X_LS;
    added.rigid_with_base = !can_move_against(model_, 0, link);
    model_.shapes.push_back(std::move(added));
  }

  // An arm that nothing can touch has to be asked for: `shapes: []`. Resolved robots are as they were.
  void check_arm(MapReader& in, const std::string& from) {
    const bool arm = std::any_of(model_.shapes.begin(), model_.shapes.end(),
                                 [](const CollisionShape& shape) { return !shape.rigid_with_base; });
    if (arm) return;
    const Node* list = in.get("shapes");
    const bool meant = list != nullptr && list->items.empty();
    if (meant || robot_.get("urdf_text") != nullptr) {
      const std::string who = model_.shapes.empty() ? "the robot" : "the arm";
      build_.warnings.push_back(who + " has no collision shapes: nothing it does can be a collision");
      return;
    }
    const std::string why = from == "urdf" ? "the URDF has no collision geometry for what the arm's joints move"
                                           : "no link that the arm's joints move has a shape";
    robot_.fail_at("collision",
                   why +
                       ", so that nothing the arm does could be a collision; `moma robot FILE --fit-shapes` "
                       "makes shapes of the URDF's meshes, and an empty list, `shapes: []`, says that this is "
                       "meant");
  }

  void read_footprint() {
    MapReader base(robot_, "base");
    if (base.get("footprint") == nullptr) return;
    MapReader in(base, "footprint");
    const Shape shape = read_shape(in);
    add(0, shape, read_pose(in));
    in.read("mass", model_.base.mass, Range::non_negative());
    in.finish();
    Json json = shape_to_json(model_, model_.shapes.back());
    json.erase("link");
    json["mass"] = model_.base.mass;
    build_.resolved["base"]["footprint"] = std::move(json);
  }

  // Wheels of a given width are boxes of the base.
  void add_wheels() {
    const Wheels wheels = model_.base.wheels.value_or(Wheels{});
    if (wheels.width == 0.0) return;
    const Vector3 size(2.0 * wheels.radius, wheels.width, 2.0 * wheels.radius);
    for (const double x : {0.5, -0.5}) {
      for (const double y : {0.5, -0.5}) {
        const Eigen::Translation3d p_BS(x * wheels.wheelbase, y * wheels.separation, wheels.radius);
        add(0, {ShapeKind::kBox, size, nullptr}, Isometry(p_BS));
      }
      if (wheels.wheelbase == 0.0) break;
    }
  }

  void read_shapes(const Node& list, const std::string& key) {
    for_items(list, key, "a list of shapes", [&](const Node& item, const std::string& at) {
      MapReader in(item, at);
      in.require("link", "a link of the URDF, or @base");
      std::string name;
      in.read("link", name);
      const int link = link_named(in, "link", name);
      const Shape shape = read_shape(in);
      add(link, shape, read_pose(in));
      in.finish();
      written_["shapes"].push_back(shape_to_json(model_, model_.shapes.back()));
    });
  }

  int link_named(const MapReader& in, const char* key, const std::string& name) const {
    const int link = model_.find_link(name);
    if (link >= 0) return link;
    std::vector<std::string> names;
    for (const Link& l : model_.links) names.push_back(l.name);
    in.fail_at(key, "found '" + name + "', which is no link of the URDF and not @base" + suggestion(name, names));
  }

  // `links` names the links whose geometry comes from the URDF; without it all do. Resolved robots have the shapes
  // instead.
  std::set<int> read_links(MapReader& in, const std::string& from) const {
    const Node* list = in.get("links");
    if (list == nullptr) return {};
    in.check(from == "urdf", "links", "says which links' geometry `from: urdf` takes, and there is no `from: urdf`");
    in.check(list->kind == Node::Kind::kSequence && !list->items.empty(), "links",
             "expected a list of links of the URDF");
    std::set<int> links;
    for (const Node& item : list->items) links.insert(link_named(in, "links", read_string(item, in.key_of("links"))));
    return links;
  }

  // Links that have shapes of their own in the file keep those alone.
  void take_urdf(const MapReader& in, const std::set<int>& links) {
    const std::map<int, int> own = count_;
    for (std::size_t i = 0; i < build_.tree.links.size(); ++i) {
      const UrdfLink& source = build_.tree.links[i];
      const int link = static_cast<int>(i) + 1;
      if (own.count(link) != 0 || (!links.empty() && links.count(link) == 0)) continue;
      for (const UrdfGeometry& geometry : source.collision) {
        if (geometry.mesh.empty()) {
          add(link, geometry.shape, geometry.X_LS);
        } else {
          try {
            const auto file = build_.packages.resolve(geometry.mesh);
            const Vector3& s = geometry.scale;
            const MeshSolids::key_type name(file.string(), {s.x(), s.y(), s.z()});
            auto at = build_.meshes->find(name);
            if (at == build_.meshes->end())
              at = build_.meshes->emplace(name, point_solid(read_mesh(file, s).vertices)).first;
            if (at->second.flat)
              build_.warnings.push_back("link " + source.name + ": the flat mesh " + geometry.mesh +
                                        " became a thin box");
            if (at->second.excess > 0.0) {
              std::array<char, 32> text{};
              std::snprintf(text.data(), text.size(), "%.2g", 1e3 * at->second.excess);
              build_.notes.push_back("link " + source.name + ": its hull of " +
                                     std::to_string(at->second.shape.hull->vertices.size()) +
                                     " vertices exceeds the exact hull of " + file.filename().string() + " by up to " +
                                     text.data() + " mm");
            }
            add(link, at->second.shape, geometry.X_LS * at->second.X_MS);
          } catch (const std::runtime_error& e) {
            in.fail_at("from", "link " + source.name + ": " + e.what());
          }
        }
        written_["shapes"].push_back(shape_to_json(model_, model_.shapes.back()));
      }
    }
  }

  void read_self(MapReader& in) {
    double stop = 0.01;
    in.read("self_stop", stop, Range::non_negative());
    const Node* self = in.get("self");
    const Node* pairs = in.get("pairs");  // only in resolved robots
    if (pairs != nullptr) {
      in.check(self == nullptr, "pairs", "give `self` or `pairs`, not both");
      read_index_pairs(*pairs, in.key_of("pairs"));
    } else if (self == nullptr || (self->kind == Node::Kind::kScalar && self->scalar == "auto")) {
      model_.self_pairs = find_self_pairs(model_, stop, build_.notes, build_.warnings);
    } else {
      read_named_pairs(*self, in.key_of("self"));
    }
    auto& out = written_["pairs"] = Json::array();
    for (const SelfPair& pair : model_.self_pairs) out.push_back({pair.first, pair.second, pair.row});
  }

  void read_index_pairs(const Node& list, const std::string& key) {
    const auto last = static_cast<long long>(model_.shapes.size()) - 1;
    for_items(list, key, "a list of [shape, shape, row]", [&](const Node& item, const std::string& at) {
      if (item.items.size() != 3) fail(item.mark, at, "expected [shape, shape, true or false]");
      const auto a = static_cast<int>(read_integer(item.items[0], at, 0, last));
      const auto b = static_cast<int>(read_integer(item.items[1], at, a + 1, last));
      model_.self_pairs.push_back({a, b, read_bool(item.items[2], at)});
    });
  }

  // Shapes of a link, or the one shape of that very name (LINK/2).
  std::vector<int> shapes_named(const Node& node, const std::string& key) const {
    const std::string name = read_string(node, key);
    const int link = model_.find_link(name);
    std::vector<int> found;
    for (std::size_t i = 0; i < model_.shapes.size(); ++i)
      if (link >= 0 ? model_.shapes[i].link == link : model_.shapes[i].name == name)
        found.push_back(static_cast<int>(i));
    if (found.empty()) {
      std::vector<std::string> names;
      for (const CollisionShape& shape : model_.shapes) names.push_back(shape.name);
      fail(node.mark, key, "found '" + name + "', which has no collision shape" + suggestion(name, names));
    }
    return found;
  }

  void read_named_pairs(const Node& list, const std::string& key) {
    std::set<std::pair<int, int>> chosen;
    for_items(list, key, "auto or a list of [link, link]", [&](const Node& item, const std::string& at) {
      if (item.items.size() != 2) fail(item.mark, at, "expected [link, link]");
      bool moves = false;
      for (const int a : shapes_named(item.items[0], at)) {
        for (const int b : shapes_named(item.items[1], at)) {
          if (!can_move_against(model_, model_.shape(a).link, model_.shape(b).link)) continue;
          moves = true;
          chosen.insert(std::minmax(a, b));
        }
      }
      if (!moves) fail(item.mark, at, "no controlled joint lies between these two, so they never come closer");
    });
    const Kinematics at_ready(std::make_shared<RobotModel>(model_));
    for (const auto& [a, b] : chosen) {
      model_.self_pairs.push_back({a, b, true});
      const CollisionShape& first = model_.shape(a);
      const CollisionShape& second = model_.shape(b);
      if (shape_distance(first.shape, at_ready.X_WS(first), second.shape, at_ready.X_WS(second)).d <= 0.0)
        build_.warnings.push_back("self-collision at `ready`: " + first.name + " and " + second.name);
    }
  }

  MapReader& robot_;
  RobotBuild& build_;
  RobotModel& model_;
  Json written_ = Json::object();
  std::map<int, int> count_;  // shapes so far, by link
};

}  // namespace

void read_collision(MapReader& robot, RobotBuild& build) { CollisionReader(robot, build).read(); }

}  // namespace moma::config
