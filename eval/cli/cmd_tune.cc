#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <thread>
#include <unordered_map>

#include "eval/batch/batch.h"
#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/cli/tune_progress.h"
#include "eval/store/build_info.h"
#include "eval/store/database.h"
#include "eval/store/machine.h"
#include "eval/store/run_lock.h"
#include "eval/store/writer.h"
#include "eval/tune/held_out.h"
#include "eval/tune/stored_search.h"
#include "eval/tune/tuned_file.h"
#include "eval/tune/tuning.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;

struct TuneOptions {
  SuiteOptions suite;
  std::string output;
  std::string gains;
  int threads = 0;
  bool quiet = false;
  bool no_verdict = false;
  Arguments arguments;
};

fs::path store_file(const TuneOptions& options, const std::string& suite) {
  if (!options.output.empty()) return options.output;
  std::string name = suite;
  std::replace(name.begin(), name.end(), '/', '_');
  std::error_code error;
  fs::create_directory("results", error);  // where it cannot be, opening the store says why
  return fs::path("results") / (name + ".db");
}

fs::path gains_file(const TuneOptions& options, const tune::Tuning& tuning) {
  if (!options.gains.empty()) return options.gains;
  if (!tuning.config.output.empty()) return fs::path(tuning.config.output).lexically_normal();
  const std::string name = tuning.config.controller + "-tuned.yaml";
  const fs::path usual = "configs/controllers";
  std::error_code error;
  return fs::is_directory(usual, error) ? usual / name : fs::path(name);
}

class Tune {
 public:
  Tune(const TuneOptions& options, tune::Tuning tuning)
      : options_(options),
        tuning_(std::move(tuning)),
        file_(store_file(options, tuning_.suites.front().name)),
        gains_(gains_file(options, tuning_)) {
    threads_ =
        options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }

  int execute() {
    const InterruptGuard interrupt;
    const store::RunLock lock(file_, InterruptGuard::flag(), [&](const std::string& words) { note(words); });
    if (!lock.held()) return stopped("the wait for the store");
    {  // now rather than after half an hour
      std::ofstream probe(gains_, std::ios::app);
      if (!probe)
        throw UsageError(fmt::format("{}: cannot be written; name another file with --gains", gains_.string()));
    }
    std::error_code ignored;
    if (fs::file_size(gains_, ignored) == 0) fs::remove(gains_, ignored);
    tell_plan();
    const std::optional<tune::SearchResult> result = search();
    if (!result) return stopped("the search");
    tell_search(*result);
    if (options_.no_verdict) {
      write_gains(*result, nullptr);
      return kOk;
    }
    const std::optional<tune::HeldOutVerdict> verdict = judge(*result);
    if (!verdict) return stopped("the held-out evaluation");
    std::cout << tune::table(*verdict) << '\n';
    for (const std::string& line : verdict->constraints) std::cout << "constraint " << line << '\n';
    std::cout << fmt::format("On worlds that took no part in the search, the found gains against '{}': {}{}.\n",
                             verdict->against, to_string(verdict->overall),
                             verdict->why.empty() ? "" : fmt::format(" (by {})", verdict->why));
    write_gains(*result, &*verdict);
    return kOk;
  }

 private:
  /// A search has no use for the suite's own metrics, and a trial without their values would count as missing.
  static store::SuiteRecord without_metrics(store::SuiteRecord suite) {
    suite.metrics.clear();
    return suite;
  }

  void note(const std::string& text) const {
    if (!options_.quiet) std::cerr << terminal_safe(text) << std::endl;
  }

  void tell_plan() const {
    note(fmt::format("{}, on {} thread{}: {}", tune::plan_text(tuning_), threads_, threads_ == 1 ? "" : "s",
                     file_.string()));
    note("objective: " + tune::objective_text(tuning_));
  }

  std::optional<tune::SearchResult> search() {
    store::Writer writer(file_);
    const std::string warning = store::file_system_warning(file_);
    if (!warning.empty()) print_warnings({warning});
    writer.begin(without_metrics(store::describe(tune::searched_suite(tuning_))), {options_.arguments, threads_}, {});
    store::TuneRecords records(writer, tune::search_record(tuning_));
    if (records.present() > 0) note(fmt::format("{} evaluations are stored: going on from there", records.present()));
    tune::StoredTrials trials(writer);
    tune::StoredLog log(records);
    tune::TrialObjective objective(tuning_, trials, threads_, &InterruptGuard::flag());
    TuneProgress progress(options_.quiet, tuning_.config.cost.unit());
    objective.on_trial = [&] { progress.trial(); };
    try {
      tune::SearchResult result = tune::search(tune::search_settings(tuning_), objective, log,
                                               [&](const tune::Progress& p) { progress.update(p); });
      progress.clear();
      records.finish(tune::result_record(result));
      writer.finish(store::RunStatus::kFinished);
      tell_counts(objective.counts());
      return result;
    } catch (const tune::Interrupted&) {
      progress.clear();
      records.stopped();
      writer.finish(store::RunStatus::kStopped);
      return std::nullopt;
    }
  }

  void tell_counts(const tune::TrialCounts& counts) const {
    note(fmt::format("{} trials computed, {} taken from the store", counts.computed, counts.reused));
    if (counts.errors > 0) {
      print_warnings({fmt::format("{} trials ended with an error; the first: {}", counts.errors, counts.first_error)});
    }
  }

  void tell_search(const tune::SearchResult& result) const {
    const std::uint64_t all = result.trials + result.trials_saved;
    std::cout << fmt::format(
        "{} candidates in {} trials; {} of them cut short, which saved {} trials ({:.0f} %)\n", result.history.size(),
        result.trials, result.evaluations_cut, result.trials_saved,
        all > 0 ? 100.0 * static_cast<double>(result.trials_saved) / static_cast<double>(all) : 0.0);
    std::cout << tune::gains_table(tuning_, result);
    for (const std::string& line : result.notes) std::cout << "note: " << line << '\n';
    std::cout << std::endl;
  }

