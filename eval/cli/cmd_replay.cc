#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/stored_suites.h"
#include "eval/cli/table.h"
#include "eval/store/columns.h"
#include "eval/store/machine.h"
#include "eval/store/reader.h"
#include "eval/trial/trace_json.h"
#include "eval/trial/trial.h"

namespace moma::cli {
namespace {

void print_row(const store::StoredTrial& trial, const TrialRow& row) {
  std::cout << terminal_safe(fmt::format("trial {}: suite {}, controller {}{}, world {}", trial.key.substr(0, 16),
                                         trial.suite, trial.controller, trial.point.empty() ? "" : " at " + trial.point,
                                         trial.world_index))
            << "\n\n";
  store::QueryResult table{{"metric", "value"}, {{std::string("outcome"), std::string(to_string(row.outcome))}}};
  for (const store::TrialColumn& column : store::trial_columns()) {
    struct Visitor {
      const TrialRow& row;
      store::Cell operator()(double TrialRow::*member) const {
        return std::isfinite(row.*member) ? store::Cell{row.*member} : store::Cell{};
      }
      store::Cell operator()(int TrialRow::*member) const { return std::int64_t{row.*member}; }
      store::Cell operator()(std::string TrialRow::*member) const {
        return (row.*member).empty() ? store::Cell{} : store::Cell{row.*member};
      }
    };
    store::Cell cell = std::visit(Visitor{row}, column.member);
    if (!std::holds_alternative<std::monostate>(cell))
      table.rows.push_back({std::string(column.name), std::move(cell)});
  }
  write(std::cout, table, Format::kTable);
}

int compare(const store::StoredTrial& trial, const TrialRow& again) {
  const std::vector<std::string> found = store::differences(trial.row, again);
  if (found.empty()) {
    std::cerr << "the same, bit for bit\n";
    return kOk;
  }
  std::cerr << terminal_safe(fmt::format("trial {} differs (stored != replayed):", trial.key.substr(0, 16))) << '\n';
  for (const std::string& line : found) std::cerr << "  " << terminal_safe(line) << '\n';
  const std::string here = store::this_machine().machine_class;
  if (!trial.machine_class.empty() && trial.machine_class != here) {
    std::cerr << "it was computed on a machine of another class, where last bits may differ:\n  "
              << terminal_safe(trial.machine_class) << "\n  " << here << " (here)\n";
  }
  return kCheckFailed;
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
  struct Options {
    std::string file;
    std::string trial;
    bool json = false;
    bool check = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("replay", "Simulate a stored trial again, from the store alone");
  command->add_option("DB", options->file, "Store")->required();
  command->add_option("TRIAL", options->trial, "The trial's name, or any unique beginning of it")->required();
  command->add_flag("--json", options->json, "Print the whole trial with its samples as JSON");
  command->add_flag("--check", options->check, "Compare with the stored row, bit for bit; exit 1 where it differs");
  command->footer("Example: moma replay results/demo.db 3f9a12 --check");
  command->callback([&action, options] {
    action = [options] {
      const store::StoredTrial trial = store::Reader(options->file).trial(options->trial);
      StoredSuites suites;
      const Point& point = suites.point_of(trial);
      const World world = world_of(trial);
      const TrialOutput output = run_trial(point, world);
      if (options->json) {
        const nlohmann::ordered_json json = trace_json(point, world, output, trial.key.substr(0, 16));
        std::cout << json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
      } else {
        print_row(trial, output.row);
      }
      std::cout.flush();
      return options->check ? compare(trial, output.row) : static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
