#include "world/scenario/moveit.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "controller/config/mesh_hull.h"
#include "controller/config/reader.h"

namespace moma::foreign {
namespace {

using config::Node;

constexpr double kSlab = 0.2, kSlabEdge = 20.0;  // size of the slab that replaces a plane [m]

/// True if each edge belongs to two triangles, which go along it in opposite directions. Vertices at one place are one.
bool is_watertight(const config::Mesh& mesh) {
  std::map<std::array<double, 3>, int> places;
  std::map<std::pair<int, int>, int> edges;
  const auto place = [&](int vertex) {
    const Vector3& p = mesh.vertices[static_cast<std::size_t>(vertex)];
    return places.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(places.size())).first->second;
  };
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) ++edges[{place(t[i]), place(t[(i + 1) % 3])}];
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto back = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && back != edges.end() && back->second == 1;
  });
}

/// Volume inside a closed surface, by the divergence theorem [m^3].
double volume_of(const std::vector<Vector3>& vertices, const std::vector<Eigen::Vector3i>& triangles) {
  const auto at = [&](int i) -> Vector3 { return vertices[static_cast<std::size_t>(i)] - vertices.front(); };
  double volume = 0.0;
  for (const Eigen::Vector3i& t : triangles) volume += at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0;
  return std::abs(volume);
}

/// Reads MoveIt's messages.
class Messages {
 public:
  Messages(const Kinematics& at_ready, Changes& changes)
      : model_(at_ready.model()), at_ready_(at_ready), changes_(changes) {}

  Scene read_scene(const Node& root, const std::string& family) {
    Scene scene;
    const Node* named = root.find("name");
    scene.name = named != nullptr && !named->scalar.empty() ? named->scalar : family;
    const Node* world = root.find("world");
    const Node& from = world != nullptr ? *world : root;
    for (const Node& object : list_of(from, "collision_objects")) {
      const std::string id = config::read_string(need(object, "id", "the object's name"), "id");
      const Node* pose = object.find("pose");
      const Isometry X_WO = frame(object) * (pose != nullptr ? read_pose(*pose) : Isometry::Identity());
      const std::vector<Part> parts = parts_of(object, id);
      if (parts.empty()) config::fail(object.mark, "primitives", "the object " + id + " has no shape");
      add(scene, id, X_WO, parts);
    }
    if (const Node* state = root.find("robot_state")) scene.attached = read_attached(*state);
    if (const Node* octomap = from.find("octomap"))
      if (const Node* map = octomap->find("octomap"))
        if (!list_of(*map, "data").empty()) note("occupancy maps are left out", scene.name);
    return scene;
  }

  Request read_request(const Node& root) {
    Request request;
    request.mark = root.mark;
    if (const Node* state = root.find("start_state")) {
      take_state(*state, request.start);
      request.attached = read_attached(*state);
    }
    const std::vector<Node>& goals = list_of(root, "goal_constraints");
    if (goals.empty()) config::fail(root.mark, "goal_constraints", "expected a goal");
    if (goals.size() > 1) note("of several goals the first is taken", root.mark.file);
    for (const Node& joint : list_of(goals.front(), "joint_constraints"))
      request.goal[config::read_string(need(joint, "joint_name", "a joint"), "joint_name")] =
          config::read_number(need(joint, "position", "its value"), "position");
    if (request.goal.empty())
      config::fail(goals.front().mark, "goal_constraints",
                   "expected joint_constraints: a goal that is a pose alone has no configuration that shows it can be "
                   "reached");
    return request;
  }

 private:
  void note(const std::string& what, const std::string& name) { changes_[what].insert(name); }

  Isometry frame(const Node& object) { return at_ready_.X_WL(frame_link(object)); }

  int frame_link(const Node& object) {
    const Node* header = object.find("header");
    const Node* id = header != nullptr ? header->find("frame_id") : nullptr;
    std::string name = id != nullptr ? id->scalar : "";
    if (!name.empty() && name.front() == '/') name.erase(0, 1);
    const int link = name.empty() || name == "@base" ? -1 : model_.find_link(name);
    if (link >= 0) return link;
    if (!name.empty()) note("frames that are no link of the robot are replaced by its root", name);
    return 1;
  }

