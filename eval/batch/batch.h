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

/// One trial to do: a point of the suite in one world.
struct BatchJob {
  std::size_t point = 0;    ///< index into the points given to run_batch()
  std::uint64_t world = 0;  ///< world index
  std::string key;          ///< trial_key() of the two
};

/// Every point in worlds 0 .. trials-1, world by world (all points meet world 0, then world 1, ...), so that what
/// an early stop leaves is still a fair comparison. A shard is any subset of these, in any order.
std::vector<BatchJob> make_jobs(const Suite& suite);
/// The same for chosen worlds first .. first + count - 1.
std::vector<BatchJob> make_jobs(std::span<const SuitePoint> points, std::uint64_t first, std::uint64_t count);

/// What one job gave, handed to the sink.
struct BatchResult {
  std::size_t job = 0;                 ///< position in the span of jobs
  std::shared_ptr<const World> world;  ///< null where the world could not be made (outcome `error` says why)
  TrialOutput output;
  std::vector<double> metrics;  ///< for BatchOptions::finish: the suite's own metrics, NaN where a trial has none
  Profile profile;              ///< for BatchOptions::profile: where the time of the computer that computed it went
};

struct BatchOptions;

/// Makes the world, runs the trial, finishes it: one job, whoever computes it. What went wrong is the row's
/// reason; throws std::bad_alloc alone, since a machine without memory says nothing of the trial.
BatchResult compute_job(const SuitePoint& point, const BatchJob& job, std::size_t position,
                        const BatchOptions& options);

/// Called in the order of the jobs, by one thread at a time (not always the same one). Return false to end the
/// batch: no later result is delivered, so that where it ends does not depend on the number of threads.
/// An exception ends the batch too and comes out of run_batch().
using BatchSink = std::function<bool(const BatchJob& job, BatchResult&& result)>;

struct BatchProgress {
  std::size_t done = 0;   ///< delivered to the sink
  std::size_t total = 0;  ///< to do, after skips
  std::size_t successes = 0;
  std::size_t errors = 0;  ///< ended by an error: no part of a rate
  double seconds = 0.0;    ///< since the start
  double rate = 0.0;       ///< trials per second since the start
};

/// What run_batch() offers to computers elsewhere: jobs by their place in the order of delivery. For one thread.
class JobBoard {
 public:
  virtual ~JobBoard() = default;
  /// The next place, or nothing where none can be taken at this moment.
  virtual std::optional<std::size_t> try_take() = 0;
  virtual const BatchJob& job(std::size_t place) const = 0;
  /// The result of a place that was taken; once.
  virtual void put(std::size_t place, BatchResult&& result) = 0;
  /// A place whose result will not come: another computer gets it.
  virtual void give_back(std::size_t place) = 0;
  /// Nothing will be taken any more.
  virtual bool closed() const = 0;
};

/// Computers elsewhere that take part in a batch; eval/batch/cluster.h has those of MPI.
class RemoteCompute {
 public:
  virtual ~RemoteCompute() = default;
  /// Most trials that are out at once.
  virtual std::size_t capacity() const = 0;
  /// Takes, hands out and puts until board.closed() or no computer is left, and nothing is out any more. Called by
  /// the thread that called run_batch(), which computes itself afterwards if there is still something to do.
  virtual void serve(JobBoard& board) = 0;
};

struct BatchOptions {
  int threads = 0;                                        ///< 0: one per core
  const std::atomic<bool>* stop = nullptr;                ///< set: trials in flight finish and are delivered
  const std::unordered_set<std::string>* skip = nullptr;  ///< keys that need no computing
  std::function<void(const BatchProgress&)> progress;     ///< after each delivery, from the sink's thread
  /// Where worlds come from; by default point.worlds.make(). Called from many threads. A cache for searches
  /// that meet the same worlds thousands of times goes here.
  std::function<std::shared_ptr<const World>(const SuitePoint&, std::uint64_t)> world;
  TrialParts parts;      ///< other plants or controllers
  bool profile = false;  ///< results tell where their time went
  /// Called on what a trial gave by the thread that computed it, before it is handed on.
  std::function<void(const SuitePoint&, BatchResult&)> finish;
  RemoteCompute* remote = nullptr;  ///< computes beside the threads; those then run on one thread more than `threads`
};

struct BatchSummary {
  std::size_t delivered = 0;
  std::size_t skipped = 0;     ///< keys in `skip`
  std::size_t duplicates = 0;  ///< jobs whose key an earlier job of this batch has: computed once, delivered once
  std::size_t successes = 0;
  std::size_t errors = 0;
  bool stopped = false;  ///< ended before the last job, by `stop` or by the sink
  double seconds = 0.0;
};

/// Runs the jobs over OpenMP threads. Every result but timings is the same for any number of threads. At most a few
/// dozen finished results wait for an earlier one, so memory stays bounded. A trial that throws is a row with
/// outcome `error`. Throws what the sink throws, std::bad_alloc, std::invalid_argument for a job of no point.
BatchSummary run_batch(std::span<const SuitePoint> points, std::span<const BatchJob> jobs, const BatchOptions& options,
                       const BatchSink& sink);

}  // namespace moma
