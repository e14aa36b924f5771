#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/paths.h"
#include "controller/fit/partition.h"
#include "controller/fit/placed.h"

namespace moma::fit {

/// A link whose shapes are fitted to its collision geometry in the URDF.
struct LinkFit {
  std::string link;
  std::string had;                  ///< "link0.stl (200 triangles)", "cylinder", "4 boxes", ...
  std::vector<Triangles> surfaces;  ///< of each mesh and cylinder, in the link's frame
  double box_weight = kBoxWeight;   ///< with which shapes were fitted
  std::vector<Placed> kept;         ///< the URDF's own spheres and boxes
  std::vector<Placed> fitted;       ///< shapes around `surfaces`
  FitError error;                   ///< of `fitted`
  std::string like;  ///< an earlier link with the same surfaces and weight, whose fit is reused; "" without one
};

struct SelfContact {
  std::size_t shapes = 0;
  std::size_t pairs = 0;                                      ///< number of checked pairs
  std::vector<std::pair<std::string, std::string>> touching;  ///< links in contact at `ready`, without adjacent ones
};

struct RobotFit {
  std::vector<LinkFit> links;    ///< in the order of the URDF
  std::vector<std::string> own;  ///< links with shapes in the file, which stay
  bool of_visuals = false;       ///< the URDF has no collision geometry: the shapes enclose visuals
  std::string collision;         ///< the keys of the new `collision`, YAML in block style
  SelfContact before;            ///< with the file's shapes
  SelfContact after;
  std::vector<std::string> notes;  ///< notes on the robot after the fit
  std::vector<std::string> warnings;
};

/// Progress of fit_robot(): the next link, its number and the number of links.
using FitProgress = std::function<void(const std::string& link, std::size_t number, std::size_t links)>;

/// Fits shapes to a URDF's collision geometry, for links without shapes in the robot file; to its visuals if it has no
/// collision geometry at all. Spheres and boxes stay; the meshes and cylinders of a link are fitted together
/// (fit_surfaces()), cylinders as the prisms of 96 sides around them, which are 0.05 % wider. Links of the same
/// geometry are fitted once. The result is read back as a robot file's `collision`. Deterministic. Throws
/// config::ConfigError for a file that load_robot() refuses (one without `collision` is accepted), an unreadable mesh,
/// or nothing to fit.
RobotFit fit_robot(const fs::path& robot_file, const FitOptions& options, const FitProgress& progress = {});

/// "capsule, 2 boxes".
std::string kinds_text(const std::map<ShapeKind, int>& count);

}  // namespace moma::fit
