#pragma once

#include <string>

namespace moma {

/// Largest number of corners of a mesh's polygon: triangulation takes the square of it.
inline constexpr int kMaxPolygon = 1000;

/// Checks the text of a COLLADA file (.dae), and returns the length of its unit, `<asset><unit meter="...">` [m]; 1 by
/// default. Throws std::runtime_error with the reason to keep the file from a reader without checks of its own: no XML,
/// elements nested more than kMaxXmlDepth deep, nodes that contain themselves or more than 100,000 others through
/// `instance_node`, polygons of more than kMaxPolygon corners, a unit that is no length, indices or counts on which a
/// reader never ends or reads beyond the data (COLLADA 1.4.1, section 5).
double collada_unit(const std::string& text);

}  // namespace moma
