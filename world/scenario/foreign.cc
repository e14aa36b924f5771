#include "world/scenario/foreign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "controller/config/mesh_hull.h"
#include "controller/config/reader.h"
#include "controller/model/kinematics.h"
#include "world/holding.h"
#include "world/scenario/foreign_parts.h"
#include "world/scenario/moveit.h"
#include "world/scenario/scene_builder.h"
#include "world/scenario/scenes.h"

namespace moma::foreign {
namespace {

using config::Node;

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
    if (touching_ > 0)
      changes_[fmt::format("{} of {} starts are in touch, so that their trials collide at once", touching_,
                           out_.worlds.size())] = in_touch_;
    for (const auto& [what, names] : changes_) {
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

  void note(const std::string& what, const std::string& name) { changes_[what].insert(name); }

  void read_file(const fs::path& file, const std::string& family) {
    if (file.extension() == ".scene") {
      scenes_.push_back(read_scene(at_ready_, read_moveit_text(file), family, changes_));
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
      requests_.push_back(read_request(at_ready_, root, changes_));
    } else if (root.find("world") != nullptr || root.find("collision_objects") != nullptr) {
      scenes_.push_back(read_scene(at_ready_, root, family, changes_));
    } else {
      config::fail(
          root.mark, "",
          "expected a planning scene (`world`), a motion plan request (`goal_constraints`), VAMP's `problems`, or "
          "`joints` and `scenes`");
    }
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
    set_pose(object, parts.front().X);
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
    const std::vector<std::string> pairs = builder.touching_at_start(world);
    touching_ += pairs.empty() ? 0 : 1;
    in_touch_.insert(pairs.begin(), pairs.end());
    out_.worlds.push_back(std::move(world));
  }

  std::shared_ptr<const RobotModel> model_;
  Kinematics at_ready_;
  std::vector<Scene> scenes_;
  std::vector<Request> requests_;
  Changes changes_;
  int touching_ = 0;                // starts in touch
  std::set<std::string> in_touch_;  // their pairs
  ForeignWorlds out_;
};

}  // namespace
}  // namespace moma::foreign

namespace moma {

ForeignWorlds read_foreign(const std::shared_ptr<const RobotModel>& model, const std::vector<fs::path>& files) {
  foreign::Importer importer(model);
  for (const fs::path& file : files) importer.read(file);
  return importer.finish();
}

}  // namespace moma
