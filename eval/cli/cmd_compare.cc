#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "eval/cli/command.h"
#include "eval/cli/table.h"
#include "eval/run/named_point.h"
#include "eval/stats/bootstrap.h"
#include "eval/stats/intervals.h"
#include "eval/store/query.h"
#include "reports/render/own_metric.h"

namespace moma::cli {
namespace {

using store::Cell;
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

constexpr const char* kMetrics[] = {"time_to_goal_s", "manip_mean",  "clearance_min_m", "command_change_mean",
                                    "path_ee_m",      "path_base_m", "jerk_ee_rms"};

using run::NamedPoint;

/// The one suite that has both.
std::pair<NamedPoint, NamedPoint> choose(const CompareOptions& options) {
  std::vector<std::pair<NamedPoint, NamedPoint>> both;
  const std::vector<NamedPoint> all_b = run::named_points(options.file, options.b, options.suite);
  std::string suites;
  for (const NamedPoint& a : run::named_points(options.file, options.a, options.suite)) {
    for (const NamedPoint& b : all_b) {
      if (a.suite_id != b.suite_id) continue;
      both.emplace_back(a, b);
      suites += (suites.empty() ? "" : ", ") + a.suite;
    }
  }
  if (both.empty()) throw UsageError(fmt::format("{} and {} are in no suite together", options.a, options.b));
  if (both.size() > 1) throw UsageError(fmt::format("several suites have both: choose one by --suite: {}", suites));
  return both.front();
}

double number(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*integer);
  return std::get<double>(cell);
}

/// What is compared of a trial beside its outcome: its columns and the suites' own metrics.
struct Metric {
  std::string name;
  std::string a;  ///< SQL over `ta`
  std::string b;  ///< SQL over `tb`
};

std::vector<Metric> metrics_of(const CompareOptions& options) {
  std::vector<Metric> metrics;
  std::set<std::string> taken;
  for (const char* name : kMetrics) {
    metrics.push_back({name, fmt::format("ta.{}", name), fmt::format("tb.{}", name)});
    taken.insert(name);
  }
  for (const reports::OwnMetric& own : reports::own_metrics(options.file, taken))
    metrics.push_back({own.column, reports::value_sql(own, "ta.key"), reports::value_sql(own, "tb.key")});
  return metrics;
}

constexpr std::size_t kOutcomes = 6;  // columns before the metrics

/// One row a world that both met: whether A's and B's trial ended by an error, succeeded, collided; then the metrics.
QueryResult paired(const CompareOptions& options, const std::pair<NamedPoint, NamedPoint>& points,
                   const std::vector<Metric>& metrics) {
  std::string columns;
  for (const char* outcome : {"error", "success", "collision"})
    columns += fmt::format("{}ta.outcome = '{}', tb.outcome = '{}'", columns.empty() ? "" : ", ", outcome, outcome);
  for (const Metric& metric : metrics) columns += fmt::format(", {}, {}", metric.a, metric.b);
  return store::query(options.file,
                      fmt::format("SELECT {} FROM point_trial AS ma JOIN point_trial AS mb USING (world_index) "
                                  "JOIN trial AS ta ON ta.key = ma.key JOIN trial AS tb ON tb.key = mb.key "
                                  "WHERE ma.point_id = {} AND mb.point_id = {} AND ta.world_id = tb.world_id "
                                  "ORDER BY ma.world_index",
                                  columns, points.first.id, points.second.id));
}

/// Takes out the worlds where a trial ended by an error; in words how many, "" where there are none.
std::string leave_out_errors(QueryResult& pairs) {
  std::int64_t of_a = 0;
  std::int64_t of_b = 0;
  const auto error = [&](const std::vector<Cell>& pair) {
    const bool a = std::get<std::int64_t>(pair[0]) != 0;
    const bool b = std::get<std::int64_t>(pair[1]) != 0;
    of_a += a ? 1 : 0;
    of_b += b ? 1 : 0;
    return a || b;
  };
  const std::size_t worlds = std::erase_if(pairs.rows, error);
  if (worlds == 0) return "";
  return fmt::format("; {} more {} left out, where a trial ended by an error (A {}, B {})", worlds,
                     worlds == 1 ? "is" : "are", of_a, of_b);
}

/// Of n worlds.
struct Share {
  std::int64_t count = 0;
  double rate = 0.0;
  stats::Interval wilson;
};

struct RateRow {
  const char* name;
  Share a, b;
  std::int64_t only_a = 0, only_b = 0;
  double p = 1.0, p_holm = 1.0;
};

Share share(std::int64_t count, std::int64_t n) {
  return {count, static_cast<double>(count) / static_cast<double>(n), stats::wilson(count, n)};
}

RateRow compare_rate(const QueryResult& pairs, const char* name, std::size_t column) {
  RateRow row{name, {}, {}};
  std::int64_t in_a = 0, in_b = 0;
  for (const auto& pair : pairs.rows) {
    const bool a = number(pair[column]) > 0.0;
    const bool b = number(pair[column + 1]) > 0.0;
    in_a += a ? 1 : 0;
    in_b += b ? 1 : 0;
    row.only_a += a && !b ? 1 : 0;
    row.only_b += b && !a ? 1 : 0;
  }
  const auto n = static_cast<std::int64_t>(pairs.rows.size());
  row.a = share(in_a, n);
  row.b = share(in_b, n);
  row.p = stats::mcnemar_exact(row.only_a, row.only_b);
  return row;
}

/// Success comes first.
std::vector<RateRow> compare_rates(const QueryResult& pairs) {
  std::vector<RateRow> rates{compare_rate(pairs, "success", 2), compare_rate(pairs, "collision", 4)};
  std::vector<double> p;
  for (const RateRow& rate : rates) p.push_back(rate.p);
  const std::vector<double> adjusted = stats::holm(p);
  for (std::size_t i = 0; i < rates.size(); ++i) rates[i].p_holm = adjusted[i];
  return rates;
}

std::string share_text(const Share& share) {
  return fmt::format("{:5.1f} [{:5.1f}, {:5.1f}]", 100.0 * share.rate, 100 * share.wilson.low, 100 * share.wilson.high);
}

void print_rates(const std::vector<RateRow>& rates, std::int64_t n) {
  QueryResult table{{"rate", "n", "A % [95 %]", "B % [95 %]", "only A", "only B", "p (McNemar)", "p (Holm)"}, {}};
  for (const RateRow& r : rates) {
    table.rows.push_back({std::string(r.name), n, share_text(r.a), share_text(r.b), r.only_a, r.only_b,
                          fmt::format("{:.3g}", r.p), fmt::format("{:.3g}", r.p_holm)});
  }
  write(std::cout, table, Format::kTable);
}

struct MetricRow {
  std::string name;
  std::int64_t n = 0;
  double a = 0.0, b = 0.0;  // means
  stats::MeanDifference difference;
};

/// Of the worlds where both have the metric; without those that no world has.
std::vector<MetricRow> compare_metrics(const QueryResult& pairs, const std::vector<Metric>& metrics) {
  std::vector<MetricRow> rows;
  for (std::size_t m = 0; m < metrics.size(); ++m) {
    std::vector<double> a;
    std::vector<double> b;
    for (const auto& pair : pairs.rows) {
      const Cell& x = pair[kOutcomes + 2 * m];
      const Cell& y = pair[kOutcomes + 1 + 2 * m];
      if (std::holds_alternative<std::monostate>(x) || std::holds_alternative<std::monostate>(y)) continue;
      a.push_back(number(x));
      b.push_back(number(y));
    }
    if (a.empty()) continue;
    MetricRow row{metrics[m].name, static_cast<std::int64_t>(a.size()), 0.0, 0.0, stats::paired_bootstrap(b, a)};
    for (std::size_t i = 0; i < a.size(); ++i) {
      row.a += a[i] / static_cast<double>(a.size());
      row.b += b[i] / static_cast<double>(a.size());
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

void print_metrics(const std::vector<MetricRow>& metrics) {
  QueryResult table{{"metric (both have it)", "n", "mean A", "mean B", "B - A", "95 % (paired bootstrap)"}, {}};
  for (const MetricRow& row : metrics) {
    const stats::MeanDifference& d = row.difference;
    table.rows.push_back({row.name, row.n, row.a, row.b, d.mean,
                          std::isnan(d.low) ? "too few" : fmt::format("[{:.4g}, {:.4g}]", d.low, d.high)});
  }
  write(std::cout, table, Format::kTable);
}

/// The same as data.
void print_json(const std::pair<NamedPoint, NamedPoint>& points, std::int64_t n, const std::vector<RateRow>& rates,
                const std::vector<MetricRow>& metrics) {
  using nlohmann::ordered_json;
  ordered_json json{{"a", points.first.name()}, {"b", points.second.name()}, {"suite", points.first.suite}, {"n", n}};
  json["rates"] = ordered_json::array();
  for (const RateRow& r : rates) {
    json["rates"].push_back({{"rate", r.name},
                             {"n", n},
                             {"a", r.a.rate},
                             {"a_low", r.a.wilson.low},
                             {"a_high", r.a.wilson.high},
                             {"b", r.b.rate},
                             {"b_low", r.b.wilson.low},
                             {"b_high", r.b.wilson.high},
                             {"only_a", r.only_a},
                             {"only_b", r.only_b},
                             {"p_mcnemar", r.p},
                             {"p_holm", r.p_holm}});
  }
  json["metrics"] = ordered_json::array();
  for (const MetricRow& row : metrics) {
    json["metrics"].push_back({{"metric", row.name},
                               {"n", row.n},
                               {"mean_a", row.a},
                               {"mean_b", row.b},
                               {"difference", row.difference.mean},
                               {"low", row.difference.low},
                               {"high", row.difference.high}});
  }
  std::cout << json.dump(-1, ' ', false, ordered_json::error_handler_t::replace) << '\n';
}

int compare(const CompareOptions& options) {
  const auto points = choose(options);
  const std::vector<Metric> metrics = metrics_of(options);
  QueryResult pairs = paired(options, points, metrics);
  const std::string left_out = leave_out_errors(pairs);
  const auto n = static_cast<std::int64_t>(pairs.rows.size());
  if (n == 0) throw UsageError(fmt::format("no world was met by both: nothing to compare{}", left_out));
  const auto shown = [](const NamedPoint& point) {
    return point.why.empty() ? point.name() : fmt::format("{} (best by {})", point.name(), point.why);
  };
  const std::vector<RateRow> rates = compare_rates(pairs);
  const RateRow& success = rates.front();
  const double loss = static_cast<double>(success.a.count - success.b.count) / static_cast<double>(n);
  const bool worse = options.margin && loss > *options.margin;
  const std::vector<MetricRow> compared = compare_metrics(pairs, metrics);
  if (options.json) {
    print_json(points, n, rates, compared);
    return worse ? kCheckFailed : kOk;
  }
  std::cout << terminal_safe(fmt::format("A = {}, B = {}, suite {}: {} worlds that both met{}", shown(points.first),
                                         shown(points.second), points.first.suite, n, left_out))
            << "\n\n";
  print_rates(rates, n);
  std::cout << '\n';
  print_metrics(compared);
  const double discordant = static_cast<double>(success.only_a + success.only_b) / static_cast<double>(n);
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

void add_compare(CLI::App& app, Action& action, const Arguments& /*arguments*/) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      app.add_subcommand("compare", "Paired comparison of two controllers or points on the same worlds");
  command->add_option("DB", options->file, "Store")->required();
  command->add_option("A", options->a, "Controller, CONTROLLER:POINT of a sweep, @best or CONTROLLER@best")->required();
  command->add_option("B", options->b, "The other one")->required();
  command->add_option("--suite", options->suite, "Which suite, where several have both");
  command
      ->add_option("--fail-if-worse", options->margin,
                   "Exit 1 where B's success rate is lower than A's by more than this, e.g. 0.02")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--difference", options->difference, "Says how many worlds show this difference of rates (0.05)")
      ->check(CLI::Range(0.001, 0.999));
  command->add_flag("--json", options->json, "As one line of JSON");
  command->footer(
      fmt::format("@best is the point with {}. On the worlds that chose it, the best of many looks better than it is.\n"
                  "Worlds where a trial ended by an error are left out.\n"
                  "Examples: moma compare results/demo.db holistic moma --fail-if-worse 0.02\n"
                  "          moma compare results/sweep.db published @best",
                  run::kBestCriterion));
  command->callback([&action, options] { action = [options] { return compare(*options); }; });
}

}  // namespace moma::cli
