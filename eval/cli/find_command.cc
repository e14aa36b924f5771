#include "eval/cli/find_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "controller/config/suggestion.h"
#include "eval/cli/command.h"
#include "eval/cli/table.h"

namespace moma::cli {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

CLI::App& find_command(const CLI::App& app, const std::string& name) {
  const std::vector<std::string> names = command_names(app);
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw UsageError(fmt::format("unknown command '{}'{}; the commands are {}", terminal_safe(name),
                                 config::suggestion(name, names), fmt::join(names, ", ")));
  }
  return *app.get_subcommand(name);
}

}  // namespace moma::cli
