#include <fmt/format.h>

#include <charconv>
#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/summary_table.h"
#include "eval/cli/table.h"
#include "eval/run/evaluate.h"
#include "eval/run/replay.h"

namespace moma::cli {
namespace {

struct RunOptions {
  SuiteOptions suite;
  run::EvaluateRequest request;
  std::string rerun;
  std::string shard;
  Plugins plugins = Plugins::kRefused;
  double lost_after = 30.0;
  bool quiet = false;
};

Suite load(const RunOptions& options) {
  if (options.rerun.empty()) return options.suite.load();
  if (!options.suite.set.empty() || !options.suite.seed.empty()) {
    throw UsageError("run: --rerun takes the suite as it is in the store; --set and --seed do not go with it");
  }
  return run::stored_suite(options.suite.file, options.rerun, options.suite.trials, options.plugins);
}

run::Shard read_shard(const std::string& text) {
  run::Shard shard;
  if (text.empty()) return shard;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard.index);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == '/') {
    const auto second = std::from_chars(first.ptr + 1, end, shard.count);
    if (second.ec == std::errc() && second.ptr == end && shard.index >= 1 && shard.index <= shard.count) return shard;
  }
  throw UsageError(fmt::format("run: --shard {}: expected I/N with 1 <= I <= N, for instance 2/8", text));
}

/// Returns a table of the durations of a trial's parts, without parts that took no time. Milliseconds and microseconds
/// are wall time of threads, so that other work on the machine lengthens all parts.
void print_profile(const Profile& profile) {
  if (profile.trials == 0) {
    std::cout << "\nprofile: no trial was computed\n";
    return;
  }
  const auto whole = static_cast<double>(profile.nanoseconds());
  const auto trials = static_cast<double>(profile.trials);
  store::QueryResult table{{"part", "share %", "us a control step", "ms a trial", "times a trial"}, {}};
  const auto add = [&](std::string name, double nanoseconds, const store::Cell& times) {
    store::Cell step;
    if (profile.steps > 0) step = rounded(1e-3 * nanoseconds / static_cast<double>(profile.steps), 0.01);
    table.rows.push_back({std::move(name), rounded(100.0 * nanoseconds / whole, 0.01), step,
                          rounded(1e-6 * nanoseconds / trials, 0.001), times});
  };
  for (std::size_t i = 0; i < Profile::kParts; ++i) {
    const Profile::Share& share = profile.parts[i];
    if (share.entries == 0) continue;
    add(std::string(to_string(static_cast<TrialPart>(i))), static_cast<double>(share.nanoseconds),
        rounded(static_cast<double>(share.entries) / trials, 0.1));
  }
  add("whole", whole, store::Cell{});
  std::cout << '\n';
  write(std::cout, table, Format::kTable);
  std::cout << fmt::format("{} trials, {} control steps, {:.2f} s of threads\n", profile.trials, profile.steps,
                           1e-9 * whole);
}

int lead(const RunOptions& options) {
  const Suite suite = load(options);
  if (!options.quiet) print_warnings(suite.warnings);
  run::EvaluateRequest request = options.request;
  request.shard = read_shard(options.shard);
  if (request.file.empty() && !options.rerun.empty() && request.shard.count == 1) request.file = options.suite.file;
  const Computation computation(request, options.quiet);
  const run::Evaluation done = run::evaluate(request, suite, computation.listener());
  const int code = tell_end(done);
  if (done.end == run::End::kNeverBegan) return code;
  write(std::cout, summary_table(done.file, done.suite, true), Format::kTable);
  std::cout.flush();
  if (request.profile) print_profile(done.profile);
  print_warnings(done.warnings);
  return code;
}

int run_suite(RunOptions& options) {
  return with_ranks("run", options.request, options.lost_after, options.request.profile, [&] { return lead(options); });
}

}  // namespace

void add_run(Commands& commands) {
  auto [command, options] =
      commands.add<RunOptions>("run", "Evaluate a suite: every controller and sweep point in every world", &run_suite);
  options.suite.add_to(command);
  add_output_store(command, options.request.file);
  add_threads(command, options.request.threads);
  command.add_option("--rerun", options.rerun,
                     "SUITE is a store: run its suite of this name again, from the store alone");
  add_allow_plugins(command, options.plugins);
  command.add_option("--shard", options.shard,
                     "I/N: part I of N (from 1), for N machines; 'moma merge' joins their stores");
  add_lost_after(command, options.lost_after);
  command.add_flag("--profile", options.request.profile,
                   "Prints the durations of a trial's parts; results are the same");
  command.add_flag("--keep-going", options.request.keep_going,
                   "Goes on if the first twenty trials of a controller all end by the same error");
  add_quiet(command, options.quiet);
  command.footer(
      "Trials that the store already holds are not computed again, so the same command goes on after a stop.\n"
      "Ctrl-C finishes the trials in flight and saves them. A second run on the same store waits for the first.\n"
      "On a cluster (docs/how-to/cluster.md): mpirun -n N moma run SUITE, or --shard I/N in every task and moma "
      "merge.\n"
      "Example: moma run configs/suites/demo.yaml -o results/demo.db --set simulation.mode=kinematic");
}

}  // namespace moma::cli
