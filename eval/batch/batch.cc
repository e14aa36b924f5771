#include "eval/batch/batch.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <stdexcept>

#include "eval/trial/key.h"

namespace moma {
namespace {

// Finished results wait in a window until all earlier ones are there. The thread that completes the window's front
// delivers.
class OrderedDelivery final : public JobBoard {
 public:
  OrderedDelivery(std::span<const BatchJob> jobs, const std::vector<std::size_t>& todo, std::size_t window,
                  const BatchOptions& options, const BatchSink& sink)
      : jobs_(jobs), todo_(todo), options_(options), sink_(sink), slots_(window) {}

  // Returns the next position of `todo` to compute, or nothing. Blocks while the window is full: the job at its front
  // is always in progress, so that the wait ends. With remote computers it also waits for jobs that they may give back,
  // until all are delivered.
  std::optional<std::size_t> take() {
    std::unique_lock lock(mutex_);
    while (!over()) {
      if (const auto place = available()) return place;
      if (taken_ >= todo_.size() && options_.remote == nullptr) return std::nullopt;
      room_.wait_for(lock, std::chrono::milliseconds(100));  // a signal sets the stop flag but wakes no thread
    }
    return std::nullopt;
  }

  std::optional<std::size_t> try_take() override {
    const std::unique_lock lock(mutex_);
    return over() ? std::nullopt : available();
  }
  const BatchJob& job(std::size_t place) const override { return jobs_[todo_[place]]; }
  void give_back(std::size_t place) override {
    const std::unique_lock lock(mutex_);
    returned_.push_back(place);
    room_.notify_all();
  }
  bool closed() const override {
    const std::unique_lock lock(mutex_);
    return over();
  }

  void put(std::size_t position, BatchResult&& result) override {
    std::unique_lock lock(mutex_);
    slots_[position % slots_.size()] = std::move(result);
    if (delivering_) return;
    delivering_ = true;
    while (!closed_ && delivered_ < taken_ && slots_[delivered_ % slots_.size()].has_value()) {
      BatchResult next = std::move(*slots_[delivered_ % slots_.size()]);
      slots_[delivered_ % slots_.size()].reset();
      const BatchJob& job = this->job(delivered_);
      const Outcome outcome = next.output.row.outcome;
      lock.unlock();
      bool go_on = false;
      std::exception_ptr error;
      try {
        go_on = sink_(job, std::move(next));
        if (options_.progress) report(outcome);
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      if (error != nullptr) {
        error_ = error;
        closed_ = true;
      } else {
        ++delivered_;
        closed_ = closed_ || !go_on;
      }
      room_.notify_all();
    }
    delivering_ = false;
  }

  void fail(std::exception_ptr error) {
    const std::unique_lock lock(mutex_);
    error_ = std::move(error);
    closed_ = true;
    room_.notify_all();
  }

  std::size_t delivered() const { return delivered_; }
  void rethrow() const {
    if (error_ != nullptr) std::rethrow_exception(error_);
  }
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  bool over() const {
    const bool stopped = options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed);
    return closed_ || stopped || delivered_ >= todo_.size();
  }
  std::optional<std::size_t> available() {
    if (!returned_.empty()) {
      const std::size_t place = returned_.back();
      returned_.pop_back();
      return place;
    }
    if (taken_ < todo_.size() && taken_ < delivered_ + slots_.size()) return taken_++;
    return std::nullopt;
  }

  // Only the delivering thread calls this.
  void report(Outcome outcome) {
    ++progress_.done;
    progress_.total = todo_.size();
    progress_.successes += outcome == Outcome::kSuccess ? 1 : 0;
    progress_.errors += outcome == Outcome::kError ? 1 : 0;
    const double passed = seconds();
    progress_.rate = passed > 0.0 ? static_cast<double>(progress_.done) / passed : 0.0;
    options_.progress(progress_);
  }

