#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "controller/config/json_node.h"
#include "controller/config/reader.h"
#include "controller/config/text_file.h"
#include "world/scenario/moveit.h"

namespace moma::foreign {
namespace {

class MoveItText {
 public:
  explicit MoveItText(const fs::path& file) : file_(file.string()), text_(config::read_text_file(file)) {}

  Json scene() {
    next("the scene's name");
    Json scene = {{"collision_objects", Json::array()}};
    if (line_ != "(noname)+" && line_ != "(noname)") scene["name"] = line_;
    for (next(kObject); line_ != "."; next(kObject)) scene["collision_objects"].push_back(object());
    return scene;
  }

 private:
  static constexpr const char* kObject = "* OBJECT, or .";
  static constexpr const char* kCount = "the number of shapes";
  static constexpr const char* kShape = "box, sphere, cylinder, cone, plane or mesh";

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

  /// The present line.
  std::vector<double> values(const std::string& what) const {
    std::vector<double> values;
    config::Node word;
    word.kind = config::Node::Kind::kScalar;
    word.mark = {file_, number_, 1};
    std::istringstream in(line_);
    while (in >> word.scalar) values.push_back(config::read_number(word, what));
    return values;
  }

  std::vector<double> numbers(std::size_t count, const std::string& what) {
    next(what);
    std::vector<double> numbers = values(what);
    if (numbers.size() != count) wrong(fmt::format("{}: {} numbers", what, count));
    return numbers;
  }

  int whole(double value) const {
    if (!(value >= 0.0 && value <= 1e6 && value == std::floor(value))) wrong("a whole number");
    return static_cast<int>(value);
  }

  Json pose(const std::vector<double>& position) {
    const std::vector<double> q = numbers(4, "a quaternion");
    if (!(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) > 1e-6)) wrong("a quaternion that is not zero");
    return {{"position", position}, {"orientation", q}};
  }

  Json object() {
    if (line_.size() < 3 || line_[0] != '*') wrong(kObject);
    Json object = {{"id", line_.substr(line_.find_first_not_of(" \t", 1))}};
    next("the number of shapes, or the object's position");
    std::vector<double> count = values(kCount);
    const bool placed = count.size() == 3;  // since MoveIt 1.1 an object has a pose and subframes of its own
    if (placed) {
      object["pose"] = pose(count);
      count = numbers(1, kCount);
    }
    if (count.size() != 1) wrong(kCount);
    for (int left = whole(count[0]); left > 0; --left) add_shape(object);
    if (!placed) return object;
    for (int left = whole(numbers(1, "the number of subframes")[0]); left > 0; --left) {
      next("a subframe's name");
      pose(numbers(3, "a position"));
    }
    return object;
  }

  void add_shape(Json& object) {
    next(kShape);
    const std::string type = line_;
    const bool plane = type == "plane", mesh = type == "mesh";
    Json shape;
    if (plane) {
      shape["coef"] = numbers(4, "a, b, c, d");
    } else if (mesh) {
      shape = mesh_shape();
    } else {
      shape["type"] = type;
      shape["dimensions"] = dimensions(type);
    }
    object[plane ? "planes" : mesh ? "meshes" : "primitives"].push_back(shape);
    object[plane ? "plane_poses" : mesh ? "mesh_poses" : "primitive_poses"].push_back(pose(numbers(3, "a position")));
    numbers(4, "a colour");
  }

  /// The message has a cylinder's height before its radius, the text has it after.
  std::vector<double> dimensions(const std::string& type) {
    std::vector<double> sizes;
    if (type == "box") {
      sizes = numbers(3, "three edges");
    } else if (type == "sphere") {
      sizes = numbers(1, "a radius");
    } else if (type == "cylinder" || type == "cone") {
      sizes = numbers(2, "radius and length");
      std::swap(sizes[0], sizes[1]);
    } else {
      wrong(kShape);
    }
    if (!(*std::min_element(sizes.begin(), sizes.end()) > 0.0)) wrong("sizes above 0");
    return sizes;
  }

  Json mesh_shape() {
    const std::vector<double> counts = numbers(2, "numbers of vertices and triangles");
    const int vertices = whole(counts[0]);
    Json mesh = {{"vertices", Json::array()}, {"triangles", Json::array()}};
    for (int left = vertices; left > 0; --left) mesh["vertices"].push_back(numbers(3, "a vertex"));
    for (int left = whole(counts[1]); left > 0; --left)
      mesh["triangles"].push_back({{"vertex_indices", numbers(3, "a triangle")}});
    return mesh;
  }

  std::string file_;
  std::istringstream text_;
  std::string line_;
  int number_ = 0;
};

}  // namespace

config::Node read_moveit_text(const fs::path& file) {
  return config::node_from_json(MoveItText(file).scene(), file.string());
}

}  // namespace moma::foreign
