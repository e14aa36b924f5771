#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace moma::cli {

/// The manual page moma(1) in the macros of man(7): the help of every command.
std::string manual_page(const CLI::App& app);

/// docs/reference/commands.md: the same in Markdown.
std::string commands_page(const CLI::App& app);

}  // namespace moma::cli
