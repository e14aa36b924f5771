#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "controller/config/node.h"
#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/tune/tuned_file.h"
#include "eval/tune/tuning.h"

namespace moma::cli {
namespace {

/// Worlds 0 .. n-1 by family.
std::string family_counts(const Suite& suite) {
  std::map<std::string, std::uint64_t> counts;
  const std::uint64_t looked_at = std::min<std::uint64_t>(suite.trials, 100000);
  for (std::uint64_t i = 0; i < looked_at; ++i) ++counts[suite.points.front().worlds.family_of(i)];
  std::string text;
  for (const auto& [family, n] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, family);
  return text;
}

int check(const SuiteOptions& options) {
  const Suite suite = options.load();
  std::set<std::string> controllers;
  std::set<std::string> labels;
  for (const Point& point : suite.points) {
    controllers.insert(point.controller);
    labels.insert(point.label);
  }
  const Point& first = suite.points.front();
  std::cout << terminal_safe(fmt::format("{}: {} trials = {} worlds x {} controller{} ({}){}", suite.name,
                                         suite.trials * suite.points.size(), suite.trials, controllers.size(),
                                         controllers.size() == 1 ? "" : "s", fmt::join(controllers, ", "),
                                         labels.size() > 1 ? fmt::format(" x {} sweep points", labels.size()) : ""))
            << '\n'
            << terminal_safe(fmt::format("robot {}, {} mode, worlds: {} (seed {})", first.robot->model->name,
                                         to_string(first.simulation.mode), family_counts(suite), first.worlds.seed()))
            << std::endl;
  // The first world shows whether this robot has a place in these worlds at all.
  (void)first.worlds.make(first.robot->model, 0);
  print_warnings(suite.warnings);
  if (config::load_yaml(options.file).find("tune") != nullptr) {
    const tune::Tuning tuning = tune::load_tuning(options.file, options.overrides());
    print_warnings(tuning.warnings);
    std::cout << tune::plan_text(tuning) << '\n';
  }
  std::cout << (suite.warnings.empty() ? "no warnings\n" : fmt::format("{} warnings\n", suite.warnings.size()));
  return kOk;
}

}  // namespace

void add_check(CLI::App& app, Action& action) {
  auto options = std::make_shared<SuiteOptions>();
  CLI::App* command = app.add_subcommand("check", "Validate a suite without running it");
  options->add_to(*command);
  command->footer("Example: moma check configs/suites/demo.yaml");
  command->callback([&action, options] { action = [options] { return check(*options); }; });
}

}  // namespace moma::cli
