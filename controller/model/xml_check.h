#pragma once

#include <string>
#include <string_view>
#include <vector>

class TiXmlElement;

// Checks of XML, URDF and COLLADA before readers without checks of their own get them (docs/adr/0011).
namespace moma {

/// Largest nesting depth of XML elements: parsers recurse, so deeper files are refused before parsing.
inline constexpr int kMaxXmlDepth = 200;
/// Largest number of corners of a mesh's polygon: triangulation takes the square of it.
inline constexpr int kMaxPolygon = 1000;

/// Greatest depth of elements; for malformed text at least the depth that a parser reaches before its error.
int xml_depth(const std::string& text);

/// The child elements of a TiXmlElement, all or those of one name; they may be removed while the list is gone through.
template <class Element>
std::vector<Element*> children(Element& parent, const char* name = nullptr) {
  std::vector<Element*> all;
  for (Element* child = name != nullptr ? parent.FirstChildElement(name) : parent.FirstChildElement(); child != nullptr;
       child = name != nullptr ? child->NextSiblingElement(name) : child->NextSiblingElement())
    all.push_back(child);
  return all;
}

/// Takes the next word off a text of words between blanks; empty at its end.
std::string_view next_word(std::string_view& text);

/// Checks the text of a COLLADA file (.dae), and returns the length of its unit, `<asset><unit meter="...">` [m]; 1 by
/// default. Throws std::runtime_error with the reason: no XML, elements nested more than kMaxXmlDepth deep, nodes that
/// contain themselves or more than 100,000 others through `instance_node`, polygons of more than kMaxPolygon corners, a
/// unit that is no length, indices or counts on which a reader never ends or reads beyond the data (COLLADA 1.4.1,
/// section 5).
double collada_unit(const std::string& text);

/// Removes invalid parts of a <robot> element that concern links and joints: unknown or repeated elements, unknown
/// attributes, invalid numbers, sizes out of range, missing or unknown geometry. A collision element or an <inertial>
/// with such a fault is removed as a whole, and nothing else. Simulators' extensions (robots.md lists them) are
/// ignored. Returns one sentence per fault: "line 7: link arm, collision 2, geometry: ...". Invalid numbers of joints
/// are left to urdfdom, which refuses the whole file.
std::vector<std::string> remove_invalid_parts(TiXmlElement& robot);

}  // namespace moma
