#include "eval/suite/controller_paths.h"

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "controller/config/json_node.h"
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

}  // namespace moma
