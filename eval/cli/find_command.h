#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace moma::cli {

/// The names of all commands, in the order of the help.
std::vector<std::string> command_names(const CLI::App& app);

/// The command of this name. Throws UsageError, which names the nearest one and all.
CLI::App& find_command(const CLI::App& app, const std::string& name);

}  // namespace moma::cli
