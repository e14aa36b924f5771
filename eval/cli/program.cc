#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <iostream>
#include <new>
#include <system_error>

#include "controller/config/node.h"
#include "eval/cli/command.h"
#include "eval/cli/table.h"
#include "eval/run/listener.h"
#include "eval/store/error.h"
#include "eval/store/machine.h"
#include "eval/store/query.h"
#include "files/output_file.h"
#include "reports/render/report.h"
#include "world/scenario/worlds.h"

namespace moma::cli {
namespace {

using store::StoreError;

/// A store opened under the number of a closed stderr would get the messages.
void open_standard_streams() {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) (void)open("/dev/null", O_RDWR);  // takes the lowest number
  }
}

/// Heads under which the help lists the commands; a command of none stands under the last.
constexpr std::pair<std::string_view, const char*> kGroups[] = {
    {" init run reproduce tune risk break ", "Evaluate"},
    {" query report open view replay shrink compare ", "Look at results"},
    {" verify merge ", "Keep results"},
    {" check robot world import identify solve keys ", "Make suites, robots and controllers"},
    {"", "Help"}};

void add_all(CLI::App& app, Commands& commands) {
  for (const AddCommand add : all_commands()) add(commands);
  for (CLI::App* command : app.get_subcommands(nullptr)) {
    command->allow_extras();  // reported by us, with a suggestion
    command->group(std::find_if(std::begin(kGroups), std::end(kGroups) - 1, [&](const auto& group) {
                     return group.first.find(" " + command->get_name() + " ") != std::string_view::npos;
                   })->second);
  }
}

void check_extras(const CLI::App& command) {
  std::vector<std::string> extras = command.remaining();
  std::erase(extras, "--");  // CLI11 keeps what ends the options among what it does not know
  if (extras.empty()) return;
  const std::string& extra = extras.front();
  if (extra.size() < 2 || extra[0] != '-')
    throw UsageError(fmt::format("{0}: one argument too many: '{1}'; see moma {0} --help", command.get_name(),
                                 terminal_safe(extra)));
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  const std::string given = extra.substr(0, extra.find('='));
  throw UsageError(fmt::format("{0}: unknown option {1}{2}; see moma {0} --help", command.get_name(),
                               terminal_safe(given), config::suggestion(given, names)));
}

int complain(const std::string& message, int code) {
  std::cout.flush();
  std::cerr << "moma: " << terminal_safe_lines(message) << std::endl;
  return code;
}

/// True for errors of the input and of the system (files, threads). Any other error is the program's own.
template <class... Errors>
bool is_any(const std::exception& error) {
  return ((dynamic_cast<const Errors*>(&error) != nullptr) || ...);
}

int exit_code(StoreError::Kind kind) {
  switch (kind) {
    case StoreError::Kind::kInterrupted:
      return kStoppedEarly;
    case StoreError::Kind::kContradiction:
      return kCheckFailed;
    case StoreError::Kind::kUnusable:
    case StoreError::Kind::kNotFound:
      return kBadInput;
  }
  return kInternalError;
}

int parse_and_run(const Arguments& arguments) {
  CLI::App app{"Monte Carlo evaluation of reactive QP controllers for mobile manipulators", "moma"};
  app.footer(
      "Each command has its own help with an example: moma help run, or moma run --help\n"
      "Exit codes: 0 done, 1 a check failed, 2 bad input, 3 stopped early with its work saved.");
  app.set_version_flag("-V,--version", store::version_text());
  app.require_subcommand(0, 1);
  app.failure_message(CLI::FailureMessage::simple);
  Commands commands(app, arguments);
  add_all(app, commands);
  // CLI11 would only say that a command is missing.
  if (arguments.size() > 1 && !arguments[1].empty() && arguments[1][0] != '-') (void)find_command(app, arguments[1]);
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend() - 1);
    app.parse(std::move(reversed));
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    const auto chosen = app.get_subcommands();
    const std::string name = chosen.empty() ? "" : chosen.front()->get_name() + ": ";
    const std::string help = chosen.empty() ? "moma --help" : "moma " + chosen.front()->get_name() + " --help";
    throw UsageError(fmt::format("{}{}; see {}", name, error.what(), help));
  }
  if (app.get_subcommands().empty()) {  // moma alone
    std::cout << app.help();
    return kOk;
  }
  const CLI::App& command = *app.get_subcommands().front();
  check_extras(command);
  const int code = commands.run(command);
  std::cout.flush();
  if (!std::cout) return complain("the output could not be written (is the disk full?)", kBadInput);
  return code;
}

}  // namespace

CLI::App& find_command(const CLI::App& app, const std::string& name) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  if (std::ranges::find(names, name) == names.end())
    throw UsageError(fmt::format("unknown command '{}'{}; the commands are {}", terminal_safe(name),
                                 config::suggestion(name, names), fmt::join(names, ", ")));
  return *app.get_subcommand(name);
}

int run_program(const Arguments& arguments) {
  open_standard_streams();
  try {
    return parse_and_run(arguments);
  } catch (const StoreError& error) {
    return complain(error.what(), exit_code(error.kind()));
  } catch (const std::bad_alloc&) {
    return complain("out of memory", kBadInput);
  } catch (const std::exception& error) {
    if (is_any<UsageError, run::RunError, config::ConfigError, store::QueryError, GenerationError, files::OutputError,
               reports::ReportError, std::system_error>(error))
      return complain(error.what(), kBadInput);
    return complain(fmt::format("internal error: {}", error.what()), kInternalError);
  }
}

}  // namespace moma::cli
