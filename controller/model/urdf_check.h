#pragma once

#include <string>
#include <vector>

class TiXmlElement;

namespace moma {

/// Removes invalid parts of a <robot> element that concern links and joints: unknown or repeated elements, unknown
/// attributes, invalid numbers, sizes out of range, missing geometry or geometry of an unknown kind. A collision
/// element or an <inertial> with such a fault is removed as a whole, and nothing else; urdfdom would drop them without
/// an error, and a link's shapes together with its mass. Simulators' extensions (robots.md lists them) are ignored.
/// Returns one sentence per fault: "line 7: link arm, collision 2, geometry: ...". urdfdom refuses the whole file for
/// invalid numbers of joints.
std::vector<std::string> take_out_misunderstood(TiXmlElement& robot);

}  // namespace moma
