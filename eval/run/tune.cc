#include "eval/run/tune.h"

#include <fmt/format.h>
#include <unistd.h>

#include <ostream>

#include "eval/batch/batch.h"
#include "eval/run/store_file.h"
#include "eval/store/machine.h"
#include "eval/store/writer.h"
#include "eval/trial/trial.h"
#include "eval/tune/search_record.h"
#include "eval/tune/tuned_file.h"

namespace moma::run {
namespace {

const files::Kind kGains{"file of gains by moma tune", "found by moma tune."};

/// The file that the suite names, else configs/controllers/CONTROLLER-tuned.yaml, or CONTROLLER-tuned.yaml if the
/// working directory has no such folder.
fs::path usual_gains(const tune::Tuning& tuning) {
  if (!tuning.config.output.empty()) return fs::path(tuning.config.output).lexically_normal();
  const std::string name = tuning.config.controller + "-tuned.yaml";
  const fs::path usual = "configs/controllers";
  std::error_code error;
  return fs::is_directory(usual, error) ? usual / name : fs::path(name);
}

/// One search into one store.
class Tune {
 public:
  Tune(const TuneRequest& request, const tune::Tuning& tuning, const TuneListener& listener)
      : request_(request),
        tuning_(tuning),
        listener_(listener),
        file_(request.file.empty() ? usual_store(tuning.suites.front().name) : request.file),
        gains_(request.gains.empty() ? usual_gains(tuning) : request.gains),
        threads_(threads_of(request)) {}

  Tuned execute() {
    Tuned tuned;
    const store::RunLock lock(file_, request_.stop, listener_.notice);
    if (!lock.held()) return stopped(std::move(tuned), End::kNeverBegan, "the wait for the store");
    check_gains_file();
    tell_plan();
    tuned.search = search(lock);
    if (!tuned.search) return stopped(std::move(tuned), End::kStopped, "the search");
    listener_.searched(*tuned.search);
    if (request_.verdict) {
      tuned.verdict = judge(*tuned.search);
      if (!tuned.verdict) return stopped(std::move(tuned), End::kStopped, "the held-out evaluation");
      listener_.judged(*tuned.verdict);
    }
    const bool better = tuned.verdict && tuned.verdict->overall == tune::Verdict::kBetter;
    if (tuned.search->found == tune::start_of(tuning_.config.variables) && !better) return tuned;  // nothing found
    tuned.gains = gains_of(tuned.verdict ? &*tuned.verdict : nullptr);
    write_gains(tuned.gains, *tuned.search, tuned.verdict ? &*tuned.verdict : nullptr);
    return tuned;
  }

 private:
  /// A search has no use for the suite's own metrics, and a trial without their values would count as missing.
  static store::SuiteRecord without_metrics(store::SuiteRecord suite) {
    suite.metrics.clear();
    return suite;
  }

  void tell_plan() const {
    listener_.note(fmt::format("{}, on {} thread{}: {}", tune::plan_text(tuning_), threads_, threads_ == 1 ? "" : "s",
                               file_.string()));
    listener_.note("objective: " + tune::objective_text(tuning_));
  }

  std::optional<tune::SearchResult> search(const store::RunLock& lock) {
    store::Writer writer(file_);
    tell_opened(writer, lock, file_, listener_);
    writer.begin(without_metrics(store::describe(tune::searched_suite(tuning_))), {request_.arguments, threads_}, {});
    store::TuneRecords records(writer, tune::search_record(tuning_), tuning_.config.variables);
    if (records.present() > 0)
      listener_.note(fmt::format("{} evaluations are stored: going on from there", records.present()));
    StoredTrials trials(writer, StoredTrials::Of::kSearch);
    tune::TrialObjective objective(tuning_, trials, threads_, request_.stop);
    objective.on_trial = listener_.trial;
    try {
      tune::SearchResult result =
          tune::search(tune::search_settings(tuning_), objective, records, listener_.evaluation);
      listener_.progress_end();
      records.finish(result);
      writer.finish(store::RunStatus::kFinished);
      tell_counts(objective.counts());
      return result;
    } catch (const Interrupted& why) {
      listener_.progress_end();
      tell_late(why.what());
      records.stopped();
      writer.finish(store::RunStatus::kStopped);
      return std::nullopt;
    } catch (...) {
      listener_.progress_end();
      writer.fail();
      throw;
    }
  }

