#include "eval/run/survey.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <set>

namespace moma::run {
namespace {

constexpr std::uint64_t kEnoughFailures = 3;  // the next worlds of the family would only take long to fail as well

/// Of this thread.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

void WorldSurvey::make_worlds(const std::vector<SuitePoint>& points, std::uint64_t count, std::uint64_t trials) {
  std::vector<const SuitePoint*> distinct;
  std::set<std::string> seen;
  for (const SuitePoint& point : points) {
    if (point.worlds.size() >= 0) continue;  // frozen
    if (seen.insert(point.robot_digest + point.robot->model->name + point.worlds.to_json().dump()).second)
      distinct.push_back(&point);
  }
  for (std::size_t i = 0; i < distinct.size(); ++i)
    make_worlds(*distinct[i], std::min(trials, count * (i + 1) / distinct.size() - count * i / distinct.size()));
}

void WorldSurvey::make_worlds(const SuitePoint& point, std::uint64_t count) {
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

void WorldSurvey::run(const SuitePoint& point, const BatchJob& job) {
  double start = 0.0;
  BatchOptions options;
  options.world = [&start](const SuitePoint& of, std::uint64_t index) {
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

TrialTime trial_time(const Suite& suite, double enough, WorldSurvey& survey) {
  const auto most = static_cast<std::size_t>(64.0 * std::max(1.0, enough));
  const auto start = std::chrono::steady_clock::now();
  const std::size_t all = static_cast<std::size_t>(suite.trials) * suite.points.size();
  double seconds = 0.0;
  std::size_t n = 0;
  while (n < std::min(all, most) && seconds < enough) {
    // The golden ratio spreads the first few worlds evenly, so that families come up as often as in the whole.
    const auto world = static_cast<std::uint64_t>(std::fmod(static_cast<double>(n) * 0.6180339887498949, 1.0) *
                                                  static_cast<double>(suite.trials));
    BatchJob job;
    job.point = n % suite.points.size();
    job.world = world;
    survey.run(suite.points[job.point], job);
    ++n;
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return {seconds / static_cast<double>(n), n};
}

std::map<std::string, std::uint64_t> family_counts(const Suite& suite) {
  std::map<std::string, std::uint64_t> counts;
  const std::uint64_t looked_at = std::min<std::uint64_t>(suite.trials, 100000);
  for (std::uint64_t i = 0; i < looked_at; ++i) ++counts[suite.points.front().worlds.family_of(i)];
  return counts;
}

}  // namespace moma::run
