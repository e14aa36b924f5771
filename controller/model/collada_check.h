#pragma once

#include <string>

namespace moma {

struct ColladaCheck {
  /// Why the file must not be given to a reader that follows it blindly, or "": no XML, elements nested more than
  /// kMaxXmlDepth deep, nodes that contain themselves or more than 100,000 others through `instance_node`, polygons of
  /// more than kMaxPolygon corners, a unit that is no length, indices or counts that a reader must not follow
  /// (collada_geometry.h).
  std::string fault;
  double unit = 1.0;  ///< length of the file's unit, `<asset><unit meter="...">` [m]; 1 where it names none
};

/// Of a COLLADA file's (.dae) text.
ColladaCheck check_collada(const std::string& text);

}  // namespace moma
