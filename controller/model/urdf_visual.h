#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/model/urdf.h"

namespace moma {

/// One <visual> of a URDF: the look of a link or a part of it.
struct UrdfVisual {
  std::string link;
  UrdfGeometry geometry;
  std::optional<Vector3> colour;  ///< red, green, blue, each from 0 to 1; empty if the URDF has none
};

/// Returns the visual elements of a URDF, links in the order of read_urdf(). A material by name has the colour of the
/// first one of that name. Reads leniently: an invalid visual is left out, with its link's colours. Throws UrdfError if
/// read_urdf() does so leniently.
std::vector<UrdfVisual> read_urdf_visuals(const std::string& text);

}  // namespace moma
