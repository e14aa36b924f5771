#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/fit/measure.h"
#include "controller/fit/partition.h"

namespace moma::fit {

/// A link that gets its shapes from its collision geometry in the URDF.
struct LinkFit {
  std::string link;
  std::string had;             ///< "link0.stl (200 triangles)", "cylinder", "4 boxes", ...
  Triangles surface;           ///< meshes and cylinders in the link's frame; empty where there were none
  std::vector<Placed> kept;    ///< the URDF's own spheres and boxes
  std::vector<Placed> fitted;  ///< around `surface`
  FitError error;              ///< of `fitted`
  std::string like;            ///< an earlier link with the same surface, whose fit this is; empty where it is its own
};

/// What a robot's shapes make of its self-collision.
struct SelfContact {
  std::size_t shapes = 0;
  std::size_t pairs = 0;                                      ///< that are checked
  std::vector<std::pair<std::string, std::string>> touching;  ///< links in touch at `ready`, adjacent ones left out
};

struct RobotFit {
  std::vector<LinkFit> links;    ///< in the order of the URDF
  std::vector<std::string> own;  ///< links that the file gives shapes: these stay as they are
  bool of_visuals = false;       ///< the URDF has no collision geometry: shapes are around what links look like
  std::string collision;         ///< the keys of the new `collision`, YAML in block style
  SelfContact before;            ///< as the file has it
  SelfContact after;
  std::vector<std::string> notes;  ///< of the robot as it is after
  std::vector<std::string> warnings;
};

/// What fit_robot() says as it goes: which link comes next, and of how many.
using FitProgress = std::function<void(const std::string& link, std::size_t number, std::size_t links)>;

/// Fits the collision geometry that the URDF of a robot file gives to links without shapes in the file, or the visual
/// one where it gives none to any link. The file may have no `collision` yet. Spheres and boxes are kept; the meshes
/// and cylinders of a link are fitted together, see fit_surfaces(). A cylinder counts as the prism of 96 sides around
/// it, which is 0.05 % wider. Links whose geometry is the same, as of two arms that are built alike, are fitted once.
/// The result has been read back as a robot file's `collision`. Deterministic. Throws config::ConfigError: what
/// load_robot() refuses, a mesh that cannot be read, nothing to fit.
RobotFit fit_robot(const std::filesystem::path& robot_file, const FitOptions& options,
                   const FitProgress& progress = {});

}  // namespace moma::fit
