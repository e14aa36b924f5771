#pragma once

#include <string>

namespace moma {

/// Why a COLLADA file (.dae) must not be given to a reader that follows it blindly, or "": no XML, elements nested more
/// than kMaxXmlDepth deep, nodes that contain themselves or more than 100,000 others through `instance_node`, polygons
/// of more than kMaxPolygon corners.
std::string collada_fault(const std::string& text);

/// Corners of one polygon of a mesh: cutting one into triangles takes the square of their number.
inline constexpr int kMaxPolygon = 1000;

}  // namespace moma
