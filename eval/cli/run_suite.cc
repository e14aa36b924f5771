#include "eval/cli/run_suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iostream>
#include <map>
#include <memory>

#include "eval/batch/sequential.h"
#include "eval/cli/doubts.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/cli/text.h"
#include "eval/store/database.h"
#include "eval/store/query.h"
#include "eval/store/run_lock.h"
#include "eval/store/user_metrics.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;

void print_summary(const fs::path& file, const std::string& suite) {
  const auto& queries = store::named_queries();
  const auto summary = std::find_if(queries.begin(), queries.end(), [](const auto& q) { return q.name == "summary"; });
  std::string quoted;
  for (const char c : suite) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  write(std::cout, store::query(file, fmt::format("SELECT * FROM ({}) WHERE suite = '{}'", summary->display, quoted)),
        Format::kTable);
  std::cout.flush();
}

/// One evaluation into one store.
class Run {
 public:
  Run(const RunRequest& request, Suite suite, Cluster* cluster)
      : request_(request), suite_(std::move(suite)), cluster_(cluster), finish_(finishing(suite_)) {}

  int execute() {
    const InterruptGuard interrupt;
    const store::RunLock lock(request_.file, InterruptGuard::flag(),
                              [&](const std::string& words) { std::cerr << terminal_safe(words) << std::endl; });
    if (!lock.held()) {
      std::cerr << "stopped while waiting; nothing was done" << std::endl;
      return kStoppedEarly;
    }
    store::Writer writer(request_.file);
    const std::string warning = store::file_system_warning(request_.file);
    if (!warning.empty()) print_warnings({warning});
    const int code = suite_.until ? run_until(writer) : run_fixed(writer);
    print_summary(request_.file, writer.suite_name());
    print_warnings(doubts_.warnings());
    return code;
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
    const int threads = request_.threads;
    auto present = writer.begin(store::describe(suite_), {request_.arguments, threads}, wanted(jobs));
    tell_names(writer);
    return present;
  }

  int run_fixed(store::Writer& writer) {
    const std::vector<BatchJob> jobs = jobs_of(0, suite_.trials);
    const auto present = begin(writer, jobs);
    const std::size_t there = count_present(jobs, present);
    const std::string of =
        request_.shard.count > 1 ? fmt::format(" of shard {} of {}", request_.shard.index, request_.shard.count) : "";
    if (there == jobs.size()) {
      note(fmt::format("{} of {} trials{} already there: nothing left to do", there, jobs.size(), of));
    } else if (there > 0) {
      note(fmt::format("{} of {} trials{} already there, {} to do, on {}", there, jobs.size(), of, jobs.size() - there,
                       computers()));
    } else {
      note(fmt::format("{} trials{} to do, on {}: {}", jobs.size(), of, computers(), request_.file.string()));
    }
    const BatchSummary summary = compute(writer, jobs, present);
    if (!summary.stopped) {
      if (summary.delivered > 0) note(fmt::format("{} trials in {:.1f} s", summary.delivered, summary.seconds));
      return kOk;
    }
    return stopped(there + summary.delivered, fmt::format("{}", jobs.size()));
  }

  int run_until(store::Writer& writer) {
    const UntilRule& until = *suite_.until;
    SequentialRule rule(until, suite_.points.size());
    std::size_t there = 0;
    std::size_t done = 0;
    for (std::uint64_t worlds = rule.next_block(); worlds > 0; worlds = rule.next_block()) {
      const std::vector<BatchJob> jobs = jobs_of(rule.worlds(), worlds);
      const auto present = rule.worlds() == 0 ? begin(writer, jobs) : writer.extend(wanted(jobs));
      if (rule.worlds() == 0) {
        note(fmt::format("until the {} rate of every point is known to +-{:g} %, at most {} worlds: on {}, {}",
                         until.metric, 100.0 * until.half_width, until.max, computers(), request_.file.string()));
      }
      there += count_present(jobs, present);
      const BatchSummary summary = compute(writer, jobs, present);
      done += summary.delivered;
      if (summary.stopped)
        return stopped(there + done, fmt::format("at most {}", suite_.trials * suite_.points.size()));
      for (const BatchJob& job : jobs) {
        const std::optional<TrialRow> row = writer.find(job.key);
        if (row) rule.add(job.point, row->outcome);
      }
      rule.end_block(worlds);
      note(fmt::format("{} worlds: the widest interval is +-{:.2f} %", rule.worlds(), 100.0 * rule.half_width()));
    }
    writer.finish(store::RunStatus::kFinished);
    note(fmt::format("{} after {} worlds: {} trials, {} of them were there already",
                     rule.reached() ? "reached" : "NOT reached", rule.worlds(), there + done, there));
    return kOk;
  }

  static std::size_t count_present(const std::vector<BatchJob>& jobs, const std::unordered_set<std::string>& present) {
    return static_cast<std::size_t>(
        std::count_if(jobs.begin(), jobs.end(), [&](const BatchJob& job) { return present.count(job.key) > 0; }));
  }

