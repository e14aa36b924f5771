#pragma once

#include <map>
#include <string>

#include "controller/config/paths.h"

namespace moma::config {

/// Search path of package://NAME/...: the folders named in the robot file; MOMA_PACKAGE_PATH (folders separated by
/// colons, each holding NAME); a folder NAME beside or above the file that asks;
/// .venv/lib/python3*/site-packages/cmeel.prefix/share/NAME beside or above that file, the working directory or the
/// program.
struct PackagePaths {
  std::map<std::string, fs::path> named;  ///< folders of packages, absolute or relative to the working directory
  fs::path directory;                     ///< of the file that asks

  /// The file behind package://..., file://..., an absolute path or one relative to `directory`.
  /// Throws std::runtime_error that says where it was looked for.
  fs::path resolve(const std::string& uri) const;
};

}  // namespace moma::config
