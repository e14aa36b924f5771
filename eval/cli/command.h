#pragma once

#include <CLI/CLI.hpp>
#include <functional>
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

// One function per command, each in its own file: adds the command with its options to `app`; when the command is
// parsed, `action` is set.
void add_run(CLI::App& app, Action& action, const Arguments& arguments);
void add_tune(CLI::App& app, Action& action, const Arguments& arguments);
void add_query(CLI::App& app, Action& action);
void add_report(CLI::App& app, Action& action);
void add_view(CLI::App& app, Action& action);
void add_replay(CLI::App& app, Action& action);
void add_verify(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_merge(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_world(CLI::App& app, Action& action);
void add_robot(CLI::App& app, Action& action);
void add_solve(CLI::App& app, Action& action);
void add_check(CLI::App& app, Action& action);

/// Parses and executes: the whole program but for main(). Errors go to stderr, one line or a few, no traces.
int run_program(const Arguments& arguments);

}  // namespace moma::cli