  std::optional<tune::HeldOutVerdict> judge(const tune::SearchResult& result) {
    const tune::HeldOut held_out = tune::make_held_out(tuning_, result.found);
    std::vector<store::Wanted> wanted;
    for (const BatchJob& job : held_out.jobs) wanted.push_back({job.point, job.world, job.key});
    store::Writer writer(file_);
    const auto present =
        writer.begin(without_metrics(store::describe(held_out.suite)), {options_.arguments, threads_}, wanted);
    std::unordered_map<std::string, TrialRow> rows;
    for (const std::string& key : present) rows.emplace(key, *writer.find(key));
    note(fmt::format("held-out worlds: {} trials, {} of them already there", held_out.jobs.size(), present.size()));
    ProgressPrinter progress(options_.quiet, "success");
    BatchOptions batch;
    batch.threads = threads_;
    batch.stop = &InterruptGuard::flag();
    batch.skip = &present;
    batch.progress = [&](const BatchProgress& p) { progress.update(p); };
    const std::vector<Point>& points = held_out.suite.points;
    const SamplesKept samples = held_out.suite.samples;
    const BatchSummary summary = run_batch(points, held_out.jobs, batch, [&](const BatchJob& job, BatchResult&& done) {
      const TrialRow& row = done.output.row;
      const store::WorldRecord world = done.world != nullptr
                                           ? store::describe(*done.world)
                                           : store::describe_missing(points[job.point].worlds, job.world);
      const bool keep =
          !done.output.trace.empty() &&
          (samples == SamplesKept::kAll || (samples == SamplesKept::kFailures && row.outcome != Outcome::kSuccess));
      writer.add({job.point, job.world, job.key}, world, row, keep ? &done.output.trace : nullptr);
      rows.emplace(job.key, row);
      return true;
    });
    progress.clear();
    writer.finish(summary.stopped ? store::RunStatus::kStopped : store::RunStatus::kFinished);
    if (summary.stopped) return std::nullopt;
    std::vector<TrialRow> in_order;
    for (const BatchJob& job : held_out.jobs) in_order.push_back(rows.at(job.key));
    tune::HeldOutVerdict verdict = tune::judge(tuning_, held_out, in_order);
    store::TuneRecords records(writer, tune::search_record(tuning_));
    records.finish(tune::result_record(result));
    records.verdict(writer.suite_name(), verdict.rows, std::string(to_string(verdict.overall)));
    return verdict;
  }

  void write_gains(const tune::SearchResult& result, const tune::HeldOutVerdict* verdict) const {
    const std::string commit = store::kGitCommit;
    const std::string provenance = fmt::format(
        "Suite {}, seed {}, on {}, moma {}{}.\nObjective: {}", tuning_.file.filename().string(), tuning_.config.seed,
        store::utc_now().substr(0, 10), store::kVersion,
        commit.empty() ? "" : fmt::format(" ({}{})", commit.substr(0, 12), store::kGitDirty ? ", changed" : ""),
        tune::objective_text(tuning_));
    std::ofstream stream(gains_);
    stream << tune::tuned_file(tuning_, result, verdict, provenance);
    if (!stream.flush()) throw UsageError(fmt::format("{}: could not be written", gains_.string()));
    std::cout << fmt::format("the found gains are in {}\n", gains_.string());
  }

  int stopped(const std::string& what) const {
    std::string line;
    for (const std::string& word : options_.arguments) line += (line.empty() ? "" : " ") + word;
    std::cerr << terminal_safe(fmt::format("stopped during {}: everything measured is saved in {}; to go on: {}", what,
                                           file_.string(), line))
              << std::endl;
    return kStoppedEarly;
  }

  const TuneOptions& options_;
  tune::Tuning tuning_;
  fs::path file_;
  fs::path gains_;
  int threads_ = 1;
};

int run(const TuneOptions& options) {
  if (is_database(options.suite.file)) {
    throw UsageError(fmt::format("{}: is a store, not a suite file", options.suite.file));
  }
  tune::Tuning tuning = tune::load_tuning(options.suite.file, options.suite.overrides());
  if (!options.quiet) print_warnings(tuning.warnings);
  return Tune(options, std::move(tuning)).execute();
}

}  // namespace

void add_tune(CLI::App& app, Action& action, const Arguments& arguments) {
  auto options = std::make_shared<TuneOptions>();
  options->arguments = arguments;
  CLI::App* command =
      app.add_subcommand("tune", "Search the gains of a suite's controller with NLopt, and judge them on other worlds");
  options->suite.add_to(*command);
  command->add_option("-o,--output", options->output, "Store to write, made if missing (results/NAME.db)");
  command->add_option("--gains", options->gains,
                      "File for the found gains (configs/controllers/CONTROLLER-tuned.yaml)");
  command->add_option("--threads", options->threads, "Threads (all cores)")->check(CLI::Range(1, 4096));
  command->add_flag("--no-verdict", options->no_verdict, "Search only; the same command without it judges later");
  command->add_flag("-q,--quiet", options->quiet, "No progress and no remarks");
  command->footer(
      "The suite's `tune` section names variables, objective, algorithm, budget and worlds: docs/tuning.md.\n"
      "Every evaluation is stored: the same command goes on after a stop, and ends with the same gains.\n"
      "Example: moma tune configs/suites/tune-frankie.yaml --set tune.budget.trials=5000");
  command->callback([&action, options] { action = [options] { return run(*options); }; });
}

}  // namespace moma::cli
