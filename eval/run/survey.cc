#include "eval/run/survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

namespace moma::run {
namespace {

constexpr std::uint64_t kEnoughFailures = 3;  // further worlds of the family would take long and fail as well

/// Processor time of this thread.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

void WorldSurvey::make_worlds(const std::vector<SuitePoint>& points, std::uint64_t count, std::uint64_t trials) {
  std::map<std::string, std::size_t> known;
  std::vector<std::size_t> drawn;
  groups_.clear();
  for (const SuitePoint& point : points) {
    const auto [it, first] = known.try_emplace(
        point.robot_digest + point.robot->model->name + point.worlds.to_json().dump(), groups_.size());
    if (first) {
      if (point.worlds.size() < 0) drawn.push_back(groups_.size());
      groups_.emplace_back();
    }
    groups_[it->second].points.push_back(&point);
  }
  for (std::size_t i = 0; i < drawn.size(); ++i)
    make_worlds(groups_[drawn[i]], std::min(trials, count * (i + 1) / drawn.size() - count * i / drawn.size()));
  for (Group& group : groups_) look_at_frozen(group, std::min(trials, count));
}

void WorldSurvey::make_worlds(Group& group, std::uint64_t count) {
  const SuitePoint& point = *group.points.front();
  for (std::uint64_t index = 0; index < count; ++index) {
    Tally& tally = tallies_[{point.robot->model->name, point.worlds.family_of(index)}];
    if (tally.failed >= kEnoughFailures) continue;
    const double start = processor_seconds();
    double seconds = 0.0;
    try {
      const World world = point.worlds.make(point.robot->model, index, &tally.log);
      seconds = processor_seconds() - start;
      look_at(world, point.robot->model, group.look);
    } catch (const GenerationError& error) {
      seconds = processor_seconds() - start;
      if (tally.failed++ == 0) failures_.emplace_back(error.what());
    }
    tally.seconds += seconds;
  }
}

void WorldSurvey::look_at_frozen(Group& group, std::uint64_t count) {
  const SuitePoint& point = *group.points.front();
  const auto size = static_cast<std::uint64_t>(std::max(0LL, point.worlds.size()));
  try {
    for (std::uint64_t index = 0; index < std::min(size, count); ++index)
      look_at(point.worlds.make(point.robot->model, index), point.robot->model, group.look);
  } catch (const GenerationError& error) {  // worlds of another robot
    failures_.emplace_back(error.what());
  }
}

std::vector<std::string> WorldSurvey::doubts() const {
  std::vector<std::string> out;
  for (const Group& group : groups_) {
    const WorldLook& look = group.look;
    const std::string robot = groups_.size() > 1 ? "robot " + group.points.front()->robot->model->name + ": " : "";
    if (look.in_touch > 0)
      out.push_back(fmt::format("{}{} of {} worlds start in contact, which counts as a collision (first: {})", robot,
                                look.in_touch, look.goals.size(), look.first_touch));
    for (const std::string& text : touching_goals(look)) out.push_back(robot + text);
    for (const std::string& text : goal_warnings(group.points, look)) out.push_back(robot + text);
  }
  return out;
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
    // The golden ratio spreads the first few worlds evenly, so that families occur as often as in the whole.
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
