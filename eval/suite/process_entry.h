#pragma once

#include <string_view>

#include "eval/suite/controller_entry.h"

namespace moma {

/// Whether this is an entry's `method`.
bool has_method(const config::Node& node, std::string_view wanted);

/// Whether an entry says `method: process` or `method: python`.
bool is_process(const config::Node& node);

/// Reads such an entry, starts a process and lets it check its parameters:
///   {method: process, command: [PROGRAM, ARGUMENT...], directory: FOLDER, files: [...], parameters: {...}}
///   {method: python, path: FILE.py, class: NAME, python: python3, files: [...], parameters: {...}}
/// and the keys of ProcessLimits. Paths are relative to the file that names them. `digest`, which only resolved suites
/// have, must be that of the files and arguments, and is compared before anything is started.
SuiteController read_process(const config::Node& node, const std::string& key,
                             std::shared_ptr<const config::LoadedRobot> robot, double control_period, Plugins plugins);

}  // namespace moma
