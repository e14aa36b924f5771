#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/config/node.h"
#include "controller/config/robot_file.h"
#include "controller/params.h"
#include "eval/trial/spec.h"
#include "plugin/host/plugin.h"

namespace moma {

/// Permission to load foreign code that a text names.
enum class Plugins {
  kOfSuite,  ///< a suite file of the user's: any path
  kOfStore,  ///< stored text with the user's permission: absolute path and digest only
  kRefused,  ///< stored text of unknown origin
};

/// A plugin that was not loaded, because loading was not allowed.
class PluginRefused : public config::ConfigError {
 public:
  using config::ConfigError::ConfigError;
};

/// One entry of a suite's `controllers`: parameters of moma's own methods, or a plugin.
struct SuiteController {
  ControllerParams params;
  std::shared_ptr<const Plugin> plugin;
  nlohmann::ordered_json resolved;  ///< see TrialSpec::controller_resolved
};

/// Reads an entry: a map, or the path of a controller file. In addition to the forms of config::read_controller():
///   {method: plugin, path: LIBRARY.so, parameters: {...}}
/// `path` is relative to the file that names it. `digest`, which only resolved suites have, must equal the library's;
/// the comparison precedes loading. Loads the library and lets it check its parameters. Throws config::ConfigError,
/// PluginRefused.
SuiteController read_suite_controller(const config::Node& node, const std::string& key,
                                      std::shared_ptr<const config::LoadedRobot> robot, double control_period,
                                      std::vector<std::string>& warnings, Plugins plugins = Plugins::kOfSuite);

void set_controller(TrialSpec& spec, const SuiteController& controller);

/// Returns the input from which read_suite_controller() reads the spec's controller again: controller_resolved, and a
/// plugin's path.
nlohmann::ordered_json stored_controller(const TrialSpec& spec);

/// Code that a controller's entry names, where the entry comes from a store: what was stored is a stranger's until the
/// user says otherwise.
struct StoredCode {
  config::Mark mark;   ///< where it is named, for messages
  std::string key;     ///< "controllers.mine.path"
  std::string name;    ///< as it is named
  std::string digest;  ///< that it has to have; "" where none is stated
  bool absolute = false;
};

/// Throws PluginRefused where nobody allowed it, config::ConfigError where it is not named by absolute paths and
/// digest.
void check_stored(const StoredCode& code, Plugins plugins);

/// Throws PluginError unless `found` is what was wanted.
void check_digest(const std::string& found, const std::string& wanted);

/// Returns the keys that locate a controller's code, in absolute paths. They determine nothing else;
/// read_suite_controller() needs them besides the resolved controller.
nlohmann::ordered_json paths_of(const Plugin& plugin, const nlohmann::ordered_json& controller_resolved);

/// Replaces the paths of an entry by these, so that the entry can be written into any folder.
void anchor_paths(config::Node& entry, const Plugin& plugin, const nlohmann::ordered_json& controller_resolved);

}  // namespace moma
