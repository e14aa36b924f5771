#include "eval/run/compare_points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "eval/store/error.h"
#include "eval/store/query.h"

namespace moma::run {
namespace {

using store::Cell;
using store::StoreError;

[[noreturn]] void refuse(const std::string& message) { throw StoreError(StoreError::Kind::kNotFound, message); }

/// The points of a name in one suite, by conditions.
struct Side {
  std::string name;
  bool controller = false;  ///< the name stands for all points of a controller
  std::map<std::string, NamedPoint> points;
};

std::map<std::int64_t, Side> sides(const fs::path& store, const std::string& name, const std::string& suite) {
  std::map<std::int64_t, Side> all;
  std::vector<NamedPoint> points = points_of_controller(store, name, suite);
  const bool controller = !points.empty();
  if (!controller) points = named_points(store, name, suite);
  for (NamedPoint& point : points) {
    Side& side = all[point.suite_id];
    side.name = name;
    side.controller = controller;
    const auto [at, fresh] = side.points.try_emplace(point.conditions, point);
    if (!fresh)
      refuse(
          fmt::format("suite {} has several points of {} under the same conditions, {} and {}: choose one, or {}@best",
                      point.suite, name, at->second.name(), point.name(), name));
  }
  return all;
}

std::vector<std::pair<NamedPoint, NamedPoint>> paired(const Side& a, const Side& b) {
  std::vector<std::pair<NamedPoint, NamedPoint>> pairs;
  if (!a.controller && !b.controller) return {{a.points.begin()->second, b.points.begin()->second}};
  for (const auto& [conditions, point] : a.points) {
    const auto other = b.points.find(conditions);
    if (other != b.points.end()) pairs.emplace_back(point, other->second);
  }
  return pairs;
}

struct ComparedTrials {
  std::vector<std::pair<stats::Ending, stats::Ending>> endings;
  std::vector<stats::PairedValues> values;
};

void read(const fs::path& store, const std::pair<NamedPoint, NamedPoint>& points,
          const std::vector<ComparedMetric>& metrics, ComparedTrials& trials) {
  std::string columns = "ta.outcome, tb.outcome";
  for (const ComparedMetric& metric : metrics) columns += fmt::format(", {}, {}", metric.a, metric.b);
  const store::QueryResult found =
      store::query(store, fmt::format("SELECT {} FROM point_trial AS ma JOIN point_trial AS mb USING (world_index) "
                                      "JOIN trial AS ta ON ta.key = ma.key JOIN trial AS tb ON tb.key = mb.key "
                                      "WHERE ma.point_id = {} AND mb.point_id = {} AND ta.world_id = tb.world_id "
                                      "ORDER BY ma.world_index",
                                      columns, points.first.id, points.second.id));
  const auto ending = [](const Cell& cell) {
    const auto& outcome = std::get<std::string>(cell);
    return stats::Ending{outcome == "success", outcome == "collision", outcome == "error"};
  };
  for (const auto& row : found.rows) {
    trials.endings.emplace_back(ending(row[0]), ending(row[1]));
    for (std::size_t m = 0; m < metrics.size(); ++m) {
      trials.values[m].a.push_back(store::number_in(row[2 + 2 * m]).value_or(stats::kUnknown));
      trials.values[m].b.push_back(store::number_in(row[3 + 2 * m]).value_or(stats::kUnknown));
    }
  }
}

}  // namespace

ComparedPoints compare_points(const fs::path& store, const std::string& a, const std::string& b,
                              const std::string& suite, const std::vector<ComparedMetric>& metrics) {
  const std::map<std::int64_t, Side> all_a = sides(store, a, suite), all_b = sides(store, b, suite);
  std::vector<std::vector<std::pair<NamedPoint, NamedPoint>>> both;
  std::vector<std::string> suites;
  for (const auto& [id, side] : all_a) {
    const auto other = all_b.find(id);
    if (other == all_b.end()) continue;
    both.push_back(paired(side, other->second));
    suites.push_back(side.points.begin()->second.suite);
  }
  if (both.empty()) refuse(fmt::format("{} and {} are in no suite together", a, b));
  if (both.size() > 1)
    refuse(fmt::format("several suites have both: choose one by --suite: {}", fmt::join(suites, ", ")));
  if (both.front().empty()) refuse(fmt::format("{} and {} have no point under the same conditions", a, b));

  ComparedPoints out;
  out.suite = suites.front();
  out.pairs = std::move(both.front());
  ComparedTrials trials;
  for (const ComparedMetric& metric : metrics) trials.values.push_back({metric.name, {}, {}});
  for (const auto& pair : out.pairs) {
    read(store, pair, metrics, trials);
    out.same_conditions = out.same_conditions && pair.first.conditions == pair.second.conditions;
  }
  if (trials.endings.empty()) refuse("no world was met by both: nothing to compare");
  out.comparison = stats::compare(trials.endings, trials.values);
  return out;
}

}  // namespace moma::run
