#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/find_command.h"
#include "eval/cli/manual.h"

namespace moma::cli {

void add_help(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  struct Options {
    std::string command;
    bool man = false;
    bool reference = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("help", "Explain a command: its options, with an example");
  CLI::Option* name = command->add_option("COMMAND", options->command, "Which one; all in a list without it");
  CLI::Option* man = command->add_flag("--man", options->man, "The manual page, for man(1)")->excludes(name);
  command->add_flag("--reference", options->reference, "The page docs/reference/commands.md")
      ->excludes(name)
      ->excludes(man);
  command->footer("Example: moma help run");
  command->callback([&app, &action, options] {
    action = [&app, options] {
      if (options->man) {
        std::cout << manual_page(app);
      } else if (options->reference) {
        std::cout << commands_page(app);
      } else if (options->command.empty()) {
        // app.help() would be that of the command that was parsed: of this one.
        std::cout << app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal);
      } else {
        std::cout << find_command(app, options->command).help(app.get_name());
      }
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