  Part primitive(const Node& node, const std::string& owner) {
    const std::string type = config::read_string(need(node, "type", "box, sphere, cylinder or cone"), "type");
    const Node& dimensions = need(node, "dimensions", "the shape's numbers");
    const std::vector<double> d = config::read_numbers(dimensions, "dimensions", -1, Range::positive());
    const auto wants = [&](std::size_t count) {
      if (d.size() != count)
        config::fail(dimensions.mark, "dimensions", fmt::format("a {} has {}, found {}", type, count, d.size()));
    };
    Part part;
    if (type == "box" || type == "1") {
      wants(3);
      part.shape = {ShapeKind::kBox, Vector3(d[0], d[1], d[2]), nullptr};
    } else if (type == "sphere" || type == "2") {
      wants(1);
      part.shape = {ShapeKind::kSphere, Vector3(d[0], 0.0, 0.0), nullptr};
    } else if (type == "cylinder" || type == "3" || type == "cone" || type == "4") {
      wants(2);  // height, radius
      part.shape = {ShapeKind::kCylinder, Vector3(d[1], d[0], 0.0), nullptr};
      if (type == "cone" || type == "4") note("cones are the cylinders around them", owner);
    } else {
      config::fail(node.mark, "type", "found '" + type + "', expected box, sphere, cylinder or cone");
    }
    return part;
  }

