#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "eval/suite/suite.h"
#include "eval/trial/trial.h"
#include "world/world.h"

namespace moma {

/// One trial to compute: a point of the suite in one world.
struct BatchJob {
  std::size_t point = 0;                         ///< index into the points of run_batch()
  std::uint64_t world = 0;                       ///< world index
  std::string key;                               ///< trial_key() of point and world
  std::shared_ptr<const Moves> moves = nullptr;  ///< of the world's random numbers; null: none
};

/// Returns every point in the worlds first .. first + count - 1, world by world: all points meet the first world, then
/// the next one, and so on. The results before an early stop are therefore still a fair comparison. A shard is any
/// subset of these jobs, in any order.
std::vector<BatchJob> make_jobs(std::span<const SuitePoint> points, std::uint64_t first, std::uint64_t count);

/// The result of one job, as the sink gets it.
struct BatchResult {
  std::shared_ptr<const World> world;  ///< null if the world could not be made (outcome `error` has the reason)
  TrialOutput output;
  std::vector<double> metrics;  ///< set by BatchOptions::finish: the suite's own metrics, NaN for a missing one
  Profile profile;              ///< filled with BatchOptions::profile: times of the parts of this job
};

struct BatchOptions;

/// Computes one job: makes the world, runs the trial, finishes it. A failure becomes the row's reason. Throws
/// std::bad_alloc alone, since a machine without memory says nothing about the trial.
BatchResult compute_job(const SuitePoint& point, const BatchJob& job, const BatchOptions& options);

/// Receives the results in the order of the jobs (`job` is the one in run_batch()'s span), from one thread at a time
/// (not always the same one). Returning false ends the batch: no later result is delivered, so that the end does not
/// depend on the number of threads. An exception ends the batch as well and leaves run_batch().
using BatchSink = std::function<bool(const BatchJob& job, BatchResult&& result)>;

struct BatchProgress {
  std::size_t done = 0;   ///< delivered to the sink
  std::size_t total = 0;  ///< jobs to compute, after skips
  std::size_t successes = 0;
  std::size_t errors = 0;  ///< trials that ended by an error
  double rate = 0.0;       ///< trials per second since the start
};

/// The interface through which remote computers take jobs, addressed by their place in the order of delivery. For one
/// thread.
class JobBoard {
 public:
  virtual ~JobBoard() = default;
  /// Returns the next place, or nothing if none is available now.
  virtual std::optional<std::size_t> try_take() = 0;
  virtual const BatchJob& job(std::size_t place) const = 0;
  /// Accepts the result of a taken place; once per place.
  virtual void put(std::size_t place, BatchResult&& result) = 0;
  /// Returns a place without a result, for another computer.
  virtual void give_back(std::size_t place) = 0;
  /// True once no place will be taken any more.
  virtual bool closed() const = 0;
};

/// Remote computers that take part in a batch; eval/batch/cluster.h implements them by MPI.
class RemoteCompute {
 public:
  virtual ~RemoteCompute() = default;
  /// The largest number of places taken at once.
  virtual std::size_t capacity() const = 0;
  /// Takes places, distributes them and puts results until board.closed() or no computer is left, and no place is taken
  /// any more. The thread that called run_batch() calls this, and computes remaining jobs itself afterwards.
  virtual void serve(JobBoard& board) = 0;
};

struct BatchOptions {
  int threads = 0;                                        ///< 0: one per core
  const std::atomic<bool>* stop = nullptr;                ///< if set, trials in flight finish and are delivered
  const std::unordered_set<std::string>* skip = nullptr;  ///< keys of trials that need no computing
  std::function<void(const BatchProgress&)> progress;     ///< called after each delivery, in the sink's thread
  /// Source of worlds, by default point.worlds.make(); called from many threads. Searches that meet the same worlds
  /// thousands of times use a cache here.
  std::function<std::shared_ptr<const World>(const SuitePoint&, std::uint64_t)> world;
  bool time_bound = true;  ///< compute time_bound_s, and what follows from it, in worlds that are made here
  TrialParts parts;        ///< replacements for plants or controllers
  bool profile = false;    ///< fill BatchResult::profile
  /// Called with each result in the thread that computed it, before delivery.
  std::function<void(const SuitePoint&, BatchResult&)> finish;
  RemoteCompute* remote = nullptr;  ///< computes beside the threads, which are then one more than `threads`
};

struct BatchSummary {
  std::size_t delivered = 0;
  bool stopped = false;  ///< ended before the last job, by `stop` or by the sink
  double seconds = 0.0;
};

/// Runs the jobs over OpenMP threads, jobs with one key once. All results but timings are the same for any number of
/// threads. At most a few dozen finished results wait for an earlier one, so memory stays bounded. A trial that throws
/// becomes a row with outcome `error`. Throws the sink's exceptions, std::bad_alloc, and std::invalid_argument for a
/// job without a point.
BatchSummary run_batch(std::span<const SuitePoint> points, std::span<const BatchJob> jobs, const BatchOptions& options,
                       const BatchSink& sink);

}  // namespace moma