  void note(const std::string& text) const {
    if (!request_.quiet) std::cerr << terminal_safe(text) << std::endl;
  }

  std::string computers() const {
    const std::string threads = fmt::format("{} thread{}", request_.threads, request_.threads == 1 ? "" : "s");
    return cluster_ == nullptr ? threads : fmt::format("{} ranks with {} each", cluster_->size(), threads);
  }

  void tell_names(const store::Writer& writer) const {
    if (writer.suite_name() != suite_.name) {
      note(fmt::format("{} already holds another setting of suite {}: this one is kept apart as {}",
                       request_.file.string(), suite_.name, writer.suite_name()));
    }
    for (std::size_t i = 0; i < suite_.points.size(); ++i) {
      if (writer.controller_name(i) != suite_.points[i].controller) {
        note(fmt::format("{} already holds other parameters of controller {}: these are kept apart as {}",
                         request_.file.string(), suite_.points[i].controller, writer.controller_name(i)));
      }
    }
  }

  BatchSummary compute(store::Writer& writer, const std::vector<BatchJob>& jobs,
                       const std::unordered_set<std::string>& present) {
    ProgressPrinter progress(request_.quiet, "success");
    BatchOptions batch;
    batch.threads = request_.threads;
    batch.stop = &InterruptGuard::flag();
    batch.skip = &present;
    batch.remote = cluster_;
    batch.finish = finish_;
    batch.progress = [&](const BatchProgress& p) { progress.update(p); };
    const auto sink = [&](const BatchJob& job, BatchResult&& result) {
      const store::WorldRecord world = result.world != nullptr
                                           ? store::describe(*result.world)
                                           : store::describe_missing(suite_.points[job.point].worlds, job.world);
      doubts_.look(result.output.row);
      const Trace& trace = result.output.trace;
      writer.add({job.point, job.world, job.key}, world, result.output.row, trace.empty() ? nullptr : &trace,
                 result.metrics);
      return true;
    };
    try {
      const BatchSummary summary = run_batch(suite_.points, jobs, batch, sink);
      if (summary.stopped) {
        writer.finish(store::RunStatus::kStopped);
      } else if (!suite_.until) {
        writer.finish(store::RunStatus::kFinished);
      }
      progress.clear();
      return summary;
    } catch (const store::StoreError& error) {
      progress.clear();
      throw store::StoreError(error.kind(), fmt::format("{}\n{} trials of this run are saved{}", error.what(),
                                                        writer.committed(), how_to_go_on(error.kind())));
    }
  }

  int stopped(std::size_t saved, const std::string& of) const {
    std::cerr << terminal_safe(fmt::format("stopped: {} of {} trials are saved in {}; to go on: {}", saved, of,
                                           request_.file.string(), command_line(request_.arguments)))
              << std::endl;
    return kStoppedEarly;
  }

  std::string how_to_go_on(store::StoreError::Kind kind) const {
    if (kind != store::StoreError::Kind::kInterrupted) return "";
    return fmt::format("; when that is cured, go on with: {}", command_line(request_.arguments));
  }

  const RunRequest& request_;
  Suite suite_;
  Cluster* cluster_;
  std::function<void(const Point&, BatchResult&)> finish_;
  Doubts doubts_;
};

}  // namespace

Shard Shard::read(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard.index);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == '/') {
    const auto second = std::from_chars(first.ptr + 1, end, shard.count);
    if (second.ec == std::errc() && second.ptr == end && shard.index >= 1 && shard.index <= shard.count) return shard;
  }
  throw UsageError(fmt::format("run: --shard {}: expected I/N with 1 <= I <= N, for instance 2/8", text));
}

bool keeps_samples(const Suite& suite, const TrialRow& row) {
  return suite.samples == SamplesKept::kAll ||
         (suite.samples == SamplesKept::kFailures && row.outcome != Outcome::kSuccess);
}

std::function<void(const Point&, BatchResult&)> finishing(const Suite& suite) {
  const Suite* const kept = &suite;
  std::map<const void*, std::shared_ptr<const store::UserMetrics>> metrics;  // by robot: columns differ
  if (!suite.metrics.empty()) {
    for (const Point& point : suite.points) {
      auto& one = metrics[point.robot.get()];
      const RobotModel& robot = *point.robot->model;
      try {
        if (one == nullptr)
          one = std::make_shared<store::UserMetrics>(suite.metrics, robot.num_joints(), robot.num_velocities());
      } catch (const store::MetricError& error) {
        throw UsageError(error.what());
      }
    }
  }
  return [kept, metrics](const Point& point, BatchResult& result) {
    if (const auto found = metrics.find(point.robot.get()); found != metrics.end())
      result.metrics = found->second->evaluate(result.output.trace);
    if (!keeps_samples(*kept, result.output.row)) Trace().swap(result.output.trace);
  };
}

int run_suite(const RunRequest& request, Suite suite, Cluster* cluster) {
  return Run(request, std::move(suite), cluster).execute();
}

}  // namespace moma::cli
