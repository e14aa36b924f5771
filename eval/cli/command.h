#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <memory>
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

/// The command line as given, for provenance and for "how to go on".
using Arguments = std::vector<std::string>;

/// The commands of the program `app`.
class Commands {
 public:
  Commands(CLI::App& app, const Arguments& arguments) : app_(app), arguments_(arguments) {}

  /// A command and the values of its options, both owned by Commands.
  template <class Options>
  struct Added {
    CLI::App& command;
    Options& options;
  };

  /// Adds a command. `run` gets the parsed options, whose `request` (run::Request) knows the command line, and returns
  /// the exit code.
  template <class Options>
  Added<Options> add(const char* name, const char* text, std::function<int(Options&)> run) {
    auto options = std::make_shared<Options>();
    if constexpr (requires { options->request.arguments; }) options->request.arguments = arguments_;
    CLI::App* const command = app_.add_subcommand(name, text);
    runs_[command] = [options, run] { return run(*options); };
    return {*command, *options};
  }

  /// Runs a parsed command. Returns the exit code.
  int run(const CLI::App& command) const { return runs_.at(&command)(); }
  const CLI::App& app() const { return app_; }

 private:
  CLI::App& app_;
  const Arguments& arguments_;
  std::map<const CLI::App*, std::function<int()>> runs_;
};

/// Adds a command with its options. The command NAME has the function add_NAME() of this form in a file cmd_*.cc, and
/// its place in the list of eval/cli/CMakeLists.txt.
using AddCommand = void (*)(Commands& commands);
/// All commands, in the order of the help.
std::span<const AddCommand> all_commands();

/// The command of this name. Throws UsageError, which names the nearest one and all.
CLI::App& find_command(const CLI::App& app, const std::string& name);

/// Parses and executes: the whole program but for main(). Errors go to stderr, one line or a few, no traces.
int run_program(const Arguments& arguments);

}  // namespace moma::cli
