#include "controller/config/object_file.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "controller/config/convex_hull.h"

namespace moma::config {
namespace {

/// The numbers of a list, or of the lists in a list.
std::vector<double> flat(MapReader& in, std::string_view name, const Range& range = {}) {
  const std::string key = in.key_of(name);
  const Node& node = in.require(name, "a list of [x, y, z] or [i, j, k]");
  if (node.kind != Node::Kind::kSequence || node.items.empty() || node.items[0].kind != Node::Kind::kSequence)
    return read_numbers(node, key, -1, range);
  std::vector<double> all;
  for (const Node& item : node.items)
    for (const double number : read_numbers(item, key, 3, range)) all.push_back(number);
  return all;
}

std::shared_ptr<const ConvexHull> read_hull(MapReader& in) {
  auto hull = std::make_shared<ConvexHull>();
  const std::vector<double> v = flat(in, "vertices");
  in.check(v.size() >= 12 && v.size() % 3 == 0, "vertices", "expected x, y, z of four points or more");
  for (std::size_t i = 0; i < v.size(); i += 3) hull->vertices.emplace_back(v[i], v[i + 1], v[i + 2]);
  if (in.get("triangles") == nullptr) {
    std::optional<ConvexHull> found = convex_hull(hull->vertices);
    in.check(found.has_value(), "vertices",
             "expected points that are not all in one plane, and at most 255 faces at each corner of their hull");
    return std::make_shared<ConvexHull>(*std::move(found));
  }
  const std::vector<double> t = flat(in, "triangles", {0.0, static_cast<double>(v.size() / 3) - 1.0});
  in.check(t.size() >= 12 && t.size() % 3 == 0, "triangles",
           "expected three indices for each of four triangles or more");
  for (std::size_t i = 0; i < t.size(); i += 3)
    hull->triangles.emplace_back(static_cast<int>(t[i]), static_cast<int>(t[i + 1]), static_cast<int>(t[i + 2]));
  return hull;
}

}  // namespace

Shape read_shape(MapReader& in, std::span<const ShapeKind> allowed, const char* word) {
  static constexpr const char* kSizes[] = {"the radius", "3 numbers, full edge lengths", "2 numbers, radius and length",
                                           "2 numbers, radius and length without caps"};
  Shape shape;
  in.require(word, "sphere, box, cylinder, capsule or convex");
  in.read_enum<ShapeKind>(word, shape.kind, allowed);
  if (shape.kind == ShapeKind::kConvex) {
    const Node* size = in.get("size");
    in.check(size == nullptr || (size->kind == Node::Kind::kSequence && size->items.empty()), "size",
             "a convex shape has vertices in its place");
    shape.hull = read_hull(in);
    return shape;
  }
  const auto count = static_cast<std::size_t>(num_sizes(shape.kind));
  const char* wanted = kSizes[static_cast<int>(shape.kind)];
  const Node& size = in.require("size", wanted);
  const bool list = size.kind == Node::Kind::kSequence;
  if (list ? size.items.size() != count : shape.kind != ShapeKind::kSphere)
    in.fail_at("size",
               "found " + found_text(size) + "; a " + std::string(to_string(shape.kind)) + " has the size: " + wanted);
  for (std::size_t i = 0; i < count; ++i) {
    // A capsule of length 0 is a sphere, which is harmless.
    const bool cap = shape.kind == ShapeKind::kCapsule && i == 1;
    shape.size[static_cast<Eigen::Index>(i)] =
        read_number(list ? size.items[i] : size, in.key_of("size") + (list ? "[" + std::to_string(i) + "]" : ""),
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
  std::vector<ObjectShape> objects;
  for_items(list, key, "a list of objects", [&](const Node& item, const std::string& at) {
    MapReader in(item, at);
    ObjectShape object;
    in.read("name", object.name);
    const bool former = in.get("kind") != nullptr && in.get("shape") == nullptr;
    object.shape = read_shape(in, {}, former ? "kind" : "shape");
    for (const char* known :
         {"position", "quaternion", "rotation", "velocity", "twist", "motion", "vertices", "triangles"})
      in.get(known);
    in.finish();
    objects.push_back(std::move(object));
  });
  return objects;
}

}  // namespace moma::config
