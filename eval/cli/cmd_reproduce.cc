#include <fmt/format.h>

#include <cmath>
#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/evaluate.h"
#include "eval/run/reproduce.h"

namespace moma::cli {
namespace {

struct ReproduceOptions {
  std::string experiment;
  std::string published;
  std::string averaging;
  SuiteOptions suite;
  run::EvaluateRequest request;
  Format format = Format::kTable;
  bool quiet = false;
};

run::Experiment experiment_of(const ReproduceOptions& options) {
  run::Experiment experiment = run::read_experiment(
      options.published.empty() ? run::find_published() : fs::path(options.published), options.experiment);
  if (!options.averaging.empty()) {
    const auto found = from_string<run::Averaging>(options.averaging);
    if (!found)
      throw UsageError(fmt::format("reproduce: --averaging {}: expected one of: {}", options.averaging,
                                   list_of_words<run::Averaging>()));
    experiment.averaging = *found;
  }
  return experiment;
}

std::string ours_text(const run::Measured& ours, const run::Figure& figure) {
  if (ours.n == 0) return "";
  return fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", ours.value, figure.decimals, ours.interval.low, figure.decimals,
                     ours.interval.high, figure.decimals);
}

// For programs every column has a name of its own.
store::QueryResult rows_table(const run::Reproduction& done, const run::Experiment& experiment, bool for_person) {
  store::QueryResult table{{"robot", "method", "n"}, {}};
  for (const run::Figure* figure : experiment.figures) {
    const std::string own = for_person ? "" : fmt::format("{} ", figure->name);
    table.columns.push_back(for_person ? fmt::format("{} [95 %]", figure->label) : std::string(figure->name));
    table.columns.push_back(own + "published");
    if (figure->kind != run::Figure::Kind::kClock) table.columns.push_back(own + "agrees");
  }
  for (const run::ReproducedRow& row : done.rows) {
    std::vector<store::Cell> cells{row.robot, row.label.empty() ? row.method : row.method + " " + row.label,
                                   row.n > 0 ? store::Cell(row.n) : store::Cell()};
    for (const run::Figure* figure : experiment.figures) {
      const auto ours = row.ours.find(figure);
      cells.emplace_back(ours != row.ours.end() ? ours_text(ours->second, *figure) : std::string());
      const bool known = row.published != nullptr && row.published->values.count(figure) != 0;
      cells.push_back(known ? store::Cell(fmt::format("{:.{}f}", row.published->values.at(figure), figure->decimals))
                            : store::Cell(std::string()));
      if (figure->kind == run::Figure::Kind::kClock) continue;
      const std::optional<bool> agrees = ours != row.ours.end() ? ours->second.agrees : std::nullopt;
      cells.emplace_back(std::string(!agrees ? "" : *agrees ? "yes" : "no"));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

store::QueryResult differences_table(const run::Reproduction& done) {
  store::QueryResult table{{"robot", "difference", "figure", "n", "mean", "95 % (paired)", "beyond 0"}, {}};
  for (const run::PairedDifference& d : done.differences) {
    const int decimals = d.figure->decimals + 1;
    table.rows.push_back({d.robot, fmt::format("{} - {}", d.a, d.b), std::string(d.figure->label), d.n,
                          fmt::format("{:+.{}f}", d.difference, decimals),
                          std::isnan(d.interval.low) ? "too few"
                                                     : fmt::format("[{:+.{}f}, {:+.{}f}]", d.interval.low, decimals,
                                                                   d.interval.high, decimals),
                          std::string(d.interval.low > 0.0 || d.interval.high < 0.0 ? "yes" : "no")});
  }
  return table;
}

void print_reproduction(const run::Reproduction& found, const run::Experiment& experiment, Format format) {
  const bool for_person = cli::for_person(format);
  const store::QueryResult rows = rows_table(found, experiment, for_person);
  if (format == Format::kCsv) return write(std::cout, rows, format);  // one table
  if (for_person)
    std::cout << (format == Format::kLatex ? "% " : "") << terminal_safe("published: " + experiment.source) << "\n\n";
  if (format == Format::kJson) std::cout << "{\"rows\": ";
  write(std::cout, rows, format);
  std::cout << (format == Format::kJson ? ", \"differences\": " : "\n");
  if (!found.differences.empty() || !for_person) write(std::cout, differences_table(found), format);
  if (format == Format::kJson) std::cout << "}\n";
}

int reproduce(const ReproduceOptions& options) {
  const run::Experiment experiment = experiment_of(options);
  const Suite suite = load_suite(experiment.suite, options.suite.overrides());
  if (!options.quiet) print_warnings(suite.warnings);
  run::EvaluateRequest request = options.request;
  const Computation computation(request, options.quiet);
  const run::Evaluation done = run::evaluate(request, suite, computation.listener());
  print_warnings(done.warnings);
  if (const int code = tell_end(done); code != kOk) return code;
  print_reproduction(run::compare_with_published(done.file, done.suite, suite, experiment), experiment, options.format);
  std::cout.flush();
  return kOk;
}

}  // namespace

void add_reproduce(Commands& commands) {
  auto [command, options] = commands.add<ReproduceOptions>(
      "reproduce", "Repeat a published experiment, the published figures beside ours", &reproduce);
  command.add_option("EXPERIMENT", options.experiment, "mmc, neo or holistic (an entry of configs/published.yaml)")
      ->required();
  options.suite.add_changes_to(command);
  command.add_option("--averaging", options.averaging,
                     "Trials that means are over: arrived, all, or steps (arrived ones by their numbers of steps)");
  command.add_option("--published", options.published, "File of the published figures (configs/published.yaml)");
  add_output_store(command, options.request.file);
  add_threads(command, options.request.threads);
  add_format(command, options.format);
  add_quiet(command, options.quiet);
  command.footer(
      "Keys of the suite hold the values that the papers leave open: --set changes them "
      "(docs/studies/reproduction.md).\n"
      "Example: moma reproduce mmc --set worlds.families.pairs.range=1");
}

}  // namespace moma::cli
