#include "eval/run/reproduce.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "eval/stats/comparison.h"
#include "eval/store/hash.h"
#include "eval/store/query.h"
#include "eval/store/records.h"

namespace moma::run {
namespace {

constexpr double kNormal95 = 1.959963984540054;

struct StoredTrial {
  bool arrived = false;
  double steps = 0.0;
  std::vector<std::optional<double>> figures;  ///< in the order of the experiment's figures
};

/// A point of the suite with its trials by world.
struct PointTrials {
  std::string robot, method, label;
  std::map<std::int64_t, StoredTrial> trials;
};

PointTrials trials_of(const fs::path& file, const std::string& suite_name, const store::PointRecord& point,
                      std::uint64_t worlds, const Experiment& experiment) {
  std::string columns = "m.world_index, t.outcome = 'success', t.steps";
  for (const Figure* figure : experiment.figures) columns += fmt::format(", {}", figure->sql);
  const store::QueryResult found = store::query(
      file, fmt::format("SELECT {} FROM point AS p JOIN suite AS s ON s.id = p.suite_id JOIN point_trial AS m ON "
                        "m.point_id = p.id JOIN trial AS t ON t.key = m.key JOIN execution AS e ON e.key = t.key WHERE "
                        "s.name = {} AND p.controller_name = {} AND p.label = {} AND p.content_hash = x'{}' AND "
                        "m.world_index < {} ORDER BY m.world_index",
                        columns, store::sql_literal(suite_name), store::sql_literal(point.controller),
                        store::sql_literal(point.label), store::to_hex(point.content_hash), worlds));
  PointTrials out{point.robot_name, point.controller, point.label, {}};
  for (const auto& row : found.rows) {
    StoredTrial trial{store::number_in(row[1]).value_or(0.0) > 0.0, store::number_in(row[2]).value_or(0.0), {}};
    for (std::size_t i = 3; i < row.size(); ++i) trial.figures.push_back(store::number_in(row[i]));
    out.trials.emplace(std::get<std::int64_t>(row[0]), std::move(trial));
  }
  return out;
}

bool counts(const StoredTrial& trial, const Figure& figure, Averaging averaging) {
  return figure.kind == Figure::Kind::kRate || averaging == Averaging::kAll || trial.arrived;
}

Measured measure_rate(const PointTrials& point, std::size_t at, const PublishedRow* published, const Figure& figure) {
  Measured out;
  std::int64_t hits = 0;
  for (const auto& [world, trial] : point.trials) {
    ++out.n;
    hits += trial.figures[at].value_or(0.0) > 0.0 ? 1 : 0;
  }
  const stats::Interval interval = stats::wilson(hits, out.n);
  out.interval = {figure.scale * interval.low, figure.scale * interval.high};
  out.value = out.n > 0 ? figure.scale * static_cast<double>(hits) / static_cast<double>(out.n)
                        : std::numeric_limits<double>::quiet_NaN();
  if (published == nullptr || published->values.count(&figure) == 0 || out.n == 0) return out;
  const double rate = published->values.at(&figure) / figure.scale;
  const stats::Interval apart =
      stats::difference_of_rates(hits, out.n, std::lround(rate * published->problems), published->problems);
  out.agrees = apart.low <= 0.0 && apart.high >= 0.0;
  return out;
}

Measured measure_mean(const PointTrials& point, std::size_t at, const PublishedRow* published, const Figure& figure,
                      Averaging averaging) {
  std::vector<double> values;
  std::vector<double> weights;
  for (const auto& [world, trial] : point.trials) {
    if (!counts(trial, figure, averaging) || !trial.figures[at]) continue;
    values.push_back(figure.scale * *trial.figures[at]);
    weights.push_back(averaging == Averaging::kSteps ? trial.steps : 1.0);
  }
  const stats::WeightedMean mean = stats::weighted_mean(values, weights);
  Measured out{static_cast<std::int64_t>(values.size()), mean.mean, {}, {}};
  out.interval = {mean.mean - kNormal95 * mean.error, mean.mean + kNormal95 * mean.error};
  if (figure.kind == Figure::Kind::kClock || published == nullptr || published->values.count(&figure) == 0) return out;
  // The spread of the published trials is unknown: it is assumed to equal ours, with their number of trials.
  const double error = mean.error * std::sqrt(1.0 + static_cast<double>(out.n) / published->problems);
  if (std::isfinite(error)) out.agrees = std::abs(mean.mean - published->values.at(&figure)) <= kNormal95 * error;
  return out;
}

std::optional<PairedDifference> difference_of(const PointTrials& a, const PointTrials& b, std::size_t at,
                                              const Figure& figure, Averaging averaging) {
  stats::PairedValues values;  // a - b
  std::vector<std::pair<bool, bool>> hits;
  for (const auto& [world, trial] : a.trials) {
    const auto other = b.trials.find(world);
    if (other == b.trials.end() || !counts(trial, figure, averaging) || !counts(other->second, figure, averaging))
      continue;
    if (!trial.figures[at] || !other->second.figures[at]) continue;
    values.a.push_back(figure.scale * *other->second.figures[at]);
    values.b.push_back(figure.scale * *trial.figures[at]);
    hits.emplace_back(*other->second.figures[at] > 0.0, *trial.figures[at] > 0.0);
  }
  if (hits.empty()) return std::nullopt;
  PairedDifference found{a.robot, a.method, b.method, &figure, static_cast<std::int64_t>(hits.size()), 0.0, {}};
  if (figure.kind == Figure::Kind::kRate) {
    const stats::PairedRate rate = stats::paired_rate("", hits);
    found.difference = figure.scale * rate.difference;
    found.interval = {figure.scale * rate.interval.low, figure.scale * rate.interval.high};
  } else {
    const stats::PairedMean mean = stats::paired_mean(values);
    found.difference = mean.difference;
    found.interval = mean.interval;
  }
  return found;
}

ReproducedRow row_of(const PointTrials& point, const Experiment& experiment) {
  ReproducedRow row{point.robot, point.method, point.label, static_cast<std::int64_t>(point.trials.size()), {}, {}};
  row.published = experiment.find(point.robot, point.method);
  for (std::size_t i = 0; i < experiment.figures.size(); ++i) {
    const Figure& figure = *experiment.figures[i];
    row.ours[&figure] = figure.kind == Figure::Kind::kRate
                            ? measure_rate(point, i, row.published, figure)
                            : measure_mean(point, i, row.published, figure, experiment.averaging);
  }
  return row;
}

}  // namespace

Reproduction compare_with_published(const fs::path& store, const std::string& suite_name, const Suite& suite,
                                    const Experiment& experiment) {
  const store::SuiteRecord record = store::describe(suite);
  std::vector<PointTrials> points;
  std::vector<std::string> robots;
  for (const store::PointRecord& point : record.points) {
    points.push_back(trials_of(store, suite_name, point, suite.trials, experiment));
    const auto& params = suite.points[points.size() - 1].params;
    if (params.size() == 1 && params.contains("robot")) points.back().label.clear();  // the row names the robot
    if (std::ranges::find(robots, point.robot_name) == robots.end()) robots.push_back(point.robot_name);
  }
  Reproduction out;
  std::set<const PublishedRow*> shown;
  for (const std::string& robot : robots) {
    for (const PointTrials& point : points) {
      if (point.robot != robot) continue;
      out.rows.push_back(row_of(point, experiment));
      shown.insert(out.rows.back().published);
    }
    for (const PublishedRow& row : experiment.rows)
      if (row.robot == robot && shown.count(&row) == 0) out.rows.push_back({row.robot, row.method, {}, 0, {}, &row});
    for (const auto& [name_a, name_b] : experiment.pairs)
      for (const PointTrials& a : points)
        for (const PointTrials& b : points) {
          if (a.robot != robot || b.robot != robot || a.method != name_a || b.method != name_b || a.label != b.label)
            continue;
          for (std::size_t i = 0; i < experiment.figures.size(); ++i) {
            const Figure& figure = *experiment.figures[i];
            if (figure.kind == Figure::Kind::kClock) continue;
            if (auto found = difference_of(a, b, i, figure, experiment.averaging))
              out.differences.push_back(std::move(*found));
          }
        }
  }
  return out;
}

}  // namespace moma::run
