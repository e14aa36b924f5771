#pragma once

#include <cstddef>
#include <string>

class TiXmlElement;

namespace moma {

/// Returns the reason to keep a COLLADA document's geometries from a reader without checks of its own (which never ends
/// on an index that is no number, or reads beyond the data), or "". `bytes`: length of the document; each counted item
/// needs at least one byte. COLLADA 1.4.1, section 5.
std::string geometry_fault(const TiXmlElement& root, std::size_t bytes);

/// Largest number of corners of a mesh's polygon: triangulation takes the square of it.
inline constexpr int kMaxPolygon = 1000;

}  // namespace moma
