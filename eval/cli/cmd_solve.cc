#include <fmt/format.h>

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
  bool solvers = false;
  double ahead = 0.0;
};

ControlCase case_of(const SolveOptions& options) {
  if (options.trial.empty()) return read_case(options.file);
  run::StoredSuites suites;
  return run::stored_case(suites, options.file, run::named_trial(options.file, options.trial), options.step);
}

int solve_case(const SolveOptions& options) {
  if (options.solvers) {
    for (const SolverInfo& solver : list_solvers())
      fmt::print("{:<12}{:<14}{}\n", solver.name, solver.available ? "available" : "not built in", solver.description);
    return kOk;
  }
  if (options.file.empty()) throw UsageError("solve: CASE is required; see moma solve --help");
  const ControlCase control_case = case_of(options);
  if (options.explain && options.ahead <= 0.0) {
    std::cout << explain(control_case);  // the warnings are part of the explanation
    return kOk;
  }
  print_warnings(control_case.warnings);
  std::cout << (options.ahead > 0.0 ? forecast(control_case, options.ahead) : layout(solve(control_case)));
  return kOk;
}

}  // namespace

void add_solve(Commands& commands) {
  auto [command, options] = commands.add<SolveOptions>(
      "solve", "One control step: every matrix of the QP and its solution, as JSON", &solve_case);
  command.add_option("CASE", options.file,
                     "Case file (JSON; its format is in docs/explanation/controller.md), or a store");
  CLI::Option* trial =
      command.add_option("TRIAL", options.trial, "Of a store: the trial, any unique beginning of it, or POINT/WORLD");
  command.add_option("--step", options.step, "Of a stored trial: which control step, from 0")
      ->needs(trial)
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_flag("--explain", options.explain, "In words: what holds the command, why it is infeasible");
  command
      .add_option("--ahead", options.ahead, "In words: what the robot will do in so many seconds, and why it will stop")
      ->check(CLI::Range(1e-3, 3600.0));
  command.add_flag("--solvers", options.solvers, "Lists the QP solvers by name, and which of them are built in");
  command.footer(
      "An infeasible problem is an answer, not an error.\n"
      "Examples: moma solve tests/data/qp_cases/cases/frankie_119.json --explain\n"
      "          moma solve results/demo.db 3f9a12 --step 120 --explain");
}

}  // namespace moma::cli
