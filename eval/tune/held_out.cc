#include "eval/tune/held_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "controller/config/paths.h"
#include "controller/describe/enumeration.h"
#include "eval/store/columns.h"
#include "eval/suite/resolve.h"
#include "eval/suite/sweep.h"

namespace moma::tune {
namespace {

// Label of a part of a mixture: "robot=tiago".
std::string part_name(const Overrides& part) {
  const auto text = [](const auto& of) {
    std::string value = of.second;
    std::erase(value, '"');
    if (value.ends_with(".yaml")) value = fs::path(value).stem().string();
    return fmt::format("{}={}", short_key(of.first), value);
  };
  return joined(part, text, " ");
}

}  // namespace

HeldOut make_held_out(const Tuning& given, const Candidate& found) {
  const TuneConfig& config = given.config;
  Tuning tuning = given;
  if (config.held_out_seed) {
    tuning.overrides.emplace_back("worlds.seed", fmt::format("{}", *config.held_out_seed));
    tuning.suites = tuning.held_out_suites;
  }
  const Points points(tuning);
  const std::vector<SuitePoint> tuned = points.make(found);
  const std::vector<SuitePoint> start = points.make(start_of(config.variables));

  HeldOut held_out;
  held_out.found = config.controller + "-tuned";
  bool start_differs = false;
  for (std::size_t part = 0; part < tuning.suites.size(); ++part) {
    start_differs =
        start_differs || !points.same_worlds() ||
        start[part].controller_resolved != tuning.suites[part].points[tuning.tuned_point[part]].controller_resolved;
  }
  const bool many = tuning.suites.size() > 1;
  const auto add = [&](SuitePoint point, std::size_t part, const std::string& name) {
    point.controller = name;
    point.label = many ? held_out.part_names[part] : "";
    point.params = Json::object();
    if (many) {
      for (const auto& [key, text] : config.mixture[part]) point.params[key] = Json::parse(text, nullptr, false);
    }
    held_out.suite.points.push_back(std::move(point));
    held_out.part.push_back(part);
    if (part == 0 && name != held_out.found) held_out.others.push_back(name);
  };
  for (std::size_t part = 0; part < tuning.suites.size(); ++part) {
    held_out.part_names.push_back(many ? part_name(config.mixture[part]) : "");
    // The tuned controller's preset comes first: the verdict is against it.
    const std::vector<SuitePoint>& all = tuning.suites[part].points;
    add(all[tuning.tuned_point[part]], part, config.controller);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i != tuning.tuned_point[part]) add(all[i], part, all[i].controller);
    }
    if (start_differs) add(start[part], part, config.controller + "-start");
    add(tuned[part], part, held_out.found);
  }
  held_out.suite.name = tuning.suites.front().name + "-held-out";
  held_out.suite.trials = config.held_out.count;
  held_out.suite.samples = tuning.suites.front().samples;
  held_out.suite.resolved = resolved_json(held_out.suite, true);
  held_out.jobs = make_jobs(held_out.suite.points, config.held_out.first, config.held_out.count);
  return held_out;
}

