#include "eval/tune/trial_objective.h"
#include "world/scenario/time_bound.h"

#include <fmt/format.h>

#include <stdexcept>

namespace moma::tune {

TrialObjective::TrialObjective(const Tuning& tuning, TrialSource& source, int threads, const std::atomic<bool>* stop)
    : tuning_(tuning), source_(source), points_(tuning) {
  batch_.threads = threads;
  batch_.stop = stop;
  identities_.resize(tuning.suites.size());
  worlds_.resize(tuning.suites.size());
  for (std::size_t part = 0; part < tuning.suites.size(); ++part) {
    scales_.push_back(TrialCost::scale_of(tuning.suites[part].points[tuning.tuned_point[part]]));
  }
}

const std::vector<SuitePoint>* TrialObjective::points_of(const Candidate& candidate) {
  if (candidate != at_) {
    at_ = candidate;
    made_valid_ = true;
    try {
      made_ = points_.make(candidate);
    } catch (const config::ConfigError&) {
      made_valid_ = false;
    }
  }
  return made_valid_ ? &made_ : nullptr;
}

bool TrialObjective::valid(const Candidate& candidate) { return points_of(candidate) != nullptr; }

std::string TrialObjective::key_of(const std::vector<TrialKeys>& keys, const std::vector<SuitePoint>& points,
                                   const WorldOfPart& world) {
  if (!points_.same_worlds()) return keys[world.part].key(points[world.part].worlds.identity(world.index));
  const auto [entry, fresh] = identities_[world.part].try_emplace(world.index);
  if (fresh) entry->second = points[world.part].worlds.identity(world.index);
  return keys[world.part].key(entry->second);
}

std::shared_ptr<const World> TrialObjective::world(const SuitePoint& point, std::size_t part, std::uint64_t index) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = worlds_[part].find(index);
    if (found != worlds_[part].end()) return found->second;
  }
  World drawn = point.worlds.make(point.robot->model, index);
  drawn.time_bound = time_bound(point.robot->model, drawn).time;
  auto made = std::make_shared<const World>(std::move(drawn));
  const std::lock_guard lock(mutex_);
  return worlds_[part].emplace(index, std::move(made)).first->second;
}

std::vector<double> TrialObjective::measure(const Candidate& candidate, std::span<const std::uint64_t> numbers) {
  const std::vector<SuitePoint>* points = points_of(candidate);
  if (points == nullptr) throw std::logic_error("a contradictory candidate was measured");
  std::vector<TrialKeys> keys;
  for (const SuitePoint& point : *points) keys.emplace_back(point);

  std::vector<BatchJob> jobs;
  for (const std::uint64_t number : numbers) {
    const WorldOfPart at = world_of(tuning_, number);
    jobs.push_back({at.part, at.index, key_of(keys, *points, at)});
  }
  BatchOptions batch = batch_;
  if (on_trial) batch.progress = [this](const BatchProgress&) { on_trial(); };
  if (points_.same_worlds()) {
    batch.world = [this, points](const SuitePoint& point, std::uint64_t index) {
      return world(point, static_cast<std::size_t>(&point - points->data()), index);
    };
  }
  const std::vector<TrialRow> rows = trial_rows(*points, jobs, batch, &source_, counts_);

  std::vector<double> values;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const BatchJob& job = jobs[i];
    const TrialRow& row = rows[i];
    try {
      values.push_back(tuning_.config.cost(row, scales_[job.point]));
      for (const MetricBound& bound : tuning_.config.bounds) values.push_back(bound_value(bound, row));
    } catch (const NullMetric& error) {
      throw NullMetric(fmt::format("{} (world {}, trial {})", error.what(), job.world, job.key.substr(0, 16)));
    }
  }
  return values;
}

}  // namespace moma::tune
