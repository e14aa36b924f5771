#include "controller/model/collada_geometry.h"

#include <tinyxml.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

namespace moma {
namespace {

constexpr std::string_view kSpaces = " \t\r\n";

/// Digits only, few enough for a long.
std::optional<long> whole_number(std::string_view word) {
  if (word.empty() || word.size() > 15) return {};
  long value = 0;
  for (const char c : word) {
    if (c < '0' || c > '9') return {};
    value = 10 * value + (c - '0');
  }
  return value;
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
    while (true) {
      left.remove_prefix(std::min(left.find_first_not_of(kSpaces), left.size()));
      if (left.empty()) break;
      std::string_view word = left.substr(0, left.find_first_of(kSpaces));
      left.remove_prefix(word.size());
      const bool negative = word.front() == '-';
      if (negative) word.remove_prefix(1);
      const std::optional<long> number = whole_number(word);
      if (!number) return {};
      numbers.push_back(negative ? -*number : *number);
    }
  }
  return numbers;
}

class Geometries {
 public:
  explicit Geometries(std::size_t bytes) : bytes_(bytes) {}

  std::string fault_of(const TiXmlElement& element) {
    walk(element);
    return fault_;
  }

 private:
  void refuse(const TiXmlElement& element, const std::string& why) {
    if (fault_.empty()) fault_ = "line " + std::to_string(element.Row()) + ": <" + element.ValueStr() + "> " + why;
  }

  void walk(const TiXmlElement& element) {
    for (const TiXmlElement* child = element.FirstChildElement(); child != nullptr && fault_.empty();
         child = child->NextSiblingElement()) {
      check_counts(*child);
      const std::string_view name = child->ValueStr();
      if (name == "skin" || name == "morph" || name == "animation")
        refuse(*child, "deforms or moves the mesh, which a link does not");
      if (name == "accessor") check_accessor(*child);
      if (name == "mesh") check_mesh(*child);
      walk(*child);
    }
  }

  void check_counts(const TiXmlElement& element) {
    for (const char* name : {"count", "offset", "stride", "set"}) {
      const char* text = element.Attribute(name);
      if (text == nullptr) continue;
      const std::optional<long> number = whole_number(text);
      if (!number) return refuse(element, std::string("has a '") + name + "' that is no whole number from 0");
      if (static_cast<std::size_t>(*number) > bytes_)
        return refuse(element, std::string("has a '") + name + "' of more than the file can hold");
    }
  }

  static long number(const TiXmlElement& element, const char* name, long otherwise) {
    const char* text = element.Attribute(name);
    return text == nullptr ? otherwise : whole_number(text).value_or(otherwise);
  }

  void check_accessor(const TiXmlElement& accessor) {
    long parameters = 0;
    for (const TiXmlElement* p = accessor.FirstChildElement("param"); p != nullptr; p = p->NextSiblingElement("param"))
      ++parameters;
    const long stride = number(accessor, "stride", 1);
    if (stride < 1 || parameters > stride)
      refuse(accessor, "has more parameters (" + std::to_string(parameters) + ") than its stride of " +
                           std::to_string(stride) + " leaves room for");
  }

  void check_mesh(const TiXmlElement& mesh) {
    bool positions = false;
    for (const TiXmlElement* v = mesh.FirstChildElement("vertices"); v != nullptr;
         v = v->NextSiblingElement("vertices"))
      positions = positions || find_input(*v, "POSITION") != nullptr;
    for (const TiXmlElement* part = mesh.FirstChildElement(); part != nullptr && fault_.empty();
         part = part->NextSiblingElement()) {
      const std::string_view name = part->ValueStr();
      const bool one_each = name == "polygons" || name == "trifans";  // each <p> is one polygon
      if (!one_each && name != "triangles" && name != "lines" && name != "linestrips" && name != "polylist" &&
          name != "tristrips")
        continue;
      if (!positions) return refuse(mesh, "has no <vertices> with an input POSITION");
      check_primitives(*part, one_each);
    }
  }

  static const TiXmlElement* find_input(const TiXmlElement& element, const char* semantic) {
    for (const TiXmlElement* in = element.FirstChildElement("input"); in != nullptr;
         in = in->NextSiblingElement("input"))
      if (const char* text = in->Attribute("semantic"); text != nullptr && std::strcmp(text, semantic) == 0) return in;
    return nullptr;
  }

  void check_primitives(const TiXmlElement& part, bool one_each) {
    const TiXmlElement* vertex = find_input(part, "VERTEX");
    if (vertex == nullptr) return refuse(part, "has no input VERTEX");
    const long first = number(*vertex, "offset", 0);
    long inputs = 1;
    for (const TiXmlElement* in = part.FirstChildElement("input"); in != nullptr; in = in->NextSiblingElement("input"))
      inputs = std::max(inputs, number(*in, "offset", 0) + 1);
    for (const TiXmlElement* list = part.FirstChildElement(); list != nullptr; list = list->NextSiblingElement()) {
      const bool indices = list->ValueStr() == "p";
      if (!indices && list->ValueStr() != "vcount") continue;
      const std::optional<std::vector<long>> numbers = whole_numbers(*list);
      if (!numbers) return refuse(*list, "is no list of whole numbers");
      const auto n = static_cast<long>(numbers->size());
      if (indices && n % inputs != 0)
        return refuse(*list, "has " + std::to_string(n) + " indices, no multiple of the " + std::to_string(inputs) +
                                 " of each corner");
      // Exporters write -1 for a normal or a colour that is none; a corner has a place.
      for (long i = first; indices && i < n; i += inputs)
        if (const long v = (*numbers)[static_cast<std::size_t>(i)]; v < 0)
          return refuse(*list, "has a corner at the vertex " + std::to_string(v) + "; the first one is 0");
      const bool large = indices
                             ? one_each && n / inputs > kMaxPolygon
                             : std::any_of(numbers->begin(), numbers->end(), [](long v) { return v > kMaxPolygon; });
      if (large) return refuse(*list, "is of a polygon with more than " + std::to_string(kMaxPolygon) + " corners");
    }
  }

  std::size_t bytes_;
  std::string fault_;
};

}  // namespace

std::string geometry_fault(const TiXmlElement& root, std::size_t bytes) { return Geometries(bytes).fault_of(root); }

}  // namespace moma
