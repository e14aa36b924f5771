#include "controller/config/object_file.h"

#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace moma::config {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<Node>& rows(MapReader& in, std::string_view name, std::string_view what, std::size_t least) {
  const Node& node = in.require(name, what);
  if (node.kind != Node::Kind::kSequence || node.items.size() < least)
    fail(node.mark, in.key_of(name), "found " + found_text(node) + ", expected " + std::string(what));
  return node.items;
}

std::shared_ptr<const ConvexHull> read_hull(MapReader& in) {
  auto hull = std::make_shared<ConvexHull>();
  for (const Node& item : rows(in, "vertices", "a list of four points [x, y, z] or more", 4)) {
    const std::vector<double> v = read_numbers(item, in.key_of("vertices"), 3);
    hull->vertices.emplace_back(v[0], v[1], v[2]);
  }
  const Range index{0.0, static_cast<double>(hull->vertices.size() - 1)};
  for (const Node& item : rows(in, "triangles", "a list of four triangles of three indices or more", 4)) {
    const std::vector<double> t = read_numbers(item, in.key_of("triangles"), 3, index);
    hull->triangles.emplace_back(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
  }
  return hull;
}

}  // namespace

Shape read_shape(MapReader& in, const char* word) {
  Shape shape;
  in.require(word, "sphere, box, cylinder, capsule or convex");
  in.read_enum<ShapeKind>(word, shape.kind);
  if (shape.kind == ShapeKind::kConvex) {
    in.get("size");  // nothing
    shape.hull = read_hull(in);
    return shape;
  }
  const Node& size = in.require("size", "the shape's size in metres");
  const int count = num_sizes(shape.kind);
  if (size.kind != Node::Kind::kSequence || static_cast<int>(size.items.size()) != count) {
    static constexpr const char* kWanted[] = {"[radius]", "[x, y, z], full edge lengths", "[radius, length]",
                                              "[radius, length without caps]"};
    in.fail_at("size", "found " + found_text(size) + "; a " + std::string(to_string(shape.kind)) + " has the size " +
                           kWanted[static_cast<int>(shape.kind)]);
  }
  for (int i = 0; i < count; ++i) {
    // A capsule of length 0 is a sphere, which is harmless.
    const bool cap = shape.kind == ShapeKind::kCapsule && i == 1;
    shape.size[i] =
        read_number(size.items[static_cast<std::size_t>(i)], in.key_of("size") + "[" + std::to_string(i) + "]",
                    cap ? Range::non_negative() : Range::positive());
  }
  return shape;
}

void write_shape(const Shape& shape, Json& json) {
  json["shape"] = to_string(shape.kind);
  json["size"] = std::vector<double>(shape.size.begin(), shape.size.begin() + num_sizes(shape.kind));
  if (shape.hull == nullptr) return;
  const auto list = [](const auto& rows) {
    Json out = Json::array();
    for (const auto& row : rows) out.push_back({row[0], row[1], row[2]});
    return out;
  };
  json["vertices"] = list(shape.hull->vertices);
  json["triangles"] = list(shape.hull->triangles);
}

Json objects_to_json(std::span<const ObjectShape> objects) {
  Json list = Json::array();
  for (const ObjectShape& object : objects) {
    Json json = {{"name", object.name}, {"kind", to_string(object.shape.kind)}};
    json["vertices"] = json["triangles"] = Json::array();
    write_shape(object.shape, json);
    list.push_back(std::move(json));
  }
  return list;
}

std::vector<ObjectShape> read_objects(const Node& list, const std::string& key) {
  if (list.kind != Node::Kind::kSequence)
    fail(list.mark, key, "found " + found_text(list) + ", expected a list of objects");
  std::vector<ObjectShape> objects;
  for (const Node& item : list.items) {
    MapReader in(item, key + "[" + std::to_string(objects.size()) + "]");
    ObjectShape object;
    in.read("name", object.name);
    const bool former = in.get("kind") != nullptr && in.get("shape") == nullptr;
    object.shape = read_shape(in, former ? "kind" : "shape");
    for (const char* known :
         {"position", "quaternion", "rotation", "velocity", "twist", "motion", "vertices", "triangles"})
      in.get(known);
    in.finish();
    objects.push_back(std::move(object));
  }
  return objects;
}

}  // namespace moma::config
