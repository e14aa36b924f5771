#include "world/scenario/moveit_text.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "controller/config/reader.h"
#include "controller/config/text_file.h"

namespace moma {
namespace {

using config::Node;

void put(Node& map, const std::string& key, Node value) { map.entries.emplace_back(key, std::move(value)); }

class MoveItText {
 public:
  explicit MoveItText(const std::filesystem::path& file) : file_(file.string()), text_(config::read_text_file(file)) {}

  Node scene() {
    next("the scene's name");
    Node scene = node(Node::Kind::kMap);
    if (line_ != "(noname)+" && line_ != "(noname)") put(scene, "name", word(line_));
    Node objects = node(Node::Kind::kSequence);
    for (next(kObject); line_ != "."; next(kObject)) objects.items.push_back(object());
    put(scene, "collision_objects", std::move(objects));
    return scene;
  }

 private:
  static constexpr const char* kObject = "* OBJECT, or .";

  void next(const std::string& what) {
    while (std::getline(text_, line_)) {
      ++number_;
      const std::size_t first = line_.find_first_not_of(" \t\r");
      if (first == std::string::npos) continue;
      line_ = line_.substr(first, line_.find_last_not_of(" \t\r") + 1 - first);
      return;
    }
    config::fail({file_, number_, 1}, "", "ends where " + what + " is expected");
  }

  [[noreturn]] void wrong(const std::string& what) const {
    config::fail({file_, number_, 1}, "", "found '" + line_ + "', expected " + what);
  }

  Node node(Node::Kind kind) const {
    Node node;
    node.kind = kind;
    node.mark = {file_, number_, 1};
    return node;
  }

  Node word(const std::string& text) const {
    Node word = node(Node::Kind::kScalar);
    word.scalar = text;
    word.quoted = true;
    return word;
  }

  /// The present line as a list of numbers.
  Node list() const {
    Node list = node(Node::Kind::kSequence);
    std::istringstream in(line_);
    for (std::string text; in >> text;) {
      list.items.push_back(node(Node::Kind::kScalar));
      list.items.back().scalar = text;
    }
    return list;
  }

  Node numbers(std::size_t count, const std::string& what) {
    next(what);
    Node numbers = list();
    if (numbers.items.size() != count) wrong(fmt::format("{}: {} numbers", what, count));
    return numbers;
  }

  Node pose(Node position) {
    Node pose = node(Node::Kind::kMap);
    put(pose, "position", std::move(position));
    put(pose, "orientation", numbers(4, "a quaternion"));
    return pose;
  }

  int whole(const Node& number, const std::string& what) const {
    const double value = config::read_number(number, what);
    if (!(value >= 0.0 && value <= 1e6 && value == std::floor(value))) wrong("a whole number");
    return static_cast<int>(value);
  }

  Node object() {
    if (line_.size() < 3 || line_[0] != '*') wrong(kObject);
    Node object = node(Node::Kind::kMap);
    put(object, "id", word(line_.substr(line_.find_first_not_of(" \t", 1))));
    next("the number of shapes, or the object's position");
    const bool placed = list().items.size() == 3;  // since MoveIt 1.1 an object has a pose and subframes of its own
    if (placed) {
      put(object, "pose", pose(list()));
      next("the number of shapes");
    }
    const Node count = list();
    if (count.items.size() != 1) wrong("the number of shapes");
    Shapes shapes{node(Node::Kind::kSequence), node(Node::Kind::kSequence)};
    Shapes primitives = shapes, planes = shapes, meshes = shapes;
    for (int left = whole(count.items[0], "the number of shapes"); left > 0; --left) {
      next("box, sphere, cylinder, cone, plane or mesh");
      Node shape = node(Node::Kind::kMap);
      Shapes* of = &primitives;
      if (line_ == "plane") {
        of = &planes;
        put(shape, "coef", numbers(4, "a, b, c, d"));
      } else if (line_ == "mesh") {
        of = &meshes;
        put(shape, "vertices", vertices());
      } else {
        put(shape, "type", word(line_));
        put(shape, "dimensions", dimensions());
      }
      of->shapes.items.push_back(std::move(shape));
      of->poses.items.push_back(pose(numbers(3, "a position")));
      numbers(4, "a colour");
    }
    put(object, "primitives", std::move(primitives.shapes));
    put(object, "primitive_poses", std::move(primitives.poses));
    put(object, "planes", std::move(planes.shapes));
    put(object, "plane_poses", std::move(planes.poses));
    put(object, "meshes", std::move(meshes.shapes));
    put(object, "mesh_poses", std::move(meshes.poses));
    if (placed) subframes();
    return object;
  }

  /// The message has a cylinder's height before its radius, the text has it after.
  Node dimensions() {
    if (line_ == "box") return numbers(3, "three edges");
    if (line_ == "sphere") return numbers(1, "a radius");
    if (line_ != "cylinder" && line_ != "cone") wrong("box, sphere, cylinder, cone, plane or mesh");
    Node radius_and_length = numbers(2, "radius and length");
    std::swap(radius_and_length.items[0], radius_and_length.items[1]);
    return radius_and_length;
  }

  Node vertices() {
    const Node counts = numbers(2, "numbers of vertices and triangles");
    const int triangles = whole(counts.items[1], "triangles");
    Node vertices = node(Node::Kind::kSequence);
    for (int left = whole(counts.items[0], "vertices"); left > 0; --left)
      vertices.items.push_back(numbers(3, "a vertex"));
    for (int left = triangles; left > 0; --left) numbers(3, "a triangle");
    return vertices;
  }

  void subframes() {
    const Node count = numbers(1, "the number of subframes");
    for (int left = whole(count.items[0], "the number of subframes"); left > 0; --left) {
      next("a subframe's name");
      pose(numbers(3, "a position"));
    }
  }

  struct Shapes {
    Node shapes, poses;
  };

  std::string file_;
  std::istringstream text_;
  std::string line_;
  int number_ = 0;
};

}  // namespace

Node read_moveit_text(const std::filesystem::path& file) { return MoveItText(file).scene(); }

}  // namespace moma
