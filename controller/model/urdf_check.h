#pragma once

#include <string>
#include <vector>

class TiXmlElement;

namespace moma {

/// Takes out of a <robot> element what bears on links and joints and is not understood: unknown or repeated elements,
/// unknown attributes, numbers that are none, sizes out of range, geometry that is missing or of an unknown kind. A
/// collision element or an <inertial> with such a fault goes as a whole, and nothing else with it; urdfdom would drop
/// them without an error, and a link's shapes together with its mass. Simulators' extensions (robots.md lists
/// them) are left aside in silence. Returns one sentence for each fault: "line 7: link arm, collision 2, geometry:
/// ...". Joints' own numbers are left to urdfdom, which refuses the whole file for them.
std::vector<std::string> take_out_misunderstood(TiXmlElement& robot);

}  // namespace moma
