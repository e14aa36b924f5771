#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <thread>

#include "eval/batch/batch.h"
#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/store/database.h"
#include "eval/store/query.h"
#include "eval/store/reader.h"
#include "eval/store/writer.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;

struct RunOptions {
  SuiteOptions suite;
  std::string output;
  std::string rerun;
  int threads = 0;
  bool quiet = false;
  Arguments arguments;
};

/// One shell word.
std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_-./=,:@%+").find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string command_line(const Arguments& arguments) {
  std::string line;
  for (const std::string& word : arguments) {
    if (!line.empty()) line += ' ';
    line += shell_word(word);
  }
  return line;
}

Suite load(const RunOptions& options) {
  if (options.rerun.empty()) return options.suite.load();
  if (!options.suite.set.empty() || !options.suite.seed.empty()) {
    throw UsageError("run: --rerun takes the suite as it is in the store; --set and --seed do not go with it");
  }
  nlohmann::ordered_json resolved =
      nlohmann::ordered_json::parse(store::Reader(options.suite.file).latest_invocation(options.rerun).resolved_suite);
  if (!options.suite.trials.empty()) {
    const auto parsed = nlohmann::ordered_json::parse(options.suite.trials, nullptr, false);
    resolved["trials"] = parsed.is_discarded() ? nlohmann::ordered_json(options.suite.trials) : parsed;
  }
  return suite_from_resolved(resolved);
}

