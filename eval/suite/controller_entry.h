#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/config/node.h"
#include "controller/config/robot_file.h"
#include "controller/params.h"
#include "eval/suite/suite.h"
#include "plugin/host/plugin.h"

namespace moma {

/// A plugin that was not loaded, because loading was not allowed.
class PluginRefused : public config::ConfigError {
 public:
  using config::ConfigError::ConfigError;
};

/// One entry of a suite's `controllers`: parameters of moma's own methods, or a plugin.
struct SuiteController {
  ControllerParams params;
  std::shared_ptr<const Plugin> plugin;
  Json resolved;  ///< see TrialSpec::controller_resolved
};

/// Reads an entry: a map, or the path of a controller file. In addition to the forms of config::read_controller():
///   {method: plugin, path: LIBRARY.so, parameters: {...}}
///   {method: process, command: [PROGRAM, ARGUMENT...], directory: FOLDER, files: [...], parameters: {...}}
///   {method: python, path: FILE.py, class: NAME, python: python3, files: [...], parameters: {...}}
/// the last two with the keys of ProcessLimits. Paths are relative to the file that names them. `digest`, which only
/// resolved suites have, must equal the library's, or that of files and arguments; the comparison precedes loading.
/// Loads the library, or starts a process, and lets it check its parameters. Throws config::ConfigError, PluginRefused.
SuiteController read_suite_controller(const config::Node& node, const std::string& key,
                                      std::shared_ptr<const config::LoadedRobot> robot, double control_period,
                                      std::vector<std::string>& warnings, Plugins plugins = Plugins::kOfSuite);

void set_controller(TrialSpec& spec, const SuiteController& controller);

/// Returns the input from which read_suite_controller() reads the spec's controller again: controller_resolved, and a
/// plugin's path.
Json stored_controller(const TrialSpec& spec);

/// Returns the keys that locate a controller's code, in absolute paths. They determine nothing else;
/// read_suite_controller() needs them besides the resolved controller.
Json paths_of(const Plugin& plugin, const Json& controller_resolved);

/// Replaces the paths of an entry by these, so that the entry can be written into any folder.
void anchor_paths(config::Node& entry, const Plugin& plugin, const Json& controller_resolved);

}  // namespace moma
