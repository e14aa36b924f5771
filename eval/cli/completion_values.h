#pragma once

#include <map>
#include <string>

#include "eval/cli/completion.h"

namespace moma::cli {

/// What is known of a command line where a value is wanted.
struct CompletionContext {
  const CLI::App& app;
  std::map<std::string, std::string> positionals;  ///< by name: {"SUITE", "demo.yaml"}
  std::string partial;                             ///< of the value
};

/// Adds what `option` accepts and begins with context.partial. Throws what reading a suite or a store throws.
void add_values(const CLI::Option& option, const CompletionContext& context, Completion& completion);

/// Adds the names of the commands.
void add_command_names(const CompletionContext& context, Completion& completion);

/// The names of the options and positionals that have values of a kind of their own: "set", "TRIAL".
std::vector<std::string> options_with_own_values();

}  // namespace moma::cli
