#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <sstream>

#include "controller/case/case_file.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/identify/motion_log.h"
#include "eval/run/log_of_trial.h"
#include "eval/run/named_point.h"
#include "eval/run/replay.h"
#include "eval/store/columns.h"
#include "eval/store/reader.h"
#include "eval/trial/trial.h"
#include "eval/trial/trial_detail.h"
#include "files/output_file.h"

namespace moma::cli {
namespace {

void print_row(const store::StoredTrial& trial, const TrialRow& row) {
  std::cout << terminal_safe(fmt::format("trial {}: suite {}, controller {}{}, world {}", trial.key.substr(0, 16),
                                         trial.suite, trial.controller, trial.label.empty() ? "" : " at " + trial.label,
                                         trial.world_index))
            << "\n\n";
  store::QueryResult table{{"metric", "value"}, {{std::string("outcome"), std::string(to_string(row.outcome))}}};
  for (const store::TrialColumn& column : store::trial_columns()) {
    const std::string name(column.name);
    if (const auto* number = std::get_if<double TrialRow::*>(&column.member)) {
      if (std::isfinite(row.**number)) table.rows.push_back({name, row.**number});
    } else if (const auto* count = std::get_if<int TrialRow::*>(&column.member)) {
      table.rows.push_back({name, std::int64_t{row.**count}});
    } else if (const std::string& text = row.*std::get<std::string TrialRow::*>(column.member); !text.empty()) {
      table.rows.push_back({name, text});
    }
  }
  write(std::cout, table, Format::kTable);
}

int compare(const run::Replay& replay) {
  const store::StoredTrial& trial = replay.trial;
  const run::ReplayDifferences found = run::differences(trial.row, trial.machine_class, replay.output.row);
  if (found.lines.empty()) {
    std::cerr << "the same, bit for bit\n";
    return kOk;
  }
  std::cerr << terminal_safe(fmt::format("trial {} differs (stored != replayed):", trial.key.substr(0, 16))) << '\n';
  for (const std::string& line : found.lines) std::cerr << "  " << terminal_safe(line) << '\n';
  if (!found.stored_machine.empty()) {
    std::cerr << "it was computed on a machine of another class, where last bits may differ:\n  "
              << terminal_safe(found.stored_machine) << "\n  " << found.this_machine << " (here)\n";
  }
  return kCheckFailed;
}

struct ReplayOptions {
  std::string file;
  std::string trial;
  bool json = false;
  bool check = false;
  long step = 0;
  std::string case_file;
  std::string log_file;
  files::Replace replace = files::Replace::kOwn;
  Plugins plugins = Plugins::kRefused;
};

int replay(const ReplayOptions& options) {
  const OutputFile case_file(options.case_file, {"case", ""}, options.replace);
  const OutputFile log_file(options.log_file, {"log", ""}, options.replace);
  const std::string name = run::named_trial(options.file, options.trial);
  run::StoredSuites suites(options.plugins);
  if (case_file.wanted()) {
    case_file.write(case_to_json(run::stored_case(suites, options.file, name, options.step)).dump() + '\n');
    return kOk;
  }
  if (log_file.wanted()) {
    const store::StoredTrial trial = store::Reader(options.file).trial(name);
    const identify::MotionLog log = run::log_of_trial(suites.point_of(trial), run::world_of(trial));
    std::ostringstream text;
    identify::write_log(text, log);
    log_file.write(text.str());
    return kOk;
  }
  const run::Replay again = run::replay(options.file, name, suites);
  if (options.json) {
    print_json(trace_json(*again.point, again.world, again.output, again.trial.key.substr(0, 16)));
  } else {
    print_row(again.trial, again.output.row);
  }
  std::cout.flush();
  return options.check ? compare(again) : kOk;
}

}  // namespace

void add_replay(Commands& commands) {
  auto [command, options] =
      commands.add<ReplayOptions>("replay", "Simulate a stored trial again, from the store alone", &replay);
  add_store(command, options.file);
  add_trial(command, options.trial);
  command.add_flag("--json", options.json, "Print the whole trial with its samples as JSON");
  command.add_flag("--check", options.check, "Compare with the stored row, bit for bit; exit 1 where it differs");
  CLI::Option* step = command.add_option(
      "--case", options.case_file, "Write one control step as a case for moma solve, what is remembered included");
  command.add_option("--step", options.step, "Which one, from 0")->needs(step)->check(CLI::NonNegativeNumber);
  command.add_option("--log", options.log_file, "Write what was commanded and measured as a log for moma identify");
  add_force(command, options.replace);
  add_allow_plugins(command, options.plugins);
  command.footer(
      "Examples: moma replay results/demo.db 3f9a12 --check\n"
      "          moma replay results/gains.db @best/12      (a point as in `moma compare`, and the index of a world)");
}

}  // namespace moma::cli
