#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/table.h"
#include "eval/run/replay.h"
#include "eval/store/columns.h"
#include "eval/trial/spec_file.h"
#include "eval/trial/trial.h"
#include "world/scenario/worlds.h"
#include "world/sensing/disturbances_file.h"

namespace moma::cli {
namespace {

using nlohmann::ordered_json;

ordered_json list(const Eigen::Ref<const VectorX>& v) {
  ordered_json json = ordered_json::array();
  for (const double value : v) json.push_back(value);
  return json;
}

ordered_json number(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

ordered_json to_json(const Sample& s) {
  return {{"t", s.t},
          {"base", list(s.base)},
          {"q", list(s.q)},
          {"qdot", list(s.qdot)},
          {"command", list(s.command)},
          {"error", list(s.error)},
          {"slack", list(s.slack)},
          {"manipulability", number(s.manipulability)},
          {"least_distance", number(s.least_distance)},
          {"status", std::string(to_string(s.status))},
          {"fallback", std::string(to_string(s.fallback))}};
}

ordered_json trace_json(const store::StoredTrial& trial, const Point& point, const TrialOutput& output) {
  ordered_json samples = ordered_json::array();
  for (const Sample& sample : output.trace) samples.push_back(to_json(sample));
  ordered_json json = {
      {"trial", trial.key.substr(0, 16)},        {"outcome", std::string(to_string(output.row.outcome))},
      {"robot", point.robot->resolved},          {"success", to_json(point.success)},
      {"stuck", to_json(point.stuck)},           {"infeasible", to_json(point.infeasible)},
      {"controller", point.controller_resolved}, {"world", ordered_json::parse(trial.world)},
      {"simulation", to_json(point.simulation)}};
  if (any(point.disturbances)) json["disturbances"] = to_json(point.disturbances);
  json["samples"] = std::move(samples);
  return json;
}

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

}  // namespace

void add_replay(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
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
      run::StoredSuites suites;
      const run::Replay replay = run::replay(options->file, options->trial, suites);
      if (options->json) {
        std::cout << trace_json(replay.trial, *replay.point, replay.output)
                         .dump(-1, ' ', false, ordered_json::error_handler_t::replace)
                  << '\n';
      } else {
        print_row(replay.trial, replay.output.row);
      }
      std::cout.flush();
      return options->check ? compare(replay) : static_cast<int>(kOk);
    };
  });
}

}  // namespace moma::cli
