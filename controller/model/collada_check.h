#pragma once

#include <string>

namespace moma {

/// Why a COLLADA file (.dae) must not be given to a reader that follows it blindly, or "": no XML, elements nested more
/// than kMaxXmlDepth deep, nodes that contain themselves or more than 100,000 others through `instance_node`, polygons
/// of more than kMaxPolygon corners, a unit that is no length, indices or counts that a reader must not follow
/// (collada_geometry.h).
std::string collada_fault(const std::string& text);

/// Length of the file's unit, `<asset><unit meter="...">` [m]; 1 where it names none. Of a file without a fault.
double collada_unit(const std::string& text);

}  // namespace moma
