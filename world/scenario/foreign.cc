#include "world/scenario/foreign.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string_view>
#include <utility>

#include "controller/config/mesh_hull.h"
#include "controller/config/reader.h"
#include "controller/model/kinematics.h"
#include "world/holding.h"
#include "world/scenario/scene_builder.h"
#include "world/scenario/scenes.h"

namespace moma {
namespace {

using config::Node;

constexpr double kSlab = 0.2, kSlabEdge = 20.0;  // size of the slab that replaces a plane [m]

/// Returns `name` of a map, or throws an error with the wanted content. Ignores message keys that do not concern
/// shapes.
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

/// Reads `count` numbers from a list, or from a map with these keys in turn.
VectorX numbers(const Node& node, const std::string& key, std::string_view letters) {
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

/// Reads `position` and, if given, the quaternion under `key`.
Isometry read_pose(const Node& node, const std::string& key = "orientation") {
  const Node* orientation = node.find(key);
  Eigen::Vector4d xyzw(0.0, 0.0, 0.0, 1.0);
  if (orientation != nullptr) xyzw = numbers(*orientation, key, "xyzw");
  if (!(xyzw.norm() > 1e-6)) config::fail(node.mark, key, "expected a quaternion x, y, z, w that is not zero");
  Isometry X = Isometry::Identity();
  X.linear() = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized().toRotationMatrix();
  X.translation() = numbers(need(node, "position", "x, y, z"), "position", "xyz");
  return X;
}

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

struct Part {
  Shape shape;
  Isometry X = Isometry::Identity();  ///< in its object's frame
};

/// An object in the hand; without parts, it is the scene's object of the same name.
struct Attached {
  int frame = 0;  ///< link in which the parts stand
  std::vector<Part> parts;
  std::vector<std::string> touch;  ///< links that it may touch
  config::Mark mark;
};
using AttachedObjects = std::map<std::string, Attached>;

struct Scene {
  std::string name;
  std::vector<WorldObject> objects;  ///< X_WO
  AttachedObjects attached;
};

struct Request {
  std::map<std::string, double> start, goal;
  AttachedObjects attached;
  config::Mark mark;
};

/// Returns points whose convex hull contains the placed part, and exceeds a round one by 2 % of its radius at most.
std::vector<Vector3> points_around(const Part& part) {
  const Vector3& size = part.shape.size;
  std::vector<Vector3> points;
  if (part.shape.hull) {
    points = part.shape.hull->vertices;
  } else if (part.shape.kind == ShapeKind::kBox) {
    for (int i = 0; i < 8; ++i)
      points.emplace_back(
          0.5 * Vector3(i & 1 ? size.x() : -size.x(), i & 2 ? size.y() : -size.y(), i & 4 ? size.z() : -size.z()));
  } else {
    // A sphere lies within the hull of rings 15 degrees apart, a cylinder within a prism of as many sides.
    constexpr int kSides = 24;
    constexpr double kStep = 2.0 * std::numbers::pi / kSides;
    const bool sphere = part.shape.kind == ShapeKind::kSphere;
    const double beyond = std::pow(std::cos(0.5 * kStep), sphere ? -2.0 : -1.0);
    for (int i = 0; i < kSides; ++i) {
      const Vector3 side = beyond * size.x() * Vector3(std::cos(kStep * i), std::sin(kStep * i), 0.0);
      for (int ring = 0; ring <= kSides / 2 && sphere; ++ring)
        points.emplace_back(std::sin(kStep * ring) * side +
                            std::cos(kStep * ring) * beyond * size.x() * Vector3::UnitZ());
      for (const double z : {-0.5 * size.y(), 0.5 * size.y()})
        if (!sphere) points.emplace_back(side + z * Vector3::UnitZ());
    }
  }
  for (Vector3& p : points) p = part.X * p;
  return points;
}

class Importer {
 public:
  explicit Importer(const std::shared_ptr<const RobotModel>& model) : model_(model), at_ready_(model) {
    at_ready_.update(Vector3::Zero(), model->ready);
  }

  void read(const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
      std::set<fs::path> files;
      for (const auto& entry : fs::directory_iterator(path))
        if (is_scene_file(entry.path())) files.insert(entry.path());
      if (files.empty()) config::fail({path.string()}, "", "this folder has no .yaml, .yml, .json or .scene");
      const std::string family = fs::weakly_canonical(path).filename().string();
      for (const fs::path& file : files) read_file(file, family);
      pair_up();
      return;
    }
    read_file(path, path.stem().string());
  }

  ForeignWorlds finish() {
    pair_up();
    if (out_.worlds.empty())
      throw config::ConfigError("these files hold no problem: a scene needs a request with a goal");
    for (const auto& [what, names] : not_as_it_was_) {
      constexpr std::size_t kShown = 5;
      const std::vector<std::string> shown(names.begin(), std::next(names.begin(), std::min(names.size(), kShown)));
      out_.notes.push_back(fmt::format("{}: {}", what, fmt::join(shown, ", ")));
      if (names.size() > kShown) out_.notes.back() += fmt::format(" and {} more", names.size() - kShown);
    }
    const auto touching = std::count_if(out_.worlds.begin(), out_.worlds.end(),
                                        [](const World& world) { return world.difficulty.witness_clearance_m <= 0.0; });
    if (touching > 0)
      out_.notes.push_back(fmt::format("{} of {} goals are in touch with an object", touching, out_.worlds.size()));
    return std::move(out_);
  }

 private:
  static bool is_scene_file(const fs::path& path) {
    const std::string end = path.extension().string();
    return end == ".yaml" || end == ".yml" || end == ".json" || end == ".scene";
  }

  void note(const std::string& what, const std::string& name) { not_as_it_was_[what].insert(name); }

  void read_file(const fs::path& file, const std::string& family) {
    if (file.extension() == ".scene") {
      scenes_.push_back(read_scene(read_moveit_text(file), family));
      return;
    }
    const Node root = config::load_yaml(file);
    if (root.find("problems") != nullptr) {
      read_vamp(root);
    } else if (root.find("scenes") != nullptr && root.find("joints") != nullptr) {
      const Scenes own = Scenes::read(root, "");
      for (std::uint64_t i = 0; i < own.size(); ++i) {
        out_.worlds.push_back(own.make(model_, i));
        out_.worlds.back().index = out_.worlds.size() - 1;
      }
    } else if (root.find("goal_constraints") != nullptr) {
      requests_.push_back(read_request(root));
    } else if (root.find("world") != nullptr || root.find("collision_objects") != nullptr) {
      scenes_.push_back(read_scene(root, family));
    } else {
      config::fail(
          root.mark, "",
          "expected a planning scene (`world`), a motion plan request (`goal_constraints`), VAMP's `problems`, or "
          "`joints` and `scenes`");
    }
  }

  Isometry frame(const Node& object) { return at_ready_.X_WL(frame_link(object)); }

  int frame_link(const Node& object) {
    const Node* header = object.find("header");
    const Node* id = header != nullptr ? header->find("frame_id") : nullptr;
    std::string name = id != nullptr ? id->scalar : "";
    if (!name.empty() && name.front() == '/') name.erase(0, 1);
    const int link = name.empty() || name == "@base" ? -1 : model_->find_link(name);
    if (link >= 0) return link;
    if (!name.empty()) note("frames that are no link of the robot are replaced by its root", name);
    return 1;
  }

  // --- shapes -------------------------------------------------------------------------------------------------------
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
    for (const Node& vertex : list_of(node, "vertices")) mesh.vertices.emplace_back(numbers(vertex, "vertices", "xyz"));
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

  static void add(Scene& scene, const std::string& name, const Isometry& X_WO, const std::vector<Part>& parts) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      WorldObject object;
      object.name = parts.size() == 1 ? name : fmt::format("{}/{}", name, i + 1);
      object.shape = parts[i].shape;
      const Isometry X = X_WO * parts[i].X;
      set_pose(object, X.translation(), Eigen::Quaterniond(X.linear()));
      scene.objects.push_back(std::move(object));
    }
  }

