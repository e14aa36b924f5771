#include <fmt/format.h>

#include <iostream>
#include <stdexcept>

#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/break.h"
#include "eval/run/risk.h"
#include "files/output_file.h"
#include "world/world_json.h"

namespace moma::cli {
namespace {

void add_rare_event(CLI::App& command, std::string& event) {
  command.add_option(
      "--event", event,
      "collision, timeout, stuck, joint_limit, spilled, infeasible, METRIC<VALUE or METRIC>VALUE (collision)");
}

/// Throws UsageError, naming `command`.
run::RareEvent rare_event(const std::string& text, const std::string& command) {
  try {
    return run::RareEvent::read(text);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("{}: --event: {}", command, error.what()));
  }
}

/// Adds --particles, --draws, --replicates, --moves, --levels and --split-seed, whose defaults are what `splitting` is.
void add_splitting(CLI::App& command, risk::SplittingOptions& splitting) {
  command
      .add_option("--particles", splitting.particles, fmt::format("Worlds of a replicate ({})", splitting.particles))
      ->check(CLI::Range(10, 1000000));
  command
      .add_option("--draws", splitting.draws,
                  fmt::format("Worlds drawn first for each particle; the nearest are kept ({})", splitting.draws))
      ->check(CLI::Range(1, 1000));
  command
      .add_option("--replicates", splitting.replicates,
                  fmt::format("Independent replicates, whose spread gives the interval ({})", splitting.replicates))
      ->check(CLI::Range(2, 10000));
  command.add_option("--moves", splitting.moves, fmt::format("Moves of each copy ({})", splitting.moves))
      ->check(CLI::Range(1, 1000));
  command
      .add_option(
          "--levels", splitting.levels,
          fmt::format("Largest number of levels; each after the first halves the probability ({})", splitting.levels))
      ->check(CLI::Range(1, 1000));
  command.add_option("--split-seed", splitting.seed, "Seed of choices and moves (1)");
}

void add_moved_trials_store(CLI::App& command, fs::path& file) {
  command.add_option("-o,--output", file,
                     "Store to keep trials in, made if missing: the same command goes on after a stop");
}

using store::Cell;

struct RiskOptions {
  SuiteOptions suite;
  run::RiskRequest request;
  std::string event = "collision";
  Format format = Format::kTable;
  bool price = false;
  double lost_after = 30.0;
  bool quiet = false;
};

store::QueryResult table(const run::Risk& risk) {
  store::QueryResult out{{"controller", "family", "p", "low", "high", "replicates", "trials", "crude", "crude low",
                          "crude high", "crude trials", "spread/ideal", "died out", "ancestors", "ties"},
                         {}};
  for (const run::RiskRow& row : risk.rows) {
    const auto known = [&](double value) { return row.refused() ? Cell{} : Cell{value}; };
    const risk::Estimate& e = row.estimate;
    const auto count = [](std::size_t n) { return static_cast<std::int64_t>(n); };
    out.rows.push_back({row.label.empty() ? row.controller : row.controller + ":" + row.label, row.family, known(e.p),
                        known(e.interval.low), known(e.interval.high), count(row.replicates), count(row.trials),
                        row.crude, row.crude_interval.low, row.crude_interval.high, count(row.crude_trials), e.excess(),
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

int lead(const RiskOptions& options) {
  const Suite suite = options.suite.load();
  const run::RareEvent event = rare_event(options.event, "risk");
  if (!options.quiet) print_warnings(suite.warnings);
  if (!options.quiet || options.price)
    (options.price ? std::cout : std::cerr) << run::price_of_risk(options.request, suite) << std::endl;
  if (options.price) return kOk;
  run::RiskRequest request = options.request;
  Computation computation(request, options.quiet);
  const run::Risk risk = run::estimate_risk(request, suite, event, computation.listener());
  computation.line().clear();
  if (const int code = tell_end(risk); code != kOk) return code;
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

int risk_of_suite(RiskOptions& options) {
  return with_ranks("risk", options.request, options.lost_after, false, [&] { return lead(options); });
}

struct BreakOptions {
  SuiteOptions suite;
  run::BreakRequest request;
  std::string event = "collision";
  std::string worlds;
  Format format = Format::kTable;
  files::Replace replace = files::Replace::kOwn;
  double lost_after = 30.0;
  bool quiet = false;
};

store::QueryResult table(const Suite& suite, const run::Broken& broken) {
  store::QueryResult out{{"line", "controller", "family", "world", "link", "object", "end s", "found by", "times"}, {}};
  for (const run::Failure& failure : broken.failures) {
    const SuitePoint& point = suite.points[failure.point];
    out.rows.push_back({static_cast<std::int64_t>(out.rows.size() + 1),
                        point.label.empty() ? point.controller : point.controller + ":" + point.label, failure.family,
                        static_cast<std::int64_t>(failure.world.index), failure.row.link, failure.row.object,
                        failure.row.time_end_s, failure.by, static_cast<std::int64_t>(failure.times)});
  }
  return out;
}

int lead(const BreakOptions& options) {
  const OutputFile file(options.worlds, {"file of worlds", ""}, options.replace);
  const Suite suite = options.suite.load();
  const run::RareEvent event = rare_event(options.event, "break");
  if (!options.quiet) print_warnings(suite.warnings);
  run::BreakRequest request = options.request;
  Computation computation(request, options.quiet);
  const run::Broken broken = run::break_suite(request, suite, event, computation.listener());
  computation.line().clear();
  write(std::cout, table(suite, broken), options.format);
  std::cout.flush();
  if (file.wanted() && !broken.failures.empty()) {
    std::string worlds;
    for (const run::Failure& failure : broken.failures) worlds += to_json(failure.world).dump() + '\n';
    file.write(worlds);
    if (!options.quiet)
      std::cerr << fmt::format("to run them: the suite with --trials {} --set 'worlds={{frozen: {}}}'\n",
                               broken.failures.size(), terminal_safe(options.worlds));
  }
  return tell_end(broken);
}

int break_suite(BreakOptions& options) {
  return with_ranks("break", options.request, options.lost_after, false, [&] { return lead(options); });
}

}  // namespace

void add_risk(Commands& commands) {
  auto [command, options] = commands.add<RiskOptions>(
      "risk", "Estimate how probable a rare event is over a suite's worlds and disturbances, by splitting",
      &risk_of_suite);
  options.suite.add_to(command);
  add_rare_event(command, options.event);
  add_splitting(command, options.request.splitting);
  command
      .add_option("--until", options.request.until,
                  "Adds as many replicates again and again, until the interval's ends are within this factor")
      ->check(CLI::Range(1.01, 1e6));
  command
      .add_option("--most", options.request.most,
                  fmt::format("Largest number of replicates ({})", options.request.most))
      ->check(CLI::Range(2, 1000000))
      ->needs("--until");
  command.add_option("--crude", options.request.crude,
                     "Crude trials of each family to compare with; the first draws always count (as "
                     "many as splitting took)");
  add_moved_trials_store(command, options.request.file);
  add_threads(command, options.request.threads);
  add_lost_after(command, options.lost_after);
  add_format(command, options.format);
  command.add_flag("--price", options.price, "Only say how many trials it takes, and how long");
  add_quiet(command, options.quiet);
  command.footer(
      "Each family of worlds is split by itself; `all` joins them by their weights. Exit 1 where replicates differ "
      "too\n"
      "much for an estimate. What the figures mean, and when they lie: docs/explanation/rare-failures.md.\n"
      "Example: moma risk configs/suites/demo.yaml --set simulation.mode=kinematic --particles 100 -o results/risk.db");
}

void add_break(Commands& commands) {
  auto [command, options] = commands.add<BreakOptions>(
      "break", "Find failures of a suite's controllers, the likeliest first, as frozen worlds", &break_suite);
  options.suite.add_to(command);
  command.add_option("--worlds", options.worlds, "Write the worlds found there, for `worlds: {frozen: FILE}`");
  add_rare_event(command, options.event);
  command.add_option("--crude", options.request.crude, "Trials of each family that are looked at first (1000)")
      ->check(CLI::Range(1, 100000000));
  command.add_option("--nearest", options.request.nearest, "Share of them whose noise is drawn again (0.01)")
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--noises", options.request.noises, "Times (40)")->check(CLI::Range(0, 100000));
  add_splitting(command, options.request.splitting);
  add_moved_trials_store(command, options.request.file);
  add_threads(command, options.request.threads);
  add_lost_after(command, options.lost_after);
  add_format(command, options.format);
  add_force(command, options.replace);
  add_quiet(command, options.quiet);
  command.footer(
      "A failure is a robot shape against an object in a world: found among crude trials, by other noise where those\n"
      "came nearest, or by splitting. docs/how-to/rare-failures.md has more.\n"
      "Example: moma break configs/suites/mixed.yaml --worlds found.jsonl -o results/break.db");
}

}  // namespace moma::cli
