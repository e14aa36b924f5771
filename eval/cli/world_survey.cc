#include "eval/cli/world_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <set>

#include "eval/cli/table.h"

namespace moma::cli {
namespace {

using store::Cell;

constexpr std::uint64_t kEnoughFailures = 3;  // the next worlds of the family would only take long to fail as well

/// Of this thread.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

Cell whole(std::uint64_t value) { return static_cast<std::int64_t>(value); }

}  // namespace

void WorldSurvey::make_worlds(const std::vector<Point>& points, std::uint64_t count, std::uint64_t trials) {
  std::vector<const Point*> distinct;
  std::set<std::string> seen;
  for (const Point& point : points) {
    if (point.worlds.size() >= 0) continue;  // frozen
    if (seen.insert(point.robot_digest + point.robot->model->name + point.worlds.to_json().dump()).second)
      distinct.push_back(&point);
  }
  for (std::size_t i = 0; i < distinct.size(); ++i)
    make_worlds(*distinct[i], std::min(trials, count * (i + 1) / distinct.size() - count * i / distinct.size()));
}

void WorldSurvey::make_worlds(const Point& point, std::uint64_t count) {
  for (std::uint64_t index = 0; index < count; ++index) {
    Tally& tally = tallies_[{point.robot->model->name, point.worlds.family_of(index)}];
    if (tally.failed >= kEnoughFailures) continue;
    const double start = processor_seconds();
    try {
      (void)point.worlds.make(point.robot->model, index, &tally.log);
    } catch (const GenerationError& error) {
      if (tally.failed++ == 0) failures_.emplace_back(error.what());
    }
    tally.seconds += processor_seconds() - start;
  }
}

void WorldSurvey::run(const Point& point, const BatchJob& job) {
  double start = 0.0;
  BatchOptions options;
  options.world = [&start](const Point& of, std::uint64_t index) {
    auto world = std::make_shared<const World>(of.worlds.make(of.robot->model, index));
    start = processor_seconds();
    return world;
  };
  const BatchResult result = compute_job(point, job, 0, options);
  if (result.world == nullptr || result.output.row.outcome == Outcome::kError) return;
  const auto found = tallies_.find({point.robot->model->name, result.world->family});
  if (found == tallies_.end()) return;
  ++found->second.trials;
  found->second.trial_seconds += processor_seconds() - start;
}

void WorldSurvey::print(std::ostream& out, bool times) const {
  if (tallies_.empty()) return;
  store::QueryResult made{{"robot", "family", "worlds", "tries each"}, {}};
  if (times) made.columns.insert(made.columns.end(), {"us each", "trials", "ms a trial", "% of a trial"});
  store::QueryResult reasons{{"robot", "family", "rejected", "of %", "because"}, {}};
  for (const auto& [place, tally] : tallies_) {
    const auto& [robot, family] = place;
    const auto worlds = static_cast<double>(std::max<std::uint64_t>(1, tally.log.worlds));
    made.rows.push_back(
        {robot, family, whole(tally.log.worlds), rounded(static_cast<double>(tally.log.tries) / worlds, 0.1)});
    if (times) {
      const double each = tally.seconds / worlds;
      std::vector<Cell>& row = made.rows.back();
      row.emplace_back(rounded(1e6 * each, 1.0));
      row.push_back(whole(tally.trials));
      if (tally.trials > 0) {
        const double trial = tally.trial_seconds / static_cast<double>(tally.trials);
        row.emplace_back(rounded(1e3 * trial, 0.1));
        row.emplace_back(rounded(100.0 * each / trial, 0.01));
      } else {
        row.resize(row.size() + 2);
      }
    }
    // Most frequent first, those of equal count by name.
    std::vector<std::pair<std::string, std::uint64_t>> sorted(tally.log.rejections.begin(), tally.log.rejections.end());
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    for (const auto& [why, count] : sorted)
      reasons.rows.push_back({robot, family, whole(count),
                              rounded(100.0 * static_cast<double>(count) / static_cast<double>(tally.log.tries), 0.1),
                              why});
    for (const auto& [why, count] : tally.log.redraws)
      reasons.rows.push_back({robot, family, whole(count), Cell{}, why + " (drawn again)"});
  }
  std::set<std::string> robots;
  for (const auto& [place, tally] : tallies_) robots.insert(place.first);
  if (robots.size() == 1) {  // the line above names it
    for (store::QueryResult* table : {&made, &reasons}) {
      table->columns.erase(table->columns.begin());
      for (std::vector<Cell>& row : table->rows) row.erase(row.begin());
    }
  }
  write(out, made, Format::kTable);
  if (!reasons.rows.empty()) {
    out << '\n';
    write(out, reasons, Format::kTable);
  }
  out << '\n';
}

}  // namespace moma::cli
