#pragma once

#include <string>

namespace moma {

struct ColladaCheck {
  /// Reason to keep the file from a reader without checks of its own, or "": no XML, elements nested more than
  /// kMaxXmlDepth deep, nodes that contain themselves or more than 100,000 others through `instance_node`, polygons of
  /// more than kMaxPolygon corners, a unit that is no length, invalid indices or counts (collada_geometry.h).
  std::string fault;
  double unit = 1.0;  ///< length of the file's unit, `<asset><unit meter="...">` [m]; 1 by default
};

/// Checks the text of a COLLADA file (.dae).
ColladaCheck check_collada(const std::string& text);

}  // namespace moma