  Part plane(const Eigen::Vector4d& abcd, const config::Mark& mark, const std::string& owner) {
    const Vector3 n = abcd.head<3>();
    if (!(n.norm() > 1e-9)) config::fail(mark, "coef", "expected a, b, c, d of a x + b y + c z + d = 0");
    note(fmt::format("planes are slabs of {} x {} x {} m behind them", kSlabEdge, kSlabEdge, kSlab), owner);
    Part part;
    part.shape = {ShapeKind::kBox, Vector3(kSlabEdge, kSlabEdge, kSlab), nullptr};
    part.X.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), n).toRotationMatrix();
    part.X.translation() = -(abcd[3] / n.norm() + 0.5 * kSlab) * n.normalized();
    return part;
  }

  /// Triangles of a message; or none where it has none, as in a .scene.
  static std::vector<Eigen::Vector3i> triangles_of(const Node& node, std::size_t vertices) {
    std::vector<Eigen::Vector3i> triangles;
    for (const Node& item : list_of(node, "triangles")) {
      const Node& indices = need(item, "vertex_indices", "three indices");
      const std::vector<double> t =
          config::read_numbers(indices, "vertex_indices", 3, {0.0, static_cast<double>(vertices) - 1.0});
      for (const double index : t)
        if (index != std::floor(index)) config::fail(indices.mark, "vertex_indices", "expected whole numbers");
      triangles.emplace_back(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
    }
    return triangles;
  }

  Part mesh(const Node& node, const std::string& owner) {
    config::Mesh mesh;
    for (const Node& vertex : list_of(node, "vertices"))
      mesh.vertices.emplace_back(read_letters(vertex, "vertices", "xyz"));
    if (mesh.vertices.empty()) config::fail(node.mark, "vertices", "a mesh has some");
    mesh.triangles = triangles_of(node, mesh.vertices.size());
    Eigen::AlignedBox3d box;
    for (const Vector3& p : mesh.vertices) box.extend(p);
    const config::MeshSolid solid = config::point_solid(mesh.vertices);
    const Vector3 size = box.sizes();
    std::string text = fmt::format("{} ({:.3g} x {:.3g} x {:.3g} m, ", owner, size.x(), size.y(), size.z());
    if (!is_watertight(mesh))
      text += "not watertight)";
    else if (solid.flat)
      text += "flat)";
    else
      text += fmt::format("watertight, its hull has {:.2f} times its volume)",
                          volume_of(solid.shape.hull->vertices, solid.shape.hull->triangles) /
                              volume_of(mesh.vertices, mesh.triangles));
    note("meshes are the convex hulls of their vertices", text);
    return {solid.shape, solid.X_MS};
  }

  /// Shapes of a collision object, in its frame.
  std::vector<Part> parts_of(const Node& object, const std::string& id) {
    std::vector<Part> parts;
    const bool placed = object.find("pose") != nullptr;
    const auto take = [&](const std::string& shapes, const std::string& poses, const auto& part_of) {
      const std::vector<Node>& all = list_of(object, shapes);
      const std::vector<Node>& at = list_of(object, poses);
      if (at.size() > all.size() || (at.size() < all.size() && !(at.empty() && placed)))
        config::fail(object.mark, poses, fmt::format("{} has {} {} and {} poses", id, all.size(), shapes, at.size()));
      for (std::size_t i = 0; i < all.size(); ++i) {
        Part part = part_of(all[i]);
        if (i < at.size()) part.X = read_pose(at[i]) * part.X;
        parts.push_back(std::move(part));
      }
    };
    take("primitives", "primitive_poses", [&](const Node& node) { return primitive(node, id); });
    take("planes", "plane_poses", [&](const Node& node) {
      return plane(read_letters(need(node, "coef", "a, b, c, d"), "coef", "abcd"), node.mark, id);
    });
    take("meshes", "mesh_poses", [&](const Node& node) { return mesh(node, id); });
    return parts;
  }

  AttachedObjects read_attached(const Node& state) {
    AttachedObjects out;
    for (const Node& held : list_of(state, "attached_collision_objects")) {
      const Node& object = need(held, "object", "a collision object");
      const Node* operation = object.find("operation");
      if (operation != nullptr && (operation->scalar == "1" || operation->scalar == "REMOVE")) continue;
      const std::string id = config::read_string(need(object, "id", "the object's name"), "id");
      const Node& at = need(held, "link_name", "the link that holds " + id);
      const int link = model_.find_link(at.scalar);
      if (link < 0)
        config::fail(at.mark, "link_name", fmt::format("robot {} has no link '{}'", model_.name, at.scalar));
      if (model_.rigid_root(link) != model_.rigid_root(model_.tip))
        config::fail(
            at.mark, "link_name",
            fmt::format("the object {} is attached to {}, which joints move against the end effector's link {}; "
                        "expected one that is rigid with it",
                        id, at.scalar, model_.link(model_.tip).name));
      Attached& attached = out[id];
      attached = {frame_link(object), parts_of(object, id), {}, held.mark};
      if (const Node* pose = object.find("pose"))
        for (Part& part : attached.parts) part.X = read_pose(*pose) * part.X;
      for (const Node& name : list_of(held, "touch_links")) {
        if (model_.find_link(name.scalar) >= 0)
          attached.touch.push_back(name.scalar);
        else
          note("touch_links that are no links of the robot are left out", name.scalar);
      }
    }
    return out;
  }

  static void take_state(const Node& state, std::map<std::string, double>& q) {
    const Node* joints = state.find("joint_state");
    if (joints == nullptr) return;
    const std::vector<Node>& names = list_of(*joints, "name");
    const std::vector<Node>& values = list_of(*joints, "position");
    if (names.size() != values.size())
      config::fail(joints->mark, "position", fmt::format("{} values of {} joints", values.size(), names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) q[names[i].scalar] = config::read_number(values[i], "position");
  }

  const RobotModel& model_;
  const Kinematics& at_ready_;
  Changes& changes_;
};

}  // namespace

Scene read_scene(const Kinematics& at_ready, const Node& root, const std::string& family, Changes& changes) {
  return Messages(at_ready, changes).read_scene(root, family);
}

Request read_request(const Kinematics& at_ready, const Node& root, Changes& changes) {
  return Messages(at_ready, changes).read_request(root);
}

}  // namespace moma::foreign
