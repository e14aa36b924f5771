#include "controller/fit/fit_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>

#include "controller/config/convex_hull.h"
#include "controller/config/robot_build.h"
#include "controller/config/robot_file.h"
#include "controller/config/urdf_collision.h"
#include "controller/config/yaml_text.h"
#include "controller/model/proximity.h"

namespace moma::fit {
namespace {

using config::Node;
using config::UrdfCollision;

constexpr int kPrismSides = 96;

// The prism around a cylinder, in the cylinder's frame.
Triangles prism(const Vector3& size) {
  const double radius = size.x() / std::cos(std::numbers::pi / kPrismSides);
  const auto corner = [&](int i, double sign) {  // sides, not edges, face x and y
    const double turn = 2.0 * std::numbers::pi * (i % kPrismSides + 0.5) / kPrismSides;
    return Vector3(radius * std::cos(turn), radius * std::sin(turn), 0.5 * sign * size.y());
  };
  Triangles triangles;
  for (int i = 0; i < kPrismSides; ++i) {
    triangles.push_back({corner(i, -1), corner(i + 1, -1), corner(i + 1, 1)});
    triangles.push_back({corner(i, -1), corner(i + 1, 1), corner(i, 1)});
    if (i < 2) continue;
    for (const double end : {-1.0, 1.0}) triangles.push_back({corner(0, end), corner(i - 1, end), corner(i, end)});
  }
  return triangles;
}

Triangles surface_of(const UrdfCollision& element) {
  Triangles triangles;
  if (element.mesh.empty()) {
    triangles = prism(element.shape.size);
  } else {
    const auto& vertices = element.surface.vertices;
    for (const Eigen::Vector3i& t : element.surface.triangles) triangles.push_back(config::corners(vertices, t));
    if (triangles.empty())  // points only
      for (const Vector3& v : vertices) triangles.push_back({v, v, v});
  }
  for (Triangle& t : triangles)
    for (Vector3& p : t) p = element.X_LS * p;
  return triangles;
}

std::string described(const std::vector<const UrdfCollision*>& elements) {
  std::map<ShapeKind, int> primitives;
  std::string name;
  int meshes = 0;
  std::size_t triangles = 0;
  for (const UrdfCollision* element : elements) {
    if (element->mesh.empty()) {
      ++primitives[element->shape.kind];
      continue;
    }
    name = ++meshes == 1 ? fs::path(element->mesh).filename().string() : fmt::format("{} meshes", meshes);
    triangles += element->surface.triangles.size();
  }
  if (meshes == 0) return kinds_text(primitives);
  return fmt::format("{} ({} triangles){}{}", name, triangles, primitives.empty() ? "" : ", ", kinds_text(primitives));
}

// Links of arms of the same type have the same geometry: the fit of an earlier one is taken over.
LinkFit fit_link(const std::string& link, const std::vector<const UrdfCollision*>& elements, const FitOptions& options,
                 const std::vector<LinkFit>& earlier) {
  LinkFit fit;
  fit.link = link;
  fit.had = described(elements);
  fit.box_weight = options.kinds.box_weight;
  for (const UrdfCollision* element : elements) {
    if (element->mesh.empty() && element->shape.kind != ShapeKind::kCylinder)
      fit.kept.push_back(as_it_is(element->shape, element->X_LS));
    else
      fit.surfaces.push_back(surface_of(*element));
  }
  if (fit.surfaces.empty()) return fit;
  const auto same = std::find_if(earlier.begin(), earlier.end(), [&](const LinkFit& other) {
    return other.box_weight == fit.box_weight && other.surfaces == fit.surfaces;
  });
  if (same != earlier.end()) {
    fit.fitted = same->fitted;
    fit.error = same->error;
    fit.like = same->link;
  } else {
    fit.fitted = fit_surfaces(fit.surfaces, options);
    fit.error = measure(together(fit.surfaces), fit.fitted);
  }
  return fit;
}

std::string numbers(const Vector3& values, int count = 3) {
  return "[" + joined(values.head(count), [](double value) { return fmt::format("{}", value + 0.0); }) + "]";
}

std::string shape_line(const std::string& link, const Placed& placed) {
  const Shape& shape = placed.solid.shape;
  std::string line =
      fmt::format("  - {{link: {}, shape: {}, size: {}, position: {}", config::yaml_scalar(link), to_string(shape.kind),
                  numbers(shape.size, num_sizes(shape.kind)), numbers(placed.position));
  if (shape.kind != ShapeKind::kSphere && !placed.rpy.isZero(0.0)) line += ", rpy: " + numbers(placed.rpy);
  return line + "}\n";
}

// After a fit LINK/2 may be another shape or none: the pair then names the whole link.
std::string self_text(const Node& self, const std::set<std::string>& fitted) {
  Node copy = self;
  for (Node& pair : copy.items) {
    for (Node& name : pair.items) {
      const std::size_t slash = name.scalar.rfind('/');
      if (slash != std::string::npos && fitted.count(name.scalar.substr(0, slash)) != 0) name.scalar.resize(slash);
    }
  }
  return config::to_flow_yaml(copy);
}

SelfContact self_contact(const RobotModel& model) {
  SelfContact contact;
  contact.shapes = model.shapes.size();
  contact.pairs = model.self_pairs.size();
  const Kinematics at_ready(std::make_shared<RobotModel>(model));
  std::set<std::pair<int, int>> links;
  for (const SelfPair& pair : config::movable_pairs(model)) {
    const CollisionShape& first = model.shape(pair.first);
    const CollisionShape& second = model.shape(pair.second);
    if (shape_distance(first.shape, at_ready.X_WS(first), second.shape, at_ready.X_WS(second)).d <= 0.0)
      links.insert(std::minmax(first.link, second.link));
  }
  for (const auto& [a, b] : links) contact.touching.emplace_back(model.link(a).name, model.link(b).name);
  return contact;
}

// A robot file and the part of its `collision` that stays.
class Source {
 public:
  explicit Source(const fs::path& file) : root_(config::load_yaml(file)) {
    const Node* collision = root_.find("collision");
    if (collision == nullptr) return;
    if (const Node* pairs = collision->find("pairs"))
      config::fail(pairs->mark, "collision.pairs", "pairs by number lose their meaning when shapes are fitted");
    if (const Node* shapes = collision->find("shapes"))
      for (const Node& shape : shapes->items) shapes_.push_back(shape);
    if (const Node* self = collision->find("self")) self_ = *self;
    if (const Node* stop = collision->find("self_stop")) stop_ = *stop;
  }

