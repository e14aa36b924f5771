#include <iostream>

#include "controller/case/case_file.h"
#include "controller/case/solve.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/run/named_point.h"
#include "eval/run/replay.h"

namespace moma::cli {
namespace {

struct SolveOptions {
  std::string file;
  std::string trial;
  long step = 0;
  bool explain = false;
};

ControlCase case_of(const SolveOptions& options) {
  if (options.trial.empty()) return read_case(options.file);
  run::StoredSuites suites;
  return run::stored_case(suites, options.file, run::named_trial(options.file, options.trial), options.step);
}

int solve_case(const SolveOptions& options) {
  const ControlCase control_case = case_of(options);
  if (options.explain) {
    std::cout << explain(control_case);  // the warnings are part of the explanation
    return kOk;
  }
  print_warnings(control_case.warnings);
  std::cout << layout(solve(control_case));
  return kOk;
}

}  // namespace

void add_solve(Commands& commands) {
  auto [command, options] = commands.add<SolveOptions>(
      "solve", "One control step: every matrix of the QP and its solution, as JSON", &solve_case);
  command
      .add_option("CASE", options.file, "Case file (JSON; its format is in docs/explanation/controller.md), or a store")
      ->required();
  CLI::Option* trial =
      command.add_option("TRIAL", options.trial, "Trial of the store: a unique beginning of its key, or POINT/WORLD");
  command.add_option("--step", options.step, "Control step of the trial, from 0")
      ->needs(trial)
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_flag("--explain", options.explain,
                   "Explains in words which constraints hold the command, or why the QP is infeasible");
  command.footer(
      "An infeasible problem is an answer, not an error.\n"
      "Examples: moma solve tests/data/qp_cases/cases/frankie_119.json --explain\n"
      "          moma solve results/demo.db 3f9a12 --step 120 --explain");
}

}  // namespace moma::cli
