#include <tinyxml.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "controller/model/xml_check.h"

namespace moma {
namespace {

/// Digits alone, or after one '-' where it may be `negative`; few enough for any reader.
std::optional<long> whole_number(std::string_view word, bool negative = false) {
  long value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = error == std::errc() && stop == word.data() + word.size() && (negative || word.front() != '-') &&
                     std::abs(value) < 1'000'000'000'000'000;
  return whole ? std::optional(value) : std::nullopt;
}

/// Reads the element's text as whole numbers. Empty for anything else, or for a text in several pieces, of which
/// readers take the first.
std::optional<std::vector<long>> whole_numbers(const TiXmlElement& element) {
  std::vector<long> numbers;
  int pieces = 0;
  for (const TiXmlNode* child = element.FirstChild(); child != nullptr; child = child->NextSibling()) {
    if (child->ToText() == nullptr) continue;
    if (++pieces > 1) return {};
    std::string_view left = child->ValueStr();
    for (std::string_view word = next_word(left); !word.empty(); word = next_word(left)) {
      const std::optional<long> number = whole_number(word, true);
      if (!number) return {};
      numbers.push_back(*number);
    }
  }
  return numbers;
}

[[noreturn]] void refuse(const TiXmlElement& element, const std::string& why) {
  throw std::runtime_error("line " + std::to_string(element.Row()) + ": <" + element.ValueStr() + "> " + why);
}

void check_counts(const TiXmlElement& element, std::size_t bytes) {
  for (const char* name : {"count", "offset", "stride", "set"}) {
    const char* text = element.Attribute(name);
    if (text == nullptr) continue;
    const std::optional<long> number = whole_number(text);
    if (!number) refuse(element, std::string("has a '") + name + "' that is no whole number from 0");
    if (static_cast<std::size_t>(*number) > bytes)
      refuse(element, std::string("has a '") + name + "' of more than the file can hold");
  }
}

long number(const TiXmlElement& element, const char* name, long otherwise) {
  const char* text = element.Attribute(name);
  return text == nullptr ? otherwise : whole_number(text).value_or(otherwise);
}

void check_accessor(const TiXmlElement& accessor) {
  const auto parameters = static_cast<long>(children(accessor, "param").size());
  const long stride = number(accessor, "stride", 1);
  if (stride < 1 || parameters > stride)
    refuse(accessor, "has more parameters (" + std::to_string(parameters) + ") than its stride of " +
                         std::to_string(stride) + " leaves room for");
}

const TiXmlElement* find_input(const TiXmlElement& element, std::string_view semantic) {
  for (const TiXmlElement* in : children(element, "input"))
    if (const char* text = in->Attribute("semantic"); text != nullptr && semantic == text) return in;
  return nullptr;
}

void check_primitives(const TiXmlElement& part, bool one_each) {
  const TiXmlElement* vertex = find_input(part, "VERTEX");
  if (vertex == nullptr) refuse(part, "has no input VERTEX");
  const long first = number(*vertex, "offset", 0);
  long inputs = 1;
  for (const TiXmlElement* in : children(part, "input")) inputs = std::max(inputs, number(*in, "offset", 0) + 1);
  for (const TiXmlElement* list : children(part)) {
    const bool indices = list->ValueStr() == "p";
    if (!indices && list->ValueStr() != "vcount") continue;
    const std::optional<std::vector<long>> numbers = whole_numbers(*list);
    if (!numbers) refuse(*list, "is no list of whole numbers");
    const auto n = static_cast<long>(numbers->size());
    if (indices && n % inputs != 0)
      refuse(*list,
             "has " + std::to_string(n) + " indices, no multiple of the " + std::to_string(inputs) + " of each corner");
    // Exporters write -1 for a normal or a colour that is none; a corner has a place.
    for (long i = first; indices && i < n; i += inputs)
      if (const long v = (*numbers)[static_cast<std::size_t>(i)]; v < 0)
        refuse(*list, "has a corner at the vertex " + std::to_string(v) + "; the first one is 0");
    const bool large = indices ? one_each && n / inputs > kMaxPolygon
                               : std::any_of(numbers->begin(), numbers->end(), [](long v) { return v > kMaxPolygon; });
    if (large) refuse(*list, "is of a polygon with more than " + std::to_string(kMaxPolygon) + " corners");
  }
}

void check_mesh(const TiXmlElement& mesh) {
  const auto all = children(mesh, "vertices");
  const bool positions =
      std::any_of(all.begin(), all.end(), [](const auto* v) { return find_input(*v, "POSITION") != nullptr; });
  for (const TiXmlElement* part : children(mesh)) {
    const std::string_view name = part->ValueStr();
    const bool one_each = name == "polygons" || name == "trifans";  // each <p> is one polygon
    if (!one_each && name != "triangles" && name != "lines" && name != "linestrips" && name != "polylist" &&
        name != "tristrips")
      continue;
    if (!positions) refuse(mesh, "has no <vertices> with an input POSITION");
    check_primitives(*part, one_each);
  }
}

/// `bytes`: length of the document; each counted item needs at least one byte.
void check_geometries(const TiXmlElement& element, std::size_t bytes) {
  for (const TiXmlElement* child : children(element)) {
    check_counts(*child, bytes);
    const std::string_view name = child->ValueStr();
    if (name == "skin" || name == "morph" || name == "animation")
      refuse(*child, "deforms or moves the mesh, which a link does not");
    if (name == "accessor") check_accessor(*child);
    if (name == "mesh") check_mesh(*child);
    check_geometries(*child, bytes);
  }
}

constexpr std::size_t kMaxNodes = 100'000;

struct SceneNode {
  std::vector<int> children;           // nested nodes
  std::vector<std::string> instances;  // ids of nodes that it instantiates
  int state = 0;                       // 0 unseen, 1 open, 2 known
  int height = 0;
  std::size_t count = 0;
};

class NodeCheck {
 public:
  explicit NodeCheck(const TiXmlElement& root) {
    walk(root, -1);
    for (std::size_t i = 0; i < nodes_.size(); ++i) measure(static_cast<int>(i), 0);
  }