  /// The robot with its shapes before the fit, possibly none.
  config::LoadedRobot before(const fs::path& file, bool any_geometry) const {
    const Node* collision = root_.find("collision");
    const bool from = any_geometry && collision != nullptr && collision->find("from") != nullptr;
    return from || !shapes_.empty() ? config::load_robot(file) : with("shapes: []\nself: []\n");
  }

  std::vector<std::string> own_links() const {
    std::vector<std::string> names;
    for (const Node& shape : shapes_)
      if (const Node* link = shape.find("link")) names.push_back(link->scalar);
    return names;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    const Node* urdf = root_.find("urdf");
    config::fail(urdf != nullptr ? urdf->mark : root_.mark, "urdf", why);
  }

  std::string collision(const std::vector<LinkFit>& links) const {
    std::string text = "shapes:\n";
    for (const Node& shape : shapes_) text += "  - " + config::to_flow_yaml(shape) + "\n";
    std::set<std::string> names;
    for (const LinkFit& fit : links) {
      names.insert(fit.link);
      for (const Placed& placed : fit.kept) text += shape_line(fit.link, placed);
      for (const Placed& placed : fit.fitted) text += shape_line(fit.link, placed);
    }
    text += "self: " + (self_.kind == Node::Kind::kNull ? "auto" : self_text(self_, names)) + "\n";
    if (stop_.kind != Node::Kind::kNull) text += "self_stop: " + config::to_flow_yaml(stop_) + "\n";
    return text;
  }

  config::LoadedRobot with(const std::string& collision) const {
    Node root = root_;
    Node block = config::parse_yaml(collision, "the fitted collision block");
    if (Node* old = root.find("collision"))
      *old = std::move(block);
    else
      root.entries.emplace_back("collision", std::move(block));
    return config::read_robot(root, "");
  }

 private:
  Node root_;
  std::vector<Node> shapes_;
  Node self_;
  Node stop_;
};

}  // namespace

RobotFit fit_robot(const fs::path& robot_file, const FitOptions& options, const FitProgress& progress) {
  RobotFit result;
  const Source source(robot_file);
  std::vector<UrdfCollision> geometry = config::load_urdf_collision(robot_file);
  const auto model = source.before(robot_file, !geometry.empty()).model;
  result.before = self_contact(*model);
  result.of_visuals = geometry.empty();
  if (geometry.empty()) geometry = config::load_urdf_collision(robot_file, config::UrdfPart::kVisual);
  if (geometry.empty())
    source.refuse("the URDF has no collision geometry that shapes could be fitted to, and no visual one");

  const std::vector<std::string> own = source.own_links();
  std::vector<std::pair<std::string, std::vector<const UrdfCollision*>>> links;
  for (const UrdfCollision& element : geometry) {
    if (std::find(own.begin(), own.end(), element.link) != own.end()) {
      if (result.own.empty() || result.own.back() != element.link) result.own.push_back(element.link);
      continue;
    }
    if (links.empty() || links.back().first != element.link) links.push_back({element.link, {}});
    links.back().second.push_back(&element);
  }
  if (links.empty())
    source.refuse("every link with collision geometry in the URDF has shapes under collision.shapes: nothing to fit");
  for (const auto& [link, elements] : links) {
    if (progress) progress(link, result.links.size() + 1, links.size());
    FitOptions of_link = options;
    if (model->mobile() && !config::can_move_against(*model, 0, model->find_link(link)))
      of_link.kinds.box_weight = kBaseBoxWeight;
    result.links.push_back(fit_link(link, elements, of_link, result.links));
  }

  result.collision = source.collision(result.links);
  config::LoadedRobot after = source.with(result.collision);
  result.after = self_contact(*after.model);
  result.notes = std::move(after.notes);
  result.warnings = std::move(after.warnings);
  return result;
}

std::string kinds_text(const std::map<ShapeKind, int>& count) {
  return joined(count, [](const auto& of) {
    const auto [kind, n] = of;
    return n == 1 ? std::string(to_string(kind))
                  : fmt::format("{} {}{}", n, to_string(kind), kind == ShapeKind::kBox ? "es" : "s");
  });
}

}  // namespace moma::fit
