#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/progress.h"
#include "eval/cli/rare_options.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/risk.h"

namespace moma::cli {
namespace {

using store::Cell;

struct RiskOptions {
  SuiteOptions suite;
  run::RiskRequest request;
  std::string event = "collision";
  Format format = Format::kTable;
  bool price = false;
  bool quiet = false;
};

store::QueryResult table(const run::Risk& risk) {
  store::QueryResult out{{"controller", "family", "p", "low", "high", "trials", "crude", "crude low", "crude high",
                          "crude trials", "spread/ideal", "died out", "ancestors", "ties"},
                         {}};
  for (const run::RiskRow& row : risk.rows) {
    const auto known = [&](double value) { return row.refused() ? Cell{} : Cell{value}; };
    const risk::Estimate& e = row.estimate;
    const auto count = [](std::size_t n) { return static_cast<std::int64_t>(n); };
    out.rows.push_back({row.label.empty() ? row.controller : row.controller + ":" + row.label, row.family, known(e.p),
                        known(e.interval.low), known(e.interval.high), count(row.trials), row.crude,
                        row.crude_interval.low, row.crude_interval.high, count(row.crude_trials), e.excess(),
                        count(row.died), count(row.ancestors), count(row.tied)});
  }
  return out;
}

std::string moves_text(const run::RiskRow& row) {
  std::vector<std::string> shares;
  for (const auto& [name, moves] : row.moves) {
    if (moves.proposed == 0) continue;
    shares.push_back(fmt::format("{} {:.0f} %", name,
                                 100.0 * static_cast<double>(moves.accepted) / static_cast<double>(moves.proposed)));
  }
  return fmt::format("{}, {}: {}{}", row.controller, row.family,
                     shares.empty() ? "no level was needed" : "moves accepted: ", fmt::join(shares, ", "));
}

int risk_of_suite(const RiskOptions& options) {
  const Suite suite = options.suite.load();
  const run::RareEvent event = rare_event(options.event, "risk");
  if (!options.quiet) print_warnings(suite.warnings);
  if (!options.quiet || options.price)
    (options.price ? std::cout : std::cerr) << run::price_of_risk(options.request, suite) << std::endl;
  if (options.price) return kOk;
  const InterruptGuard interrupt;
  run::RiskRequest request = options.request;
  request.trials.stop = &InterruptGuard::flag();
  StatusLine progress(options.quiet);
  const run::Risk risk = run::estimate_risk(request, suite, event, listener_on_stderr(options.quiet, progress));
  progress.clear();
  if (risk.end != run::End::kFinished) {
    std::cerr << terminal_safe_lines(risk.stopped) << std::endl;
    return kStoppedEarly;
  }
  bool refused = false;
  for (const run::RiskRow& row : risk.rows) {
    refused = refused || row.refused();
    if (!options.quiet && row.family != "all") std::cerr << terminal_safe(moves_text(row)) << '\n';
  }
  if (options.format == Format::kTable)
    std::cout << fmt::format("{} by {}, 95 % intervals\n", event.text(), event.level());
  write(std::cout, table(risk), options.format);
  std::cout.flush();
  print_warnings(risk.warnings);
  return refused ? kCheckFailed : kOk;
}

}  // namespace

void add_risk(CLI::App& app, Action& action, const Arguments& arguments) {
  auto options = std::make_shared<RiskOptions>();
  options->request.trials.arguments = arguments;
  CLI::App* command = app.add_subcommand(
      "risk", "Estimate how probable a rare event is over a suite's worlds and disturbances, by splitting");
  options->suite.add_to(*command);
  add_rare_event(*command, options->event);
  add_splitting(*command, options->request.splitting);
  command->add_option("--crude", options->request.crude,
                      "Crude trials of each family beside it, the first worlds among them (as many as splitting took)");
  add_moved_trials_store(*command, options->request.trials.file);
  add_threads(*command, options->request.trials.threads);
  add_format(*command, options->format);
  command->add_flag("--price", options->price, "Only say how many trials it takes, and how long");
  command->add_flag("-q,--quiet", options->quiet, "No progress and no remarks");
  command->footer(
      "Each family of worlds is split by itself; `all` joins them by their weights. Exit 1 where replicates differ "
      "too\n"
      "much for an estimate. What the figures mean, and when they lie: docs/explanation/rare-failures.md.\n"
      "Example: moma risk configs/suites/demo.yaml --set simulation.mode=kinematic --particles 100 -o results/risk.db");
  command->callback([&action, options] { action = [options] { return risk_of_suite(*options); }; });
}

}  // namespace moma::cli