 private:
  SceneNode& node(int i) { return nodes_[static_cast<std::size_t>(i)]; }

  // The text is nested no deeper than kMaxXmlDepth.
  void walk(const TiXmlElement& element, int parent) {
    for (const TiXmlElement* child : children(element)) {
      const std::string_view name = child->ValueStr();
      int inside = parent;
      if (name == "node") {
        inside = static_cast<int>(nodes_.size());
        nodes_.emplace_back();
        if (parent >= 0) node(parent).children.push_back(inside);
        if (const char* id = child->Attribute("id")) by_id_[id].push_back(inside);
      } else if (name == "instance_node" && parent >= 0) {
        const char* url = child->Attribute("url");
        if (url != nullptr) node(parent).instances.emplace_back(*url == '#' ? url + 1 : url);
      }
      walk(*child, inside);
    }
  }

  void measure(int i, int depth) {
    if (node(i).state == 2) return;
    if (node(i).state == 1) throw std::runtime_error("a node contains itself (instance_node)");
    check_depth(depth);
    node(i).state = 1;
    std::vector<int> inner = node(i).children;
    for (const std::string& id : node(i).instances)
      if (const auto found = by_id_.find(id); found != by_id_.end())
        inner.insert(inner.end(), found->second.begin(), found->second.end());
    node(i).count = 1;
    for (const int child : inner) {
      measure(child, depth + 1);
      node(i).height = std::max(node(i).height, node(child).height + 1);
      node(i).count += node(child).count;
      check_depth(node(i).height);
      if (node(i).count > kMaxNodes)
        throw std::runtime_error("more than " + std::to_string(kMaxNodes) +
                                 " nodes, those of instance_node counted each time");
    }
    node(i).state = 2;
  }

  static void check_depth(int depth) {
    if (depth > kMaxXmlDepth)
      throw std::runtime_error("nodes are nested more than " + std::to_string(kMaxXmlDepth) + " deep");
  }

  std::vector<SceneNode> nodes_;
  std::map<std::string, std::vector<int>> by_id_;
};

// Reads the unit of `<asset><unit meter="...">`. No robot's units are outside of 1e-9 to 1e9 m.
double unit_of(const TiXmlElement& root) {
  const TiXmlElement* asset = root.FirstChildElement("asset");
  const TiXmlElement* unit = asset == nullptr ? nullptr : asset->FirstChildElement("unit");
  const char* const text = unit == nullptr ? nullptr : unit->Attribute("meter");
  if (text == nullptr) return 1.0;
  char* end = nullptr;
  const double length = std::strtod(text, &end);
  while (*end == ' ') ++end;
  if (end == text || *end != '\0' || !(length >= 1e-9 && length <= 1e9))
    throw std::runtime_error("<unit meter=\"" + std::string(text).substr(0, 40) + "\"> is no length");
  return length;
}

}  // namespace

double collada_unit(const std::string& text) {
  if (xml_depth(text) > kMaxXmlDepth)
    throw std::runtime_error("elements are nested more than " + std::to_string(kMaxXmlDepth) + " deep");
  TiXmlDocument document;
  document.SetTabSize(0);  // without the place of each element, which nobody asks for
  document.Parse(text.c_str());
  if (document.Error()) throw std::runtime_error("not valid XML: " + std::string(document.ErrorDesc()));
  const TiXmlElement* root = document.RootElement();
  if (root == nullptr) throw std::runtime_error("no XML element");
  const double unit = unit_of(*root);
  const NodeCheck nodes(*root);
  check_geometries(*root, text.size());
  return unit;
}

}  // namespace moma