  void tell_counts(const TrialCounts& counts) const {
    listener_.note(fmt::format("{} trials computed, {} taken from the store", counts.computed, counts.reused));
    if (counts.errors > 0) {
      listener_.warning(fmt::format("{} trials ended with an error; the first: {}", counts.errors, counts.first_error));
    }
  }

  std::optional<tune::HeldOutVerdict> judge(const tune::SearchResult& result) {
    const tune::HeldOut held_out = tune::make_held_out(tuning_, result.found);
    std::vector<store::Wanted> wanted;
    for (const BatchJob& job : held_out.jobs) wanted.push_back({job.point, job.world, job.key});
    store::Writer writer(file_);
    const auto present =
        writer.begin(without_metrics(store::describe(held_out.suite)), {request_.arguments, threads_}, wanted);
    listener_.note(
        fmt::format("held-out worlds: {} trials, {} of them already there", held_out.jobs.size(), present.size()));
    BatchOptions batch;
    batch.threads = threads_;
    batch.stop = request_.stop;
    batch.progress = listener_.progress;
    batch.finish = [samples = held_out.suite.samples](const SuitePoint&, BatchResult& done) {
      drop_samples(samples, done.output);
    };
    StoredTrials trials(writer, StoredTrials::Of::kPoints);
    TrialCounts counts;
    std::vector<TrialRow> rows;
    try {
      rows = trial_rows(held_out.suite.points, held_out.jobs, batch, &trials, counts);
    } catch (const Interrupted& why) {
      listener_.progress_end();
      tell_late(why.what());
      writer.finish(store::RunStatus::kStopped);
      return std::nullopt;
    }
    listener_.progress_end();
    writer.finish(store::RunStatus::kFinished);
    const tune::HeldOutVerdict verdict = tune::judge(tuning_, held_out, rows);
    store::TuneRecords records(writer, tune::search_record(tuning_), tuning_.config.variables);
    records.finish(result);
    records.verdict(writer.suite_name(), tune::held_out_json(tuning_), verdict.rows, verdict.overall);
    return verdict;
  }

  /// Gains that are worse than the suite's own are not written to the file in which users expect better ones.
  fs::path gains_of(const tune::HeldOutVerdict* verdict) const {
    if (verdict == nullptr || verdict->overall != tune::Verdict::kWorse) return gains_;
    fs::path worse = gains_;
    return worse.replace_filename(gains_.stem().string() + "-worse" + gains_.extension().string());
  }

  void write_gains(const fs::path& file, const tune::SearchResult& result, const tune::HeldOutVerdict* verdict) const {
    const std::string provenance = fmt::format(
        "Suite {}, seed {}, on {}, {}.\nObjective: {}", tuning_.file.filename().string(), tuning_.config.seed,
        store::utc_now().substr(0, 10), store::version_text(), tune::objective_text(tuning_));
    files::write_file(file, kGains, request_.replace,
                      [&](std::ostream& out) { out << tune::tuned_file(tuning_, result, verdict, provenance); });
  }

  /// Now rather than after half an hour.
  void check_gains_file() const {
    files::check_replace(gains_, kGains, request_.replace);
    const fs::path place = files::behind_links(gains_);
    std::error_code error;
    const bool there = fs::exists(place, error);
    const fs::path folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, error) || ::access(folder.c_str(), W_OK) != 0 ||
        (there && ::access(place.c_str(), W_OK) != 0))
      throw RunError(fmt::format("{}: cannot be written; name another file with --gains", gains_.string()));
  }

  Tuned stopped(Tuned tuned, End end, const std::string& what) const {
    tuned.end = end;
    tuned.stopped = stopped_text("during " + what, "everything measured is", file_, request_.arguments);
    return tuned;
  }

  void tell_late(const std::string& text) const {
    if (!text.empty()) listener_.warning(text);
  }

  const TuneRequest& request_;
  const tune::Tuning& tuning_;
  const TuneListener& listener_;
  fs::path file_;
  fs::path gains_;
  int threads_;
};

}  // namespace

Tuned tune(const TuneRequest& request, const tune::Tuning& tuning, const TuneListener& listener) {
  return Tune(request, tuning, listener).execute();
}

}  // namespace moma::run
