#include "eval/suite/controller_entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "controller/config/controller_file.h"
#include "controller/config/json_node.h"
#include "controller/config/read_described.h"
#include "controller/config/reader.h"
#include "controller/config/write_described.h"
#include "eval/trial/key.h"
#include "plugin/host/library.h"
#include "plugin/process/command.h"
#include "plugin/process/process_plugin.h"

namespace moma {

using config::Node;

Json paths_of(const Plugin& plugin, const Json& controller_resolved) {
  const ProcessPool* processes = processes_of(plugin);
  if (processes == nullptr) return {{"path", plugin.library().file.string()}};
  const ProcessCommand& command = processes->command();
  std::map<fs::path, std::string> files = processes->files();
  Json paths = Json::object();
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
  Json rest = Json::array();
  for (const auto& [file, digest] : files) rest.push_back(file.string());
  if (!rest.empty()) paths["files"] = std::move(rest);
  return paths;
}

void anchor_paths(Node& entry, const Plugin& plugin, const Json& controller_resolved) {
  const Node paths = config::node_from_json(paths_of(plugin, controller_resolved), entry.mark.file);
  for (const auto& [key, value] : paths.entries) {
    Node* there = entry.find(key);
    if (there == nullptr) there = &entry.entries.emplace_back(key, Node()).second;
    *there = value;
  }
}

namespace {

using config::MapReader;

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

/// Throws PluginError unless `found` is what was wanted.
void check_digest(const std::string& found, const std::string& wanted) {
  if (found == wanted) return;
  throw PluginError(
      fmt::format("is not that of these trials: its digest is {}, theirs {}. The same sources and compiler give the "
                  "same digest; run the suite again to compute new trials",
                  found, wanted));
}

/// An entry during its conversion to a Plugin.
struct Entry {
  bool python = false;
  ProcessCommand command;
  std::string class_name;
  const Node* named = nullptr;  ///< the node that names the program: `path` or `command`
  std::string key;              ///< key of that node
  std::string name;             ///< its text
};

fs::path whole_path(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path.empty() ? "." : path, error);  // for an option: the working folder
  return (error ? path : whole).lexically_normal();
}

fs::path folder_of(const Node& node) { return whole_path(config::directory_of(node.mark)); }

std::vector<std::string> read_words(const Node& node, const std::string& key) {
  if (node.kind == Node::Kind::kScalar) return {config::read_string(node, key)};
  constexpr std::string_view kWords = "a list of words, for instance [./mine, --fast]";
  std::vector<std::string> words;
  config::for_items(node, key, kWords, [&words](const Node& item, const std::string& at) {
    words.push_back(config::read_string(item, at));
  });
  if (words.empty())
    config::fail(node.mark, key, fmt::format("found {}, expected {}", config::found_text(node), kWords));
  return words;
}

void read_python_keys(MapReader& in, Entry& entry) {
  const Node& path = in.require("path", "the Python file with the controller, for instance mine.py");
  entry.named = &path;
  entry.key = in.key_of("path");
  entry.name = config::read_string(path, entry.key);
  const Node& name = in.require("class", "the name of the file's class, for instance Mine");
  entry.class_name = config::read_string(name, in.key_of("class"));
  std::string interpreter = "python3";
  if (const Node* python = in.get("python")) {
    interpreter = config::read_string(*python, in.key_of("python"));
    // Does not follow links: the place of its link identifies a virtual environment.
    if (interpreter.find('/') != std::string::npos) interpreter = (folder_of(*python) / interpreter).lexically_normal();
  }
  entry.command = python_command(interpreter, (folder_of(path) / entry.name).lexically_normal(), entry.class_name);
}

void read_process_keys(MapReader& in, Entry& entry) {
  const Node& command = in.require("command", "the program and its arguments, for instance [./mine, --fast]");
  entry.named = &command;
  entry.key = in.key_of("command");
  entry.command.arguments = read_words(command, entry.key);
  entry.name = fmt::format("{}", fmt::join(entry.command.arguments, " "));
  entry.command.directory = folder_of(command);
  if (const Node* directory = in.get("directory")) {
    const std::string key = in.key_of("directory");
    entry.command.directory = (folder_of(*directory) / config::read_string(*directory, key)).lexically_normal();
    std::error_code error;
    if (!fs::is_directory(entry.command.directory, error))
      config::fail(directory->mark, key, fmt::format("found '{}', which is no folder", directory->scalar));
  }
}

/// Returns the file that an argument names; empty if it names none. A program without '/' comes from PATH.
fs::path file_of(const ProcessCommand& command, std::size_t argument) {
  const std::string& word = command.arguments[argument];
  if (word.empty() || (argument == 0 && word.find('/') == std::string::npos)) return {};
  const fs::path file = (command.directory / word).lexically_normal();
  std::error_code error;
  return argument == 0 || fs::is_regular_file(file, error) ? file : fs::path();
}

/// Digest of the program independent of its place: the contents of its files, and the arguments that name no file.
std::string digest_of(const Entry& entry, std::map<fs::path, std::string> files) {
  Json parts = Json::array();
  const auto take = [&](const fs::path& file) {
    const auto found = files.find(file);
    if (found != files.end()) parts.push_back({{"file", found->second}});
    return found;
  };
  if (entry.python) {
    const auto found = take(entry.command.files.front());
    if (found != files.end()) files.erase(found);
  } else {
    std::vector<fs::path> named;
    for (std::size_t i = 0; i < entry.command.arguments.size(); ++i) {
      const fs::path file = file_of(entry.command, i);
      if (file.empty() || take(file) == files.end())
        parts.push_back(entry.command.arguments[i]);
      else
        named.push_back(file);
    }
    for (const fs::path& file : named) files.erase(file);
  }
  std::vector<std::string> others;
  for (const auto& [file, digest] : files) others.push_back(digest);
  std::ranges::sort(others);
  return canonical_digest({{"parts", std::move(parts)}, {"files", std::move(others)}});
}

std::map<fs::path, std::string> digests(const std::vector<fs::path>& files) {
  std::map<fs::path, std::string> all;
  for (const fs::path& file : files) all[file] = plugin_digest(file);
  return all;
}

bool has_method(const Node& node, std::string_view wanted) {
  const Node* method = node.find("method");
  return method != nullptr && method->kind == Node::Kind::kScalar && method->scalar == wanted;
}

bool is_process(const Node& node) { return has_method(node, "process") || has_method(node, "python"); }

SuiteController read_process(const Node& node, const std::string& key, std::shared_ptr<const config::LoadedRobot> robot,
                             double control_period, Plugins plugins) {
  MapReader in(node, key);
  in.get("method");
  Entry entry;
  entry.python = has_method(node, "python");
  entry.python ? read_python_keys(in, entry) : read_process_keys(in, entry);
  std::string digest;
  in.read("digest", digest);
  config::read_members(in, entry.command.limits);
  bool absolute = entry.python
                      ? fs::path(entry.name).is_absolute()
                      : node.find("directory") != nullptr && fs::path(node.find("directory")->scalar).is_absolute();
  if (!entry.python) {
    for (std::size_t i = 0; i < entry.command.arguments.size(); ++i)
      if (fs::path file = file_of(entry.command, i); !file.empty()) entry.command.files.push_back(std::move(file));
  }
  if (const Node* files = in.get("files")) {
    for (const std::string& name : read_words(*files, in.key_of("files"))) {
      absolute = absolute && fs::path(name).is_absolute();
      entry.command.files.push_back((folder_of(*files) / name).lexically_normal());
    }
  }
  const Node* given = in.get("parameters");
  if (given != nullptr && given->kind != Node::Kind::kMap)
    in.fail_at("parameters", "expected a map; it is passed to the controller unchanged");
  in.finish();
  check_stored({entry.named->mark, entry.key, entry.name, digest, absolute}, plugins);

  const Json parameters = given != nullptr ? config::node_to_json(*given) : Json::object();
  SuiteController out;
  config::as_object(out.resolved)["method"] = entry.python ? "python" : "process";
  try {
    const std::map<fs::path, std::string> named = digests(entry.command.files);
    if (!digest.empty()) check_digest(digest_of(entry, named), digest);
    out.plugin = open_process(entry.command, std::move(robot), parameters, control_period);
    out.resolved["digest"] = digest_of(entry, processes_of(*out.plugin)->files());
    if (!digest.empty()) check_digest(out.resolved["digest"], digest);
  } catch (const PluginError& error) {
    config::fail(entry.named->mark, entry.key, fmt::format("{}: {}", entry.name, error.what()));
  }
  if (entry.python) out.resolved["class"] = entry.class_name;
  config::write_members(entry.command.limits, out.resolved);
  out.resolved["parameters"] = parameters;
  return out;
}

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
  const Json parameters = given != nullptr ? config::node_to_json(*given) : Json::object();
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

Json stored_controller(const TrialSpec& spec) {
  Json json = spec.controller_resolved;
  if (spec.plugin != nullptr) json.update(paths_of(*spec.plugin, spec.controller_resolved));
  return json;
}

}  // namespace moma
