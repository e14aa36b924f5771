#include "eval/run/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_set>

#include "controller/config/json_node.h"
#include "eval/batch/sequential.h"
#include "eval/run/store_file.h"
#include "eval/run/warnings.h"
#include "eval/store/machine.h"
#include "eval/store/writer.h"
#include "eval/suite/controller_entry.h"
#include "eval/trial/trial.h"

namespace moma::run {
namespace {

/// Adds the time until the end of the block to the store's part.
class StoreTime {
 public:
  StoreTime(bool on, Profile& profile) : profile_(profile) {
    if (on) clock_.emplace(TrialPart::kStore);
  }
  ~StoreTime() {
    if (clock_) profile_ += clock_->stop();
  }
  StoreTime(const StoreTime&) = delete;
  StoreTime& operator=(const StoreTime&) = delete;

 private:
  std::optional<ProfileClock> clock_;
  Profile& profile_;
};

class Run {
 public:
  Run(const EvaluateRequest& request, const Suite& suite, const Listener& listener)
      : request_(request), suite_(suite), listener_(listener), finish_(finishing(suite)) {
    if (suite.until && request.shard.count > 1) {
      throw RunError(
          "run: --shard needs a fixed number of trials: the end of 'trials: {until: ...}' depends on all worlds");
    }
    const Shard& shard = request.shard;
    result_.file = request.file;
    if (result_.file.empty()) {
      result_.file = usual_store(
          suite.name, shard.count > 1 ? fmt::format(".shard-{}-of-{}", shard.index, shard.count) : std::string());
    }
    threads_ = threads_of(request);
  }

  Evaluation execute() {
    if (request_.cluster != nullptr)
      request_.cluster->lead(suite_.resolved.dump(), store::this_machine().machine_class, listener_.notice);
    const store::RunLock lock(result_.file, request_.stop, listener_.notice);
    if (!lock.held()) {
      result_.end = End::kNeverBegan;
      result_.stopped = "stopped while waiting; nothing was done";
      return std::move(result_);
    }
    store::Writer writer(result_.file);
    tell_opened(writer, lock, result_.file, listener_);
    try {
      suite_.until ? run_until(writer) : run_fixed(writer);
    } catch (...) {
      writer.fail();
      throw;
    }
    result_.suite = writer.suite_name();
    result_.warnings = row_warnings_.sentences();
    const SameError::Found* error = same_error_.found();
    const std::uint64_t enough = std::min<std::uint64_t>(SameError::kEnough, suite_.trials);
    if (error != nullptr && static_cast<std::uint64_t>(error->trials) >= enough && !request_.keep_going)
      tell_same_error(*error);
    return std::move(result_);
  }

 private:
  std::vector<BatchJob> jobs_of(std::uint64_t first, std::uint64_t count) const {
    std::vector<BatchJob> jobs = make_jobs(suite_.points, first, count);
    if (request_.shard.count > 1)
      std::erase_if(jobs, [&](const BatchJob& job) { return !request_.shard.has(job.world); });
    return jobs;
  }

  static std::vector<store::Wanted> wanted(const std::vector<BatchJob>& jobs) {
    std::vector<store::Wanted> wanted;
    wanted.reserve(jobs.size());
    for (const BatchJob& job : jobs) wanted.push_back({job.point, job.world, job.key});
    return wanted;
  }

  std::unordered_set<std::string> begin(store::Writer& writer, const std::vector<BatchJob>& jobs) {
    const StoreTime time(request_.profile, result_.profile);
    auto present = writer.begin(store::describe(suite_), {request_.arguments, threads_}, wanted(jobs));
    tell_names(writer);
    return present;
  }

