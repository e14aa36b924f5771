#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <optional>
#include <set>
#include <vector>

#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/compare_points.h"
#include "eval/stats/comparison.h"
#include "eval/store/columns.h"
#include "eval/store/query.h"
#include "reports/render/own_metrics.h"

namespace moma::cli {
namespace {

using stats::PairedRate;
using store::QueryResult;

struct CompareOptions {
  std::string file;
  std::string a;
  std::string b;
  std::string suite;
  std::optional<double> margin;
  double difference = 0.05;
  bool json = false;
};

/// Metrics to compare beside the outcome: columns of a trial and the suites' own metrics.
std::vector<run::ComparedMetric> metrics_of(const CompareOptions& options) {
  std::vector<run::ComparedMetric> metrics;
  std::set<std::string> taken;
  for (const store::TrialColumn& column : store::shown_columns()) {
    if (!column.about.shown.compared) continue;
    const std::string name(column.name);
    metrics.push_back({name, "ta." + name, "tb." + name});
    taken.insert(name);
  }
  for (const reports::OwnMetric& own : reports::own_metrics(options.file, taken))
    metrics.push_back({own.column, reports::value_sql(own, "ta.key"), reports::value_sql(own, "tb.key")});
  return metrics;
}

std::vector<PairedRate> all_rates(const stats::Comparison& comparison) {
  std::vector<PairedRate> rates = comparison.rates;
  if (comparison.sans_errors) rates.push_back(*comparison.sans_errors);
  return rates;
}

std::string share_text(const stats::Share& share) {
  if (std::isnan(share.rate)) return "none";
  return fmt::format("{:5.1f} [{:5.1f}, {:5.1f}]", 100.0 * share.rate, 100 * share.interval.low,
                     100 * share.interval.high);
}

void print_rates(const std::vector<PairedRate>& rates) {
  QueryResult table{
      {"rate", "n", "A % [95 %]", "B % [95 %]", "B - A [95 %]", "only A", "only B", "p (McNemar)", "p (Holm)"}, {}};
  for (const PairedRate& r : rates) {
    table.rows.push_back({r.name, r.n, share_text(r.a), share_text(r.b),
                          std::isnan(r.difference) ? "none"
                                                   : fmt::format("{:+.1f} [{:+.1f}, {:+.1f}]", 100 * r.difference,
                                                                 100 * r.interval.low, 100 * r.interval.high),
                          r.only_a, r.only_b, fmt::format("{:.3g}", r.p),
                          std::isnan(r.p_holm) ? "" : fmt::format("{:.3g}", r.p_holm)});
  }
  write(std::cout, table, Format::kTable);
}

void print_metrics(const std::vector<stats::PairedMean>& metrics) {
  QueryResult table{{"metric (both have it)", "n", "mean A", "mean B", "mean B - A", "95 % (paired bootstrap)"}, {}};
  for (const stats::PairedMean& row : metrics) {
    if (row.n == 0) continue;  // no world has it
    table.rows.push_back({row.name, row.n, row.a, row.b, row.difference,
                          std::isnan(row.interval.low)
                              ? "too few"
                              : fmt::format("[{:.4g}, {:.4g}]", row.interval.low, row.interval.high)});
  }
  write(std::cout, table, Format::kTable);
}

/// Returns the point's name, or the given one where it stands for several points.
std::string name_of(const run::ComparedPoints& compared, bool of_a, const std::string& given) {
  const auto& [a, b] = compared.pairs.front();
  return compared.pairs.size() > 1 ? given : (of_a ? a : b).name();
}

/// Prints the comparison as JSON.
void print_as_json(const run::ComparedPoints& compared, const CompareOptions& options) {
  const stats::Comparison& all = compared.comparison;
  Json json{{"a", name_of(compared, true, options.a)},
            {"b", name_of(compared, false, options.b)},
            {"suite", compared.suite},
            {"n", all.n},
            {"errors_a", all.errors_a},
            {"errors_b", all.errors_b}};
  json["pairs"] = Json::array();
  for (const auto& [a, b] : compared.pairs) json["pairs"].push_back({{"a", a.name()}, {"b", b.name()}});
  QueryResult rates{{"rate", "n", "a", "a_low", "a_high", "b", "b_low", "b_high", "difference", "low", "high", "only_a",
                     "only_b", "p_mcnemar", "p_holm"},
                    {}};
  for (const PairedRate& r : all_rates(all))
    rates.rows.push_back({r.name, r.n, r.a.rate, r.a.interval.low, r.a.interval.high, r.b.rate, r.b.interval.low,
                          r.b.interval.high, r.difference, r.interval.low, r.interval.high, r.only_a, r.only_b, r.p,
                          r.p_holm});
  json["rates"] = rows_as_json(rates);
  QueryResult means{{"metric", "n", "mean_a", "mean_b", "difference", "low", "high"}, {}};
  for (const stats::PairedMean& m : all.means)
    if (m.n > 0) means.rows.push_back({m.name, m.n, m.a, m.b, m.difference, m.interval.low, m.interval.high});
  json["metrics"] = rows_as_json(means);
  print_json(json);
}

void print_head(const run::ComparedPoints& compared, const CompareOptions& options) {
  const stats::Comparison& all = compared.comparison;
  const auto shown = [&](bool of_a) {
    const run::NamedPoint& point = of_a ? compared.pairs.front().first : compared.pairs.front().second;
    const std::string name = name_of(compared, of_a, of_a ? options.a : options.b);
    return point.why.empty() ? name : fmt::format("{} (best by {})", name, point.why);
  };
  const auto say = [](const std::string& line) { std::cout << terminal_safe(line) << '\n'; };
  const bool several = compared.pairs.size() > 1;
  say(fmt::format("A = {}, B = {}, suite {}: {} worlds that both met{}", shown(true), shown(false), compared.suite,
                  all.n, several ? ", each condition's counted:" : ""));
  for (const auto& [a, b] : compared.pairs)
    if (several) say(fmt::format("  {} and {}", a.name(), b.name()));
  if (!compared.same_conditions)
    say("The two are not under the same conditions: the difference is not one of controllers alone");
  if (all.worlds_with_errors > 0)
    say(fmt::format("In {} of these worlds a trial ended by an error (A {}, B {}), which is no success",
                    all.worlds_with_errors, all.errors_a, all.errors_b));
  std::cout << '\n';
}

int compare(const CompareOptions& options) {
  const run::ComparedPoints compared =
      run::compare_points(options.file, options.a, options.b, options.suite, metrics_of(options));
  const stats::Comparison& all = compared.comparison;
  const PairedRate& success = all.rate("success");
  const double loss = -success.difference;
  const bool worse = options.margin && loss > *options.margin;
  if (options.json) {
    print_as_json(compared, options);
    return worse ? kCheckFailed : kOk;
  }
  print_head(compared, options);
  print_rates(all_rates(all));
  std::cout << '\n';
  print_metrics(all.means);
  const double discordant = static_cast<double>(success.only_a + success.only_b) / static_cast<double>(all.n);
  std::cout << fmt::format(
      "\nWorlds needed to see a difference of {:g} percentage points in success, 4 times out of 5: {} ({:.1f} % of the "
      "worlds are won by one side alone)\n",
      100 * options.difference, stats::mcnemar_pairs(discordant, options.difference), 100 * discordant);
  if (!options.margin) return kOk;
  std::cout << fmt::format("\nB succeeds {:.2f} percentage points {} often than A; the margin is {:.2f}: {}\n",
                           100 * std::abs(loss), loss > 0 ? "less" : "more", 100 * *options.margin,
                           worse ? "worse" : "accepted");
  return worse ? kCheckFailed : kOk;
}

}  // namespace

void add_compare(Commands& commands) {
  auto [command, options] = commands.add<CompareOptions>(
      "compare", "Paired comparison of two controllers or points on the same worlds", &compare);
  add_store(command, options.file);
  command
      .add_option("A", options.a, "Controller (all its points), CONTROLLER:POINT of a sweep, @best or CONTROLLER@best")
      ->required();
  command.add_option("B", options.b, "The other one")->required();
  command.add_option("--suite", options.suite, "Suite, if several have both");
  command
      .add_option("--fail-if-worse", options.margin,
                  "Exit 1 if B's success rate is lower than A's by more than this, e.g. 0.02")
      ->check(CLI::Range(0.0, 1.0));
  command
      .add_option("--difference", options.difference,
                  "Difference of success for which the number of worlds is given (0.05)")
      ->check(CLI::Range(0.001, 0.999));
  command.add_flag("--json", options.json, "As one line of JSON");
  command.footer(fmt::format(
      "@best is the point with {}. On the worlds that chose it, the best of many looks better than it is.\n"
      "A controller whose points differ in conditions alone is compared under each of them. A trial that ended by an\n"
      "error did not succeed; the rate without these worlds stands beside.\n"
      "Examples: moma compare results/demo.db holistic moma --fail-if-worse 0.02\n"
      "          moma compare results/sweep.db published @best",
      run::kBestCriterion));
}

}  // namespace moma::cli
