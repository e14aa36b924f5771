#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "controller/case/case_file.h"
#include "controller/case/solve.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"

namespace moma::cli {

void add_solve(CLI::App& app, Action& action) {
  struct Options {
    std::string file;
    bool explain = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("solve", "One control step: every matrix of the QP and its solution, as JSON");
  command->add_option("CASE", options->file, "Case file (JSON); its format is in docs/controller.md")->required();
  command->add_flag("--explain", options->explain, "In words: what holds the command, why it is infeasible");
  command->footer("An infeasible problem is an answer, not an error.\nExample: moma solve tests/data/cases/frankie.json");
  command->callback([&action, options] {
    action = [options] {
      const ControlCase control_case = read_case(options->file);
      print_warnings(control_case.warnings);
      if (options->explain) {
        std::cout << explain(control_case);
      } else {
        std::cout << solve(control_case).dump(1) << '\n';
      }
      return static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
