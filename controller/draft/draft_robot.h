#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace moma::draft {

struct DraftOptions {
  std::filesystem::path urdf;
  std::filesystem::path folder;  ///< that the file is for: `urdf:` is relative to it
  bool lenient = false;          ///< what is not understood in the URDF is left out
  /// A robot file's `collision`, of shapes that will stand for the URDF's: postures are looked for with these. Empty:
  /// with the URDF's own. The text of the draft has the URDF's in either case.
  std::string collision = {};
};

/// A first robot file.
struct Draft {
  std::string text;                   ///< YAML; lines to look at have a comment that begins with "check"
  std::vector<std::string> warnings;  ///< of the robot that it makes
  std::vector<std::string> notes;
  int checks = 0;  ///< lines to look at
};

/// Proposes base, tip, limits, posture and shapes from a URDF alone (base_guess.h, arm_guess.h, posture.h), and has
/// read back what it proposes. The same file gives the same text. A few seconds for large meshes. Throws
/// config::ConfigError: what a robot file over this URDF would be refused for, a URDF without a joint to drive, and
/// xacro, with the command that expands it.
Draft draft_robot(const DraftOptions& options);

/// Whether a file is a URDF (or xacro) by its name or its beginning, rather than a robot file.
bool is_urdf(const std::filesystem::path& file);

}  // namespace moma::draft
