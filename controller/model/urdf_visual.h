#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/model/urdf.h"

namespace moma {

/// What a link looks like, or a part of it: one <visual> of a URDF.
struct UrdfVisual {
  std::string link;
  UrdfGeometry geometry;
  std::optional<Vector3> colour;  ///< red, green, blue, each from 0 to 1; empty where the URDF names none
};

/// The visual elements of a URDF, links in the order of read_urdf(). A material that is named only has the colour of
/// the first one of its name. Read leniently: a visual that is not understood is left out, and its link's colours with
/// it. Throws UrdfError: what read_urdf() refuses then.
std::vector<UrdfVisual> read_urdf_visuals(const std::string& text);

}  // namespace moma
