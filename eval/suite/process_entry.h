#pragma once

#include <string_view>

#include "eval/suite/controller_entry.h"

namespace moma {

bool has_method(const config::Node& node, std::string_view wanted);

bool is_process(const config::Node& node);

/// Reads such an entry, starts a process and lets it check its parameters:
///   {method: process, command: [PROGRAM, ARGUMENT...], directory: FOLDER, files: [...], parameters: {...}}
///   {method: python, path: FILE.py, class: NAME, python: python3, files: [...], parameters: {...}}
/// and the keys of ProcessLimits. Paths are relative to the file that names them. `digest`, which only resolved suites
/// have, must equal that of files and arguments; the comparison precedes the start.
SuiteController read_process(const config::Node& node, const std::string& key,
                             std::shared_ptr<const config::LoadedRobot> robot, double control_period, Plugins plugins);

}  // namespace moma
