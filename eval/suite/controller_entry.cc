#include "eval/suite/controller_entry.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "controller/config/controller_file.h"
#include "controller/config/json_node.h"
#include "controller/config/reader.h"
#include "eval/suite/process_entry.h"
#include "plugin/host/library.h"
#include "plugin/process/process_plugin.h"

namespace moma {

using config::Node;
using nlohmann::ordered_json;

ordered_json paths_of(const Plugin& plugin, const ordered_json& controller_resolved) {
  const ProcessPool* processes = processes_of(plugin);
  if (processes == nullptr) return {{"path", plugin.library().file.string()}};
  const ProcessCommand& command = processes->command();
  std::map<std::filesystem::path, std::string> files = processes->files();
  ordered_json paths = ordered_json::object();
  if (controller_resolved.at("method") == "python") {
    paths["path"] = command.files.front().string();
    paths["python"] = command.arguments.front();
    files.erase(command.files.front());
  } else {
    paths["command"] = command.arguments;
    paths["directory"] = command.directory.string();
    for (const std::string& argument : command.arguments)
      files.erase((command.directory / argument).lexically_normal());
  }
  ordered_json rest = ordered_json::array();
  for (const auto& [file, digest] : files) rest.push_back(file.string());
  if (!rest.empty()) paths["files"] = std::move(rest);
  return paths;
}

void anchor_paths(Node& entry, const Plugin& plugin, const ordered_json& controller_resolved) {
  const Node paths = config::node_from_json(paths_of(plugin, controller_resolved), entry.mark.file);
  for (const auto& [key, value] : paths.entries) {
    Node* there = entry.find(key);
    if (there == nullptr) there = &entry.entries.emplace_back(key, Node()).second;
    *there = value;
  }
}

namespace {

namespace fs = std::filesystem;
using config::MapReader;
using config::Node;
using nlohmann::ordered_json;

bool is_plugin(const Node& node) { return has_method(node, "plugin"); }

SuiteController read_plugin(const Node& node, const std::string& key, std::shared_ptr<const config::LoadedRobot> robot,
                            double control_period, Plugins plugins) {
  MapReader in(node, key);
  in.get("method");
  const Node& path = in.require("path", "the shared library with the controller, for instance build/libmine.so");
  const std::string name = config::read_string(path, in.key_of("path"));
  std::string digest;
  in.read("digest", digest);
  const Node* given = in.get("parameters");
  if (given != nullptr && given->kind != Node::Kind::kMap)
    in.fail_at("parameters", "expected a map; it is passed to the plugin unchanged");
  in.finish();
  check_stored({path.mark, in.key_of("path"), name, digest, fs::path(name).is_absolute()}, plugins);

  SuiteController out;
  std::shared_ptr<const PluginLibrary> library;
  try {
    const fs::path file = config::directory_of(path.mark) / name;
    // Before loading, because loading runs the library's code.
    if (!digest.empty()) check_digest(plugin_digest(file), digest);
    library = load_plugin(file);
    if (!digest.empty()) check_digest(library->digest, digest);  // the file may have been replaced meanwhile
  } catch (const PluginError& error) {
    config::fail(path.mark, in.key_of("path"), fmt::format("{}: {}", name, error.what()));
  }
  const ordered_json parameters = given != nullptr ? config::node_to_json(*given) : ordered_json::object();
  out.resolved = {{"method", "plugin"}, {"digest", library->digest}, {"parameters", parameters}};
  try {
    out.plugin = Plugin::open(std::move(library), std::move(robot), parameters, control_period);
  } catch (const PluginError& error) {
    const Node& at = given != nullptr ? *given : path;
    config::fail(at.mark, in.key_of("parameters"), fmt::format("{} says: {}", name, error.what()));
  }
  return out;
}

/// True for a foreign controller: a plugin, or a process.
bool is_foreign(const Node& node) { return is_plugin(node) || is_process(node); }

SuiteController read_foreign(const Node& node, const std::string& key, std::shared_ptr<const config::LoadedRobot> robot,
                             double control_period, Plugins plugins) {
  return is_plugin(node) ? read_plugin(node, key, std::move(robot), control_period, plugins)
                         : read_process(node, key, std::move(robot), control_period, plugins);
}

}  // namespace

void check_digest(const std::string& found, const std::string& wanted) {
  if (found == wanted) return;
  throw PluginError(
      fmt::format("is not that of these trials: its digest is {}, theirs {}. The same sources and compiler give the "
                  "same digest; run the suite again to compute new trials",
                  found, wanted));
}

void check_stored(const StoredCode& code, Plugins plugins) {
  if (plugins == Plugins::kOfSuite) return;
  if (!code.absolute || code.digest.empty()) {
    config::fail(code.mark, code.key, fmt::format("'{}': stored code needs absolute paths and its digest", code.name));
  }
  if (plugins == Plugins::kRefused)
    throw PluginRefused(
        fmt::format("{}: {}: these trials were computed by the plugin {} (digest {}). Replaying them runs its code "
                    "here; if you trust the store and the plugin: --allow-plugins",
                    code.mark.file, code.key, code.name, code.digest));
}

SuiteController read_suite_controller(const Node& node, const std::string& key,
                                      std::shared_ptr<const config::LoadedRobot> robot, double control_period,
                                      std::vector<std::string>& warnings, Plugins plugins) {
  if (is_foreign(node)) return read_foreign(node, key, std::move(robot), control_period, plugins);
  if (node.kind == Node::Kind::kScalar) {
    const fs::path file = config::directory_of(node.mark) / node.scalar;
    std::error_code error;
    if (fs::is_regular_file(file, error)) {
      const Node opened = config::load_yaml(file);
      if (is_foreign(opened)) return read_foreign(opened, "", std::move(robot), control_period, plugins);
    }
  }
  SuiteController out;
  out.params = config::read_controller(node, key, *robot->model, control_period, warnings);
  out.resolved = config::to_json(out.params);
  return out;
}

void set_controller(TrialSpec& spec, const SuiteController& controller) {
  spec.controller_params = controller.params;
  spec.plugin = controller.plugin;
  spec.controller_resolved = controller.resolved;
}

ordered_json stored_controller(const TrialSpec& spec) {
  ordered_json json = spec.controller_resolved;
  if (spec.plugin != nullptr) json.update(paths_of(*spec.plugin, spec.controller_resolved));
  return json;
}

}  // namespace moma
