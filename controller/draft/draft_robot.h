#pragma once

#include <string>
#include <vector>

#include "controller/config/mesh_hull.h"
#include "controller/config/paths.h"

namespace moma::draft {

struct DraftOptions {
  fs::path urdf;
  fs::path folder;       ///< folder of the file: `urdf:` is relative to it
  bool lenient = false;  ///< leave out parts of the URDF that are not understood
  /// A robot file's `collision` whose shapes will replace the URDF's: postures are searched with these. Empty: with the
  /// URDF's own. The text of the draft has the URDF's in either case.
  std::string collision = {};
  config::MeshSolids meshes = {};  ///< solids that are known from an earlier draft
};

/// The first robot file of a robot.
struct Draft {
  std::string text;                   ///< YAML; comments of doubtful lines begin with "check"
  std::vector<std::string> warnings;  ///< of the resulting robot, and that no posture is clear
  std::vector<std::string> notes;
  int checks = 0;             ///< number of doubtful lines
  config::MeshSolids meshes;  ///< solids of the URDF's meshes, for whoever reads the robot again
};

/// Proposes base, tip, limits, posture and shapes from a URDF alone (guess.h, posture.h), and checks the proposal by
/// reading it. The same file gives the same text. Takes a few seconds for large meshes. Throws config::ConfigError for
/// errors that a robot file with this URDF would have, for a URDF without a driven joint, and for xacro, with the
/// command that expands it.
Draft draft_robot(const DraftOptions& options);

/// True if a file is a URDF (or xacro) by its name or its beginning, rather than a robot file.
bool is_urdf(const fs::path& file);

}  // namespace moma::draft
