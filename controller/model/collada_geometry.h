#pragma once

#include <cstddef>
#include <string>

class TiXmlElement;

namespace moma {

/// Why the geometries of a COLLADA document must not be given to a reader that follows their numbers blindly (never
/// ends on an index that is no number, reads beyond the data that an index or a stride leads out of), or "". `bytes`:
/// length of the document, of which anything that is counted takes at least one. COLLADA 1.4.1, section 5.
std::string geometry_fault(const TiXmlElement& root, std::size_t bytes);

/// Corners of one polygon of a mesh: cutting one into triangles takes the square of their number.
inline constexpr int kMaxPolygon = 1000;

}  // namespace moma