fs::path output_file(const RunOptions& options, const Suite& suite) {
  if (!options.output.empty()) return options.output;
  if (!options.rerun.empty()) return options.suite.file;
  std::string name = suite.name;
  std::replace(name.begin(), name.end(), '/', '_');
  std::error_code error;
  fs::create_directory("results", error);  // where it cannot be, opening the store says why
  return fs::path("results") / (name + ".db");
}

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
  Run(const RunOptions& options, Suite suite)
      : options_(options), suite_(std::move(suite)), file_(output_file(options, suite_)), jobs_(make_jobs(suite_)) {
    for (const BatchJob& job : jobs_) wanted_.push_back({job.point, job.world, job.key});
    threads_ =
        options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }

  int execute() {
    const InterruptGuard interrupt;
    store::Writer writer(file_);
    const std::string warning = store::file_system_warning(file_);
    if (!warning.empty()) print_warnings({warning});
    const auto present = writer.begin(store::describe(suite_), {options_.arguments, threads_}, wanted_);
    tell_start(writer, present);
    const int code = compute(writer, present);
    print_summary(file_, writer.suite_name());
    return code;
  }

 private:
  std::size_t count_present(const std::unordered_set<std::string>& present) const {
    return static_cast<std::size_t>(
        std::count_if(jobs_.begin(), jobs_.end(), [&](const BatchJob& job) { return present.count(job.key) > 0; }));
  }

  void note(const std::string& text) const {
    if (!options_.quiet) std::cerr << terminal_safe(text) << std::endl;
  }

  void tell_start(const store::Writer& writer, const std::unordered_set<std::string>& present) const {
    if (writer.suite_name() != suite_.name) {
      note(fmt::format("{} already holds another setting of suite {}: this one is kept apart as {}", file_.string(),
                       suite_.name, writer.suite_name()));
    }
    for (std::size_t i = 0; i < suite_.points.size(); ++i) {
      if (writer.controller_name(i) != suite_.points[i].controller) {
        note(fmt::format("{} already holds other parameters of controller {}: these are kept apart as {}",
                         file_.string(), suite_.points[i].controller, writer.controller_name(i)));
      }
    }
    const std::size_t there = count_present(present);
    if (there == jobs_.size()) {
      note(fmt::format("{} of {} trials already there: nothing left to do", there, jobs_.size()));
    } else if (there > 0) {
      note(fmt::format("{} of {} trials already there, {} to do, on {} thread{}", there, jobs_.size(),
                       jobs_.size() - there, threads_, threads_ == 1 ? "" : "s"));
    } else {
      note(fmt::format("{} trials to do, on {} thread{}: {}", jobs_.size(), threads_, threads_ == 1 ? "" : "s",
                       file_.string()));
    }
  }

  bool keep_samples(const TrialRow& row) const {
    return suite_.samples == SamplesKept::kAll ||
           (suite_.samples == SamplesKept::kFailures && row.outcome != Outcome::kSuccess);
  }

  int compute(store::Writer& writer, const std::unordered_set<std::string>& present) {
    ProgressPrinter progress(options_.quiet, "success");
    BatchOptions batch;
    batch.threads = threads_;
    batch.stop = &InterruptGuard::flag();
    batch.skip = &present;
    batch.progress = [&](const BatchProgress& p) { progress.update(p); };
    const auto sink = [&](const BatchJob& job, BatchResult&& result) {
      const store::WorldRecord world = result.world != nullptr
                                           ? store::describe(*result.world)
                                           : store::describe_missing(suite_.points[job.point].worlds, job.world);
      const bool samples = keep_samples(result.output.row) && !result.output.trace.empty();
      writer.add({job.point, job.world, job.key}, world, result.output.row, samples ? &result.output.trace : nullptr);
      return true;
    };
    BatchSummary summary;
    try {
      summary = run_batch(suite_.points, jobs_, batch, sink);
      writer.finish(summary.stopped ? store::RunStatus::kStopped : store::RunStatus::kFinished);
    } catch (const store::StoreError& error) {
      progress.clear();
      throw store::StoreError(error.kind(), fmt::format("{}\n{} trials of this run are saved{}", error.what(),
                                                        writer.committed(), how_to_go_on(error.kind())));
    }
    progress.clear();
    if (!summary.stopped) {
      if (summary.delivered > 0) note(fmt::format("{} trials in {:.1f} s", summary.delivered, summary.seconds));
      return kOk;
    }
    std::cerr << terminal_safe(fmt::format("stopped: {} of {} trials are saved in {}; to go on: {}",
                                           count_present(present) + summary.delivered, jobs_.size(), file_.string(),
                                           command_line(options_.arguments)))
              << std::endl;
    return kStoppedEarly;
  }

  std::string how_to_go_on(store::StoreError::Kind kind) const {
    if (kind != store::StoreError::Kind::kInterrupted) return "";
    return fmt::format("; when that is cured, go on with: {}", command_line(options_.arguments));
  }

  const RunOptions& options_;
  Suite suite_;
  fs::path file_;
  std::vector<BatchJob> jobs_;
  std::vector<store::Wanted> wanted_;
  int threads_ = 1;
};

int run(const RunOptions& options) {
  Suite suite = load(options);
  if (!options.quiet) print_warnings(suite.warnings);
  return Run(options, std::move(suite)).execute();
}

}  // namespace

void add_run(CLI::App& app, Action& action, const Arguments& arguments) {
  auto options = std::make_shared<RunOptions>();
  options->arguments = arguments;
  CLI::App* command = app.add_subcommand("run", "Evaluate a suite: every controller and sweep point in every world");
  options->suite.add_to(*command);
  command->add_option("-o,--output", options->output, "Store to write, made if missing (results/NAME.db)");
  command->add_option("--threads", options->threads, "Threads (all cores)")->check(CLI::Range(1, 4096));
  command->add_option("--rerun", options->rerun,
                      "SUITE is a store: run its suite of this name again, from the store alone");
  command->add_flag("-q,--quiet", options->quiet, "No progress and no remarks");
  command->footer(
      "Trials that the store already holds are not computed again, so the same command goes on after a stop.\n"
      "Ctrl-C finishes the trials in flight and saves them.\n"
      "Example: moma run configs/suites/demo.yaml -o results/demo.db --set simulation.mode=kinematic");
  command->callback([&action, options] { action = [options] { return run(*options); }; });
}

}  // namespace moma::cli