  void run_fixed(store::Writer& writer) {
    const std::vector<BatchJob> jobs = jobs_of(0, suite_.trials);
    const auto present = begin(writer, jobs);
    const std::size_t there = count_present(jobs, present);
    const std::string of =
        request_.shard.count > 1 ? fmt::format(" of shard {} of {}", request_.shard.index, request_.shard.count) : "";
    if (there == jobs.size()) {
      listener_.note(fmt::format("{} of {} trials{} already there: nothing left to do", there, jobs.size(), of));
    } else if (there > 0) {
      listener_.note(fmt::format("{} of {} trials{} already there, {} to do, on {}", there, jobs.size(), of,
                                 jobs.size() - there, computers()));
    } else {
      listener_.note(fmt::format("{} trials{} to do, on {}: {}", jobs.size(), of, computers(), result_.file.string()));
    }
    const BatchSummary summary = compute(writer, jobs, present);
    if (late_ > 0) return incomplete();
    if (!summary.stopped) {
      if (summary.delivered > 0)
        listener_.note(fmt::format("{} trials in {:.1f} s", summary.delivered, summary.seconds));
      return;
    }
    stopped(there + summary.delivered, fmt::format("{}", jobs.size()));
  }

  void run_until(store::Writer& writer) {
    const UntilRule& until = *suite_.until;
    SequentialRule rule(until, suite_.points.size());
    std::size_t there = 0;
    std::size_t done = 0;
    for (std::uint64_t worlds = rule.next_block(); worlds > 0; worlds = rule.next_block()) {
      const std::vector<BatchJob> jobs = jobs_of(rule.worlds(), worlds);
      const auto present = rule.worlds() == 0 ? begin(writer, jobs) : writer.extend(wanted(jobs));
      if (rule.worlds() == 0) {
        listener_.note(
            fmt::format("until the {} rate of every point is known to +-{:g} %, at most {} worlds: on {}, {}",
                        until.metric, 100.0 * until.half_width, until.max, computers(), result_.file.string()));
      }
      there += count_present(jobs, present);
      const BatchSummary summary = compute(writer, jobs, present);
      done += summary.delivered;
      if (late_ > 0) return incomplete();
      if (summary.stopped)
        return stopped(there + done, fmt::format("at most {}", suite_.trials * suite_.points.size()));
      for (const BatchJob& job : jobs) {
        const std::optional<TrialRow> row = writer.find(job.key);
        if (row) rule.add(job.point, row->outcome);
      }
      rule.end_block(worlds);
      listener_.note(
          fmt::format("{} worlds: the widest interval is +-{:.2f} %", rule.worlds(), 100.0 * rule.half_width()));
    }
    writer.finish(store::RunStatus::kFinished);
    listener_.note(fmt::format("{} after {} worlds: {} trials, {} of them were there already",
                               rule.reached() ? "reached" : "NOT reached", rule.worlds(), there + done, there));
  }

  static std::size_t count_present(const std::vector<BatchJob>& jobs, const std::unordered_set<std::string>& present) {
    return static_cast<std::size_t>(
        std::ranges::count_if(jobs, [&](const BatchJob& job) { return present.count(job.key) > 0; }));
  }

  std::string computers() const {
    const std::string threads = fmt::format("{} thread{}", threads_, threads_ == 1 ? "" : "s");
    return request_.cluster == nullptr ? threads
                                       : fmt::format("{} ranks with {} each", request_.cluster->size(), threads);
  }

  void tell_names(const store::Writer& writer) const {
    if (writer.suite_name() != suite_.name) {
      listener_.note(fmt::format("{} already holds another setting of suite {}: this one is kept apart as {}",
                                 result_.file.string(), suite_.name, writer.suite_name()));
    }
    for (std::size_t i = 0; i < suite_.points.size(); ++i) {
      if (writer.controller_name(i) != suite_.points[i].controller) {
        listener_.note(fmt::format("{} already holds other parameters of controller {}: these are kept apart as {}",
                                   result_.file.string(), suite_.points[i].controller, writer.controller_name(i)));
      }
    }
  }

