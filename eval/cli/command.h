#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace moma::cli {

/// Exit codes of every command.
enum ExitCode { kOk = 0, kCheckFailed = 1, kBadInput = 2, kStoppedEarly = 3, kInternalError = 70 };

/// Options or arguments that do not fit together; what() is complete, for a person.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What the parsed command line asks for; returns the exit code. Set by the chosen command.
using Action = std::function<int()>;

/// The command line as given, for provenance and for "how to go on".
using Arguments = std::vector<std::string>;

/// Adds a command with its options to `app`; when the command is parsed, `action` is set. The command NAME has the
/// function add_NAME() of this form in a file cmd_*.cc, and its place in the list of eval/cli/CMakeLists.txt.
using AddCommand = void (*)(CLI::App& app, Action& action, const Arguments& arguments);
/// All commands, in the order of the help.
std::span<const AddCommand> commands();

/// The command of this name. Throws UsageError, which names the nearest one and all.
CLI::App& find_command(const CLI::App& app, const std::string& name);

/// Parses and executes: the whole program but for main(). Errors go to stderr, one line or a few, no traces.
int run_program(const Arguments& arguments);

}  // namespace moma::cli