namespace {

struct Pair {
  std::string family;
  const TrialRow* found = nullptr;
  const TrialRow* theirs = nullptr;
  TrialCost::Scale scale;
};

/// Side A is the other controller, side B the found gains, so that differences are found minus other.
struct Compared {
  std::string family, other;
  stats::Comparison comparison;
};

Verdict verdict_of(int shown, bool more_is_better) {
  if (shown == 0) return Verdict::kNoDifference;
  return (shown > 0) == more_is_better ? Verdict::kBetter : Verdict::kWorse;
}

stats::Ending ending_of(const TrialRow& row) {
  return {row.outcome == Outcome::kSuccess, row.outcome == Outcome::kCollision, row.outcome == Outcome::kError};
}

Compared compare(const Tuning& tuning, const std::vector<Pair>& pairs, const std::string& family,
                 const std::string& other) {
  std::vector<std::pair<stats::Ending, stats::Ending>> endings;
  // The time to the goal is NULL unless the trial succeeds, so that only worlds with two successes are compared.
  std::vector<stats::PairedValues> values{{"objective", {}, {}}};
  std::vector<Metric> metrics;
  for (const store::TrialColumn& column : store::shown_columns()) {
    if (!column.about.shown.judged) continue;
    metrics.push_back(Metric::find(column.name));
    values.push_back({std::string(column.name), {}, {}});
  }
  for (const Pair& pair : pairs) {
    endings.emplace_back(ending_of(*pair.theirs), ending_of(*pair.found));
    values[0].a.push_back(tuning.config.cost(*pair.theirs, pair.scale));
    values[0].b.push_back(tuning.config.cost(*pair.found, pair.scale));
    for (std::size_t m = 0; m < metrics.size(); ++m) {
      values[m + 1].a.push_back(metrics[m].value(*pair.theirs));
      values[m + 1].b.push_back(metrics[m].value(*pair.found));
    }
  }
  return {family, other, stats::compare(endings, values)};
}

/// A rate or mean with its interval; NaN without a value.
struct Side {
  Side(double of, const stats::Interval& interval, bool none)
      : value(of), low(none ? kAbsent : interval.low), high(none ? kAbsent : interval.high) {}
  double value, low, high;
};

store::TuneComparisonRecord record_of(const Compared& of, const std::string& metric, std::int64_t n, const Side& found,
                                      const Side& theirs, const Side& difference, double p, Verdict verdict) {
  return {of.family,        of.other,       metric,          n,          found.value,
          found.low,        found.high,     theirs.value,    theirs.low, theirs.high,
          difference.value, difference.low, difference.high, p,          verdict};
}

store::TuneComparisonRecord record_of(const Compared& of, const stats::PairedRate& r, bool more_is_better) {
  const auto side = [](const stats::Share& share) { return Side(share.rate, share.interval, std::isnan(share.rate)); };
  return record_of(of, r.name, r.n, side(r.b), side(r.a), {r.difference, r.interval, std::isnan(r.difference)},
                   r.p_holm, verdict_of(r.shown(), more_is_better));
}

store::TuneComparisonRecord record_of(const Compared& of, const stats::PairedMean& m) {
  const auto is_high = [&](const store::TrialColumn& c) { return c.name == m.name && c.about.better == Better::kHigh; };
  return record_of(of, m.name, m.n, {m.b, m.of_b, false}, {m.a, m.of_a, false}, {m.difference, m.interval, false},
                   kAbsent, verdict_of(m.shown(), std::ranges::any_of(store::shown_columns(), is_high)));
}

std::vector<std::string> judge_constraints(const Tuning& tuning, const std::vector<const TrialRow*>& rows) {
  std::vector<std::string> lines;
  for (const MetricBound& bound : tuning.config.bounds) {
    const Constraint constraint = constraint_of(bound);
    if (constraint.of_start) continue;  // the comparisons cover it
    double sum = 0.0;
    std::int64_t ones = 0;
    bool rate = true;
    std::int64_t n = 0;
    for (const TrialRow* row : rows) {
      // A trial with an error may lack a metric.
      if (row->outcome == Outcome::kError && !bound.when_null && std::isnan(bound.metric.value(*row))) continue;
      const double value = bound_value(bound, *row);
      ++n;
      sum += value;
      rate = rate && (value == 0.0 || std::abs(value) == 1.0);
      ones += std::abs(value) == 1.0 ? 1 : 0;
    }
    const double mean = sum / static_cast<double>(n);
    std::string interval;
    if (rate && n > 0) {
      const stats::Interval w = stats::wilson(ones, n);
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
  if (std::isnan(low)) return number(value);  // too few values for an interval
  return fmt::format("{} [{}, {}]", number(value), number(low), number(high));
}

std::string percent_of(const stats::Share& share) {
  return std::isnan(share.rate) ? "of none" : fmt::format("{:.1f} %", 100 * share.rate);
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
  std::vector<Compared> all;
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
      for (const auto& [family, pairs] : by_family) all.push_back(compare(tuning, pairs, family, other));
    }
    all.push_back(compare(tuning, together, "all", other));
  }

  std::vector<stats::PairedRate*> rates;
  for (Compared& of : all)
    for (stats::PairedRate& rate : of.comparison.rates) rates.push_back(&rate);
  stats::correct_by_holm(rates);
  verdict.against = held_out.others.front();
  std::map<std::string, Verdict> overall;
  for (const Compared& of : all) {
    const stats::Comparison& comparison = of.comparison;
    const auto add = [&](store::TuneComparisonRecord record) { verdict.rows.push_back(std::move(record)); };
    add(record_of(of, comparison.rate("success"), true));
    add(record_of(of, comparison.rate("collision"), false));
    for (const stats::PairedMean& mean : comparison.means) add(record_of(of, mean));
    if (of.other != verdict.against || of.family != "all") continue;
    verdict.errors = comparison.worlds_with_errors;
    verdict.success_without_errors = comparison.sans_errors;
    overall["success"] = verdict_of(comparison.rate("success").shown(), true);
    overall["collision"] = verdict_of(comparison.rate("collision").shown(), false);
    overall["objective"] = verdict_of(comparison.mean("objective").shown(), false);
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
    found_rows.push_back(&rows[row_of.at(held_out.found)]);
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
                     std::string(to_string(r.verdict))});
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
    text += fmt::format(
        "in {} a trial ended by an error, which is no success; without these worlds success is {} against {}\n",
        verdict.errors == 1 ? "one world" : fmt::format("{} worlds", verdict.errors),
        percent_of(verdict.success_without_errors->b), percent_of(verdict.success_without_errors->a));
  return text;
}

}  // namespace moma::tune