  std::span<const BatchJob> jobs_;
  const std::vector<std::size_t>& todo_;
  const BatchOptions& options_;
  const BatchSink& sink_;
  mutable std::mutex mutex_;
  std::condition_variable room_;
  std::vector<std::optional<BatchResult>> slots_;
  std::vector<std::size_t> returned_;
  std::size_t taken_ = 0;
  std::size_t delivered_ = 0;
  BatchProgress progress_;
  bool delivering_ = false;
  bool closed_ = false;
  std::exception_ptr error_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Selects the jobs to compute: neither skipped nor repeated.
std::vector<std::size_t> select(std::span<const SuitePoint> points, std::span<const BatchJob> jobs,
                                const BatchOptions& options) {
  std::vector<std::size_t> todo;
  std::unordered_set<std::string_view> seen;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (jobs[i].point >= points.size())
      throw std::invalid_argument(fmt::format("job {} names point {} of {}", i, jobs[i].point, points.size()));
    if (options.skip != nullptr && options.skip->contains(jobs[i].key)) continue;
    if (jobs[i].key.empty() || seen.insert(jobs[i].key).second) todo.push_back(i);
  }
  return todo;
}

}  // namespace

BatchResult compute_job(const SuitePoint& point, const BatchJob& job, const BatchOptions& options) {
  BatchResult result;
  std::optional<ProfileClock> profile;
  if (options.profile) profile.emplace(TrialPart::kWorld);
  ProfileClock* const clock = profile ? &*profile : nullptr;
  try {
    if (options.world) {
      result.world = options.world(point, job.world);
    } else {
      World world = point.worlds.make(point.robot->model, job.world, nullptr, job.moves);
      if (!options.time_bound) world.time_bound = std::numeric_limits<double>::infinity();
      result.world = std::make_shared<const World>(std::move(world));
    }
    if (result.world == nullptr) throw std::runtime_error(fmt::format("there is no world {}", job.world));
    result.output = run_trial(point, *result.world, options.parts, clock);
    if (options.finish) options.finish(point, result);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    result.output = {};
    result.output.row.outcome = Outcome::kError;
    result.output.row.reason = fmt::format("world {}: {}", job.world, e.what());
  }
  if (clock != nullptr) {
    result.profile = clock->stop();
    result.profile.trials = 1;
    result.profile.steps = result.output.row.steps;
  }
  return result;
}

BatchSummary run_batch(std::span<const SuitePoint> points, std::span<const BatchJob> jobs, const BatchOptions& options,
                       const BatchSink& sink) {
  const std::vector<std::size_t> todo = select(points, jobs, options);
  const int wanted = options.threads > 0 ? options.threads : omp_get_num_procs();
  const int threads = std::max(1, std::min(wanted, static_cast<int>(std::min<std::size_t>(todo.size(), 4096))));
  const std::size_t elsewhere = options.remote != nullptr ? options.remote->capacity() : 0;
  const std::size_t computers = static_cast<std::size_t>(threads) + elsewhere;
  OrderedDelivery delivery(jobs, todo, std::max<std::size_t>(16, 4 * computers), options, sink);
  const int team = threads + (options.remote != nullptr ? 1 : 0);
#pragma omp parallel num_threads(team) if (team > 1)
  {
    if (options.remote != nullptr && omp_get_thread_num() == 0) {
      try {
        options.remote->serve(delivery);
      } catch (...) {
        delivery.fail(std::current_exception());
      }
    }
    try {
      while (const std::optional<std::size_t> position = delivery.take()) {
        const BatchJob& job = delivery.job(*position);
        delivery.put(*position, compute_job(points[job.point], job, options));
      }
    } catch (...) {
      delivery.fail(std::current_exception());
    }
  }
  delivery.rethrow();
  return {delivery.delivered(), delivery.delivered() < todo.size(), delivery.seconds()};
}

std::vector<BatchJob> make_jobs(std::span<const SuitePoint> points, std::uint64_t first, std::uint64_t count) {
  std::vector<TrialKeys> keys;
  // Points that share a worlds section share the worlds' identities, which are computed once per world.
  std::vector<std::size_t> group;
  std::map<std::string, std::size_t> groups;
  for (const SuitePoint& point : points) {
    keys.emplace_back(point);
    group.push_back(groups.emplace(point.worlds.to_json().dump(), groups.size()).first->second);
  }
  std::vector<BatchJob> jobs;
  jobs.reserve(points.size() * count);
  std::vector<Json> identities(groups.size());
  for (std::uint64_t world = first; world < first + count; ++world) {
    for (auto& identity : identities) identity = nullptr;
    for (std::size_t p = 0; p < points.size(); ++p) {
      Json& identity = identities[group[p]];
      if (identity.is_null()) identity = points[p].worlds.identity(world);
      jobs.push_back({p, world, keys[p].key(identity)});
    }
  }
  return jobs;
}

}  // namespace moma
