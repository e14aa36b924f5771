#include "eval/run/moved_trials.h"

#include <fmt/format.h>

#include <optional>

#include "eval/run/store_file.h"
#include "eval/store/machine.h"
#include "eval/store/records.h"
#include "eval/trial/key.h"
#include "world/draws.h"

namespace moma::run {
namespace {

/// Trials of moved worlds in a store, except errors.
class MovedSource : public StoredTrials {
 public:
  explicit MovedSource(store::Writer& writer) : StoredTrials(writer, Of::kSearch) {}
  void add(const SuitePoint& point, const BatchJob& job, const BatchResult& result) override {
    if (result.output.row.outcome != Outcome::kError) StoredTrials::add(point, job, result);
  }
};

}  // namespace

std::shared_ptr<const Moves> noise_drawn_again(int number) {
  const std::uint32_t mask =
      1U << static_cast<unsigned>(Stream::kSensing) | 1U << static_cast<unsigned>(Stream::kDisturbance);
  return std::make_shared<Moves>(Moves{{static_cast<std::uint64_t>(number), 1.0, 1.0, mask}});
}

void check_drawn(const Suite& suite, std::string_view command) {
  for (const SuitePoint& point : suite.points) {
    if (!point.worlds.shares().empty()) continue;
    throw RunError(
        fmt::format("{}: needs worlds that are drawn by families; frozen worlds and scenes cannot be moved", command));
  }
}

std::vector<TrialRow> MovedTrials::rows(std::size_t point, std::span<const MovedWorld> worlds, bool progress) {
  const SuitePoint& of = suite_.points[point];
  const TrialKeys keys(of);
  std::vector<BatchJob> jobs;
  for (const auto& [index, moves] : worlds)
    jobs.push_back({point, index, keys.key(of.worlds.identity(index, moves ? *moves : Moves())), moves});
  BatchOptions batch;
  batch.threads = threads_of(request_);
  batch.stop = request_.stop;
  batch.remote = request_.cluster;
  if (progress) batch.progress = listener_.progress;
  batch.time_bound = time_bound_;
  batch.finish = [](const SuitePoint&, BatchResult& result) { Trace().swap(result.output.trace); };
  std::optional<MovedSource> source;
  if (writer_ != nullptr) source.emplace(*writer_);
  std::vector<TrialRow> rows = trial_rows(suite_.points, jobs, batch, source ? &*source : nullptr, counts_);
  if (progress) listener_.progress_end();
  return rows;
}

void MovedTrials::keep(const Json& estimates) {
  if (writer_ != nullptr) writer_->keep_risk(estimates.dump());
}

Ended with_moved_trials(const Request& request, const Suite& suite, std::string_view level, const Listener& listener,
                        const std::function<void(MovedTrials&)>& work) {
  if (request.cluster != nullptr) {
    Json alone = suite.resolved;  // without what of a trial is not kept here
    alone["samples"] = "none";
    alone.erase("metrics");
    request.cluster->lead(alone.dump(), store::this_machine().machine_class, listener.notice);
  }
  std::optional<store::RunLock> lock;
  std::optional<store::Writer> writer;
  if (!request.file.empty()) {
    lock.emplace(request.file, request.stop, listener.notice);
    if (!lock->held()) return {End::kNeverBegan, "stopped while waiting; nothing was done"};
    writer.emplace(request.file);
    tell_opened(*writer, *lock, request.file, listener);
    store::SuiteRecord record = store::describe(suite);
    record.metrics.clear();  // metrics of single trials are for trials that belong to a point
    writer->begin(record, {request.arguments, threads_of(request)}, {});
  }
  try {
    MovedTrials trials(suite, writer ? &*writer : nullptr, level, request, listener);
    work(trials);
    listener.note(
        fmt::format("{} trials computed, {} taken from the store", trials.counts().computed, trials.counts().reused));
    if (writer) writer->finish(store::RunStatus::kFinished);
    return {};
  } catch (const Interrupted& why) {
    listener.progress_end();
    if (*why.what() != '\0') listener.warning(why.what());
    if (writer) writer->finish(store::RunStatus::kStopped);
    return {End::kStopped, writer ? stopped_text("", "everything computed is", request.file, request.arguments)
                                  : "stopped; nothing is saved without --output"};
  } catch (...) {
    if (writer) writer->fail();
    throw;
  }
}

}  // namespace moma::run