  // --- MoveIt's messages --------------------------------------------------------------------------------------------
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
      return plane(numbers(need(node, "coef", "a, b, c, d"), "coef", "abcd"), node.mark, id);
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
      const int link = model_->find_link(at.scalar);
      if (link < 0)
        config::fail(at.mark, "link_name", fmt::format("robot {} has no link '{}'", model_->name, at.scalar));
      if (model_->rigid_root(link) != model_->rigid_root(model_->tip))
        config::fail(
            at.mark, "link_name",
            fmt::format("the object {} is attached to {}, which joints move against the end effector's link {}; "
                        "expected one that is rigid with it",
                        id, at.scalar, model_->link(model_->tip).name));
      Attached& attached = out[id];
      attached = {frame_link(object), parts_of(object, id), {}, held.mark};
      if (const Node* pose = object.find("pose"))
        for (Part& part : attached.parts) part.X = read_pose(*pose) * part.X;
      for (const Node& name : list_of(held, "touch_links")) {
        if (model_->find_link(name.scalar) >= 0)
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

  // --- VAMP ---------------------------------------------------------------------------------------------------------
  void read_vamp(const Node& root) {
    std::vector<std::string> joints;
    for (const Node& joint : list_of(root, "joints")) joints.push_back(config::read_string(joint, "joints"));
    if (joints.empty()) config::fail(root.mark, "joints", "missing; expected the names of the configurations' joints");
    const auto configuration = [&](const Node& node, const std::string& key) {
      const std::vector<double> q = config::read_numbers(node, key, static_cast<int>(joints.size()));
      std::map<std::string, double> named;
      for (std::size_t i = 0; i < q.size(); ++i) named[joints[i]] = q[i];
      return named;
    };
    const Node& problems = need(root, "problems", "a map {NAME: [PROBLEM, ...]}");
    if (problems.kind != Node::Kind::kMap)
      config::fail(problems.mark, "problems", "expected a map {NAME: [PROBLEM, ...]}");
    for (const auto& [family, list] : problems.entries) {
      for (const Node& problem : list.items) {
        Scene scene;
        scene.name = family;
        for (const char* kind : {"sphere", "cylinder", "box"})
          for (const Node& object : list_of(problem, kind)) add_vamp(scene, kind, object);
        Request request;
        request.mark = problem.mark;
        request.start = configuration(need(problem, "start", "a configuration"), "start");
        const std::vector<Node>& goals = list_of(problem, "goals");
        if (goals.empty()) config::fail(problem.mark, "goals", "expected a list of configurations");
        if (goals.size() > 1) note("of several goals the first is taken", family);
        request.goal = configuration(goals.front(), "goals");
        make(scene, request);
      }
    }
  }

  void add_vamp(Scene& scene, const std::string& kind, const Node& object) {
    Part part;
    const auto number = [&](const char* key) {
      return config::read_number(need(object, key, "a number"), key, Range::positive());
    };
    if (kind == "sphere") {
      part.shape = {ShapeKind::kSphere, Vector3(number("radius"), 0.0, 0.0), nullptr};
    } else if (kind == "cylinder") {
      part.shape = {ShapeKind::kCylinder, Vector3(number("radius"), number("length"), 0.0), nullptr};
    } else {
      const Node& half = need(object, "half_extents", "three half edges");
      const std::vector<double> h = config::read_numbers(half, "half_extents", 3, Range::positive());
      part.shape = {ShapeKind::kBox, 2.0 * Vector3(h[0], h[1], h[2]), nullptr};
    }
    part.X = read_pose(object, "orientation_quat_xyzw");
    const Node* name = object.find("name");
    const std::string id = name != nullptr ? name->scalar : fmt::format("{}{}", kind, scene.objects.size());
    add(scene, id, at_ready_.X_WL(1), {part});
  }

  // --- problems -----------------------------------------------------------------------------------------------------
  void pair_up() {
    if (scenes_.empty() && requests_.empty()) return;
    if (scenes_.empty() || requests_.empty() || (scenes_.size() != 1 && scenes_.size() != requests_.size()))
      throw config::ConfigError(fmt::format(
          "found {} planning scenes and {} requests; expected as many of both, or one scene for all requests",
          scenes_.size(), requests_.size()));
    for (std::size_t i = 0; i < requests_.size(); ++i) make(scenes_[scenes_.size() == 1 ? 0 : i], requests_[i]);
    scenes_.clear();
    requests_.clear();
  }

  VectorX configuration(const std::map<std::string, double>& named, const Request& request, bool goal) {
    VectorX q = model_->ready;
    for (int i = 0; i < model_->num_joints(); ++i) {
      const std::string& joint = model_->joints[static_cast<std::size_t>(i)].name;
      const auto found = named.find(joint);
      if (found != named.end())
        q[i] = found->second;
      else if (goal)
        config::fail(request.mark, "goal",
                     "says nothing of the joint " + joint + ", which robot " + model_->name + " controls");
    }
    return q;
  }

  /// Puts into the hand what is attached: one object as it is, of several shapes their convex hull.
  void hold(AttachedObjects attached, World& world) {
    Kinematics kinematics(model_);
    kinematics.update(world.start.base, world.start.q);
    Held held;
    std::vector<std::string> names;
    std::vector<Part> parts;  // in W
    for (auto& [id, object] : attached) {
      for (Part& part : object.parts) part.X = kinematics.X_WL(object.frame) * part.X;
      std::erase_if(world.objects, [&, whole = object.parts.empty(), id = id](const WorldObject& other) {
        if (other.name != id && !other.name.starts_with(id + "/")) return false;
        if (whole) object.parts.push_back({other.shape, other.X_WO});
        return true;
      });
      if (object.parts.empty())
        config::fail(object.mark, "object",
                     "the attached object " + id + " has no shape, and is no object of the scene");
      parts.insert(parts.end(), object.parts.begin(), object.parts.end());
      held.touch.insert(held.touch.end(), object.touch.begin(), object.touch.end());
      names.push_back(id);
    }
    held.object = fmt::format("{}", fmt::join(names, "+"));
    if (parts.size() > 1) {
      std::vector<Vector3> points;
      for (const Part& part : parts) {
        const std::vector<Vector3> more = points_around(part);
        points.insert(points.end(), more.begin(), more.end());
      }
      const config::MeshSolid solid = config::point_solid(std::move(points));
      note("attached shapes are held as one convex hull", fmt::format("{} ({})", held.object, parts.size()));
      parts = {{solid.shape, solid.X_MS}};
    }
    note("attached objects are in the hand from the start", held.object);
    WorldObject object;
    object.name = held.object;
    object.shape = parts.front().shape;
    set_pose(object, parts.front().X.translation(), Eigen::Quaterniond(parts.front().X.linear()));
    world.objects.push_back(std::move(object));
    world.held = std::move(held);
  }

  void make(const Scene& scene, const Request& request) {
    World world;
    world.index = out_.worlds.size();
    world.robot = model_->name;
    world.family = scene.name;
    world.start = {Vector3::Zero(), configuration(request.start, request, false)};
    world.witness = {Vector3::Zero(), configuration(request.goal, request, true)};
    world.objects = scene.objects;
    AttachedObjects attached = request.attached;
    attached.insert(scene.attached.begin(), scene.attached.end());
    if (!attached.empty()) hold(std::move(attached), world);
    std::map<std::string, int> seen;
    for (WorldObject& object : world.objects) {
      const int times = ++seen[object.name];
      if (times > 1) object.name += fmt::format("#{}", times);
    }
    if (world.held) world.held->object = world.objects.back().name;
    SceneBuilder builder(robot_at_start(model_, world), 0, world.index, {});
    builder.take_robot(world);
    builder.measure(world);
    out_.worlds.push_back(std::move(world));
  }

  std::shared_ptr<const RobotModel> model_;
  Kinematics at_ready_;
  std::vector<Scene> scenes_;
  std::vector<Request> requests_;
  std::map<std::string, std::set<std::string>> not_as_it_was_;
  ForeignWorlds out_;
};

}  // namespace

ForeignWorlds read_foreign(const std::shared_ptr<const RobotModel>& model, const std::vector<fs::path>& files) {
  Importer importer(model);
  for (const fs::path& file : files) importer.read(file);
  return importer.finish();
}

}  // namespace moma
