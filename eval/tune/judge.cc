#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "eval/stats/bootstrap.h"
#include "eval/stats/intervals.h"
#include "eval/tune/held_out.h"

namespace moma::tune {
namespace {

constexpr double kSignificance = 0.05;
constexpr double kNan = kAbsent;

// One world met by both sides.
struct Pair {
  std::string family;
  const TrialRow* found = nullptr;
  const TrialRow* theirs = nullptr;
  TrialCost::Scale scale;
};

struct Row {
  store::TuneComparisonRecord record;
  bool rate = false;
  bool more_is_better = false;
};

Verdict verdict_of(const Row& row) {
  const store::TuneComparisonRecord& r = row.record;
  const bool shown = row.rate ? r.p < kSignificance : r.difference_low > 0.0 || r.difference_high < 0.0;
  if (!shown || std::isnan(r.difference) || r.difference == 0.0) return Verdict::kNoDifference;
  return (r.difference > 0.0) == row.more_is_better ? Verdict::kBetter : Verdict::kWorse;
}

bool by_error(const Pair& pair) {
  return pair.found->outcome == Outcome::kError || pair.theirs->outcome == Outcome::kError;
}

/// Of the worlds where neither trial ended by an error.
Row rate_row(const std::vector<Pair>& pairs, Outcome outcome, bool more_is_better) {
  Row row;
  row.rate = true;
  row.more_is_better = more_is_better;
  store::TuneComparisonRecord& r = row.record;
  std::int64_t both = 0, only_found = 0, only_theirs = 0, neither = 0;
  for (const Pair& pair : pairs) {
    if (by_error(pair)) continue;
    const bool x = pair.found->outcome == outcome, y = pair.theirs->outcome == outcome;
    ++(x && y ? both : x ? only_found : y ? only_theirs : neither);
  }
  r.n = both + only_found + only_theirs + neither;
  r.p = stats::mcnemar_exact(only_found, only_theirs);
  r.found = r.found_low = r.found_high = r.theirs = r.theirs_low = r.theirs_high = kNan;
  r.difference = r.difference_low = r.difference_high = kNan;
  if (r.n == 0) return row;
  const std::int64_t found = both + only_found, theirs = both + only_theirs;
  const stats::Interval f = stats::wilson(found, r.n), t = stats::wilson(theirs, r.n);
  const stats::Interval d = stats::difference_of_paired_rates(only_found, only_theirs, r.n);
  const auto n = static_cast<double>(r.n);
  r.found = static_cast<double>(found) / n;
  r.found_low = f.low;
  r.found_high = f.high;
  r.theirs = static_cast<double>(theirs) / n;
  r.theirs_low = t.low;
  r.theirs_high = t.high;
  r.difference = static_cast<double>(only_found - only_theirs) / n;
  r.difference_low = d.low;
  r.difference_high = d.high;
  return row;
}

Row mean_row(const std::vector<Pair>& pairs, bool more_is_better,
             const std::function<double(const TrialRow&, const TrialCost::Scale&)>& value) {
  Row row;
  row.more_is_better = more_is_better;
  store::TuneComparisonRecord& r = row.record;
  std::vector<double> a, b;
  for (const Pair& pair : pairs) {
    const double x = value(*pair.found, pair.scale), y = value(*pair.theirs, pair.scale);
    if (std::isnan(x) || std::isnan(y)) continue;
    a.push_back(x);
    b.push_back(y);
  }
  r.n = static_cast<std::int64_t>(a.size());
  r.found_low = r.found_high = r.theirs_low = r.theirs_high = r.p = kNan;
  r.found = r.theirs = r.difference = r.difference_low = r.difference_high = kNan;
  if (a.empty()) return row;
  const std::vector<double> zero(a.size(), 0.0);
  const auto n = static_cast<double>(a.size());
  double sum_a = 0.0, sum_b = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum_a += a[i];
    sum_b += b[i];
  }
  r.found = sum_a / n;
  r.theirs = sum_b / n;
  const stats::MeanDifference f = stats::paired_bootstrap(a, zero), t = stats::paired_bootstrap(b, zero);
  r.found_low = f.low;
  r.found_high = f.high;
  r.theirs_low = t.low;
  r.theirs_high = t.high;
  const stats::MeanDifference d = stats::paired_bootstrap(a, b);
  r.difference = d.mean;
  r.difference_low = d.low;
  r.difference_high = d.high;
  return row;
}

std::vector<Row> compare(const Tuning& tuning, const std::vector<Pair>& pairs, const std::string& family,
                         const std::string& other) {
  const auto metric = [](const char* name) {
    return [m = Metric::find(name)](const TrialRow& row, const TrialCost::Scale&) { return m.value(row); };
  };
  std::vector<std::pair<std::string, Row>> named;
  named.emplace_back("success", rate_row(pairs, Outcome::kSuccess, true));
  named.emplace_back("collision", rate_row(pairs, Outcome::kCollision, false));
  named.emplace_back("objective", mean_row(pairs, false, [&](const TrialRow& row, const TrialCost::Scale& scale) {
                       return tuning.config.cost(row, scale);
                     }));
  // NULL unless the trial succeeds, so that only worlds where both do are compared.
  named.emplace_back("time_to_goal_s", mean_row(pairs, false, metric("time_to_goal_s")));
  named.emplace_back("manip_mean", mean_row(pairs, true, metric("manip_mean")));
  named.emplace_back("command_change_mean", mean_row(pairs, false, metric("command_change_mean")));
  std::vector<Row> rows;
  for (auto& [name, row] : named) {
    row.record.metric = name;
    row.record.family = family;
    row.record.other = other;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<std::string> judge_constraints(const Tuning& tuning, const std::vector<const TrialRow*>& rows) {
  std::vector<std::string> lines;
  for (const MetricBound& bound : tuning.config.bounds) {
    const Constraint constraint = constraint_of(bound);
    if (constraint.of_start) continue;  // the comparisons tell
    double sum = 0.0;
    std::int64_t ones = 0;
    bool rate = true;
    for (const TrialRow* row : rows) {
      const double value = bound_value(bound, *row);
      sum += value;
      rate = rate && (value == 0.0 || std::abs(value) == 1.0);
      ones += std::abs(value) == 1.0 ? 1 : 0;
    }
    const double mean = sum / static_cast<double>(rows.size());
    std::string interval;
    if (rate && !rows.empty()) {
      const stats::Interval w = stats::wilson(ones, static_cast<std::int64_t>(rows.size()));
      interval = fmt::format(" [{:.3g}, {:.3g}]", w.low, w.high);
    }
    lines.push_back(fmt::format("{}: {:.4g}{}, {}", constraint.name, bound.at_least ? -mean : mean, interval,
                                mean <= constraint.at_most ? "kept" : "broken"));
  }
  return lines;
}

std::string number(double value) { return std::isnan(value) ? "-" : fmt::format("{:.4g}", value); }

std::string interval(double value, double low, double high, bool percent) {
  if (std::isnan(value)) return "-";
  if (percent) return fmt::format("{:.1f} % [{:.1f}, {:.1f}]", 100 * value, 100 * low, 100 * high);
  if (std::isnan(low)) return number(value);  // too few for one
  return fmt::format("{} [{}, {}]", number(value), number(low), number(high));
}

}  // namespace

HeldOutVerdict judge(const Tuning& tuning, const HeldOut& held_out, const std::vector<TrialRow>& rows) {
  // (part, world) -> controller -> row
  std::map<std::pair<std::size_t, std::uint64_t>, std::map<std::string, std::size_t>> cells;
  for (std::size_t j = 0; j < held_out.jobs.size(); ++j) {
    const BatchJob& job = held_out.jobs[j];
    cells[{held_out.part[job.point], job.world}][held_out.suite.points[job.point].controller] = j;
  }
  std::vector<TrialCost::Scale> scales;
  for (std::size_t part = 0; part < tuning.suites.size(); ++part) {
    scales.push_back(TrialCost::scale_of(tuning.suites[part].points[tuning.tuned_point[part]]));
  }

  HeldOutVerdict verdict;
  std::vector<Row> all;
  for (const std::string& other : held_out.others) {
    std::map<std::string, std::vector<Pair>> by_family;
    std::vector<Pair> together;
    for (const auto& [where, row_of] : cells) {
      const std::size_t j = row_of.at(held_out.found);
      const SuitePoint& point = held_out.suite.points[held_out.jobs[j].point];
      Pair pair{point.worlds.family_of(where.second), &rows[j], &rows[row_of.at(other)], scales[where.first]};
      const std::string& part = held_out.part_names[where.first];
      by_family[part.empty() ? pair.family : part + " " + pair.family].push_back(pair);
      together.push_back(pair);
    }
    if (by_family.size() > 1) {
      for (const auto& [family, pairs] : by_family) {
        for (Row& row : compare(tuning, pairs, family, other)) all.push_back(std::move(row));
      }
    }
    for (Row& row : compare(tuning, together, "all", other)) all.push_back(std::move(row));
    if (other == held_out.others.front()) verdict.errors = std::count_if(together.begin(), together.end(), by_error);
  }

  std::vector<double> p;
  for (const Row& row : all) {
    if (row.rate) p.push_back(row.record.p);
  }
  const std::vector<double> adjusted = stats::holm(p);
  std::size_t next = 0;
  verdict.against = held_out.others.front();
  std::map<std::string, Verdict> overall;
  for (Row& row : all) {
    if (row.rate) row.record.p = adjusted[next++];
    const Verdict v = verdict_of(row);
    row.record.verdict = to_string(v);
    if (row.record.other == verdict.against && row.record.family == "all") overall[row.record.metric] = v;
    verdict.rows.push_back(row.record);
  }
  const auto is = [&](const char* metric, Verdict v) { return overall.at(metric) == v; };
  for (const char* metric : {"success", "collision"}) {
    if (is(metric, Verdict::kWorse)) {
      verdict.overall = Verdict::kWorse;
      verdict.why = metric;
    }
  }
  for (const char* metric : {"success", "objective"}) {
    if (verdict.overall == Verdict::kNoDifference && is(metric, Verdict::kBetter)) {
      verdict.overall = Verdict::kBetter;
      verdict.why = metric;
    }
  }
  std::vector<const TrialRow*> found_rows;
  for (const auto& [where, row_of] : cells) {
    const TrialRow& row = rows[row_of.at(held_out.found)];
    if (row.outcome != Outcome::kError) found_rows.push_back(&row);
  }
  verdict.constraints = judge_constraints(tuning, found_rows);
  return verdict;
}

std::string table(const HeldOutVerdict& verdict) {
  std::vector<std::vector<std::string>> lines{
      {"family", "against", "metric", "n", "found", "theirs", "difference", "p", "verdict"}};
  for (const store::TuneComparisonRecord& r : verdict.rows) {
    const bool percent = r.metric == "success" || r.metric == "collision";
    lines.push_back({r.family, r.other, r.metric, fmt::format("{}", r.n),
                     interval(r.found, r.found_low, r.found_high, percent),
                     interval(r.theirs, r.theirs_low, r.theirs_high, percent),
                     interval(r.difference, r.difference_low, r.difference_high, percent),
                     std::isnan(r.p) ? ""
                     : r.p < 1e-4    ? fmt::format("{:.0e}", r.p)
                                     : fmt::format("{:.4f}", r.p),
                     r.verdict});
  }
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  }
  std::string text;
  for (const auto& line : lines) {
    std::string row;
    for (std::size_t c = 0; c < line.size(); ++c) row += fmt::format("{:<{}}  ", line[c], widths[c]);
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + "\n";
  }
  if (verdict.errors > 0)
    text += fmt::format("rates are without {} where a trial ended by an error\n",
                        verdict.errors == 1 ? "one world" : fmt::format("{} worlds", verdict.errors));
  return text;
}

}  // namespace moma::tune