  BatchSummary compute(store::Writer& writer, const std::vector<BatchJob>& jobs,
                       const std::unordered_set<std::string>& present) {
    BatchOptions batch;
    batch.threads = threads_;
    batch.stop = request_.stop;
    batch.skip = &present;
    batch.remote = request_.cluster;
    batch.finish = finish_;
    batch.profile = request_.profile;
    batch.progress = listener_.progress;
    const auto sink = [&](const BatchJob& job, BatchResult&& result) {
      result_.profile += result.profile;
      const StoreTime time(request_.profile, result_.profile);
      if (is_late(result.output.row)) {
        if (late_++ == 0) first_late_ = result.output.row.reason;
        return request_.keep_going || late_ < SameError::kEnough;
      }
      const SuitePoint& point = suite_.points[job.point];
      const store::WorldRecord world = world_record(point, job, result);
      row_warnings_.look(result.output.row, has_qp(point) && point.controller_params.prediction.identify);
      same_error_.look(job.point, result.output.row);
      const Trace& trace = result.output.trace;
      writer.add({job.point, job.world, job.key}, world, result.output.row, trace.empty() ? nullptr : &trace,
                 result.metrics);
      return request_.keep_going || !same_error_.enough();
    };
    try {
      const BatchSummary summary = run_batch(suite_.points, jobs, batch, sink);
      const StoreTime time(request_.profile, result_.profile);
      if (summary.stopped || late_ > 0) {
        writer.finish(store::RunStatus::kStopped);
      } else if (!suite_.until) {
        writer.finish(store::RunStatus::kFinished);
      }
      listener_.progress_end();
      return summary;
    } catch (const store::StoreError& error) {
      listener_.progress_end();
      throw store::StoreError(error.kind(), fmt::format("{}\n{} trials of this run are saved{}", error.what(),
                                                        writer.committed(), how_to_go_on(error.kind())));
    }
  }

  void stopped(std::size_t saved, const std::string& of) {
    result_.end = End::kStopped;
    result_.stopped = stopped_text("", fmt::format("{} of {} trials are", saved, of), result_.file, request_.arguments);
  }

  /// Some trials have no result, because real time ran out.
  void incomplete() {
    result_.end = End::kStopped;
    result_.stopped = fmt::format(
        "incomplete: real time ran out in {} trial{}, the first: {}\n{} not stored: they say how busy this machine "
        "was. To try "
        "again: {}",
        late_, late_ == 1 ? "" : "s", first_late_, late_ == 1 ? "It is" : "They are", command_line(request_.arguments));
  }

  void tell_same_error(const SameError::Found& found) {
    const SuitePoint& point = suite_.points[found.point];
    result_.end = End::kSameError;
    result_.stopped = fmt::format(
        "{}{}: all of its {}{} trials ended by the same error:\n  {}\n{}{} holds what was done", point.controller,
        point.label.empty() ? "" : " " + point.label, same_error_.enough() ? "first " : "", found.trials, found.reason,
        same_error_.enough() ? "stopped (--keep-going runs the rest); " : "", result_.file.string());
  }

  std::string how_to_go_on(store::StoreError::Kind kind) const {
    if (kind != store::StoreError::Kind::kInterrupted) return "";
    return fmt::format("; when that is cured, go on with: {}", command_line(request_.arguments));
  }

  const EvaluateRequest& request_;
  const Suite& suite_;
  const Listener& listener_;
  std::function<void(const SuitePoint&, BatchResult&)> finish_;
  int threads_ = 1;
  RowWarnings row_warnings_;
  SameError same_error_;
  std::size_t late_ = 0;  ///< trials without a result
  std::string first_late_;
  Evaluation result_;
};

}  // namespace

Evaluation evaluate(const EvaluateRequest& request, const Suite& suite, const Listener& listener) {
  return Run(request, suite, listener).execute();
}

void follow(Cluster& cluster, int threads, bool profile) {
  const std::optional<std::string> setup = cluster.setup();
  if (!setup) return;
  Suite suite;
  try {
    suite = suite_from_resolved(config::parse_json(*setup, "the suite of rank 0"),
                                Plugins::kOfStore);  // rank 0 loaded them
  } catch (const std::exception& error) {
    cluster.refuse(error.what());
    return;
  }
  BatchOptions batch;
  batch.threads = threads > 0 ? threads : usual_threads(true);
  batch.finish = finishing(suite);
  batch.profile = profile;
  cluster.work(suite.points, store::this_machine().machine_class, batch);
}

}  // namespace moma::run
