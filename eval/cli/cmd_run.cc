#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <thread>

#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/run_suite.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/store/machine.h"
#include "eval/store/reader.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;

struct RunOptions {
  SuiteOptions suite;
  std::string output;
  std::string rerun;
  std::string shard;
  double lost_after = 30.0;
  int threads = 0;
  bool quiet = false;
  Arguments arguments;
};

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

/// All cores, but one thread for each rank of an mpirun: ranks are usually as many as cores.
int threads_of(const RunOptions& options, bool cluster) {
  if (options.threads > 0) return options.threads;
  return cluster ? 1 : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

fs::path output_file(const RunOptions& options, const Suite& suite, const Shard& shard) {
  if (!options.output.empty()) return options.output;
  if (!options.rerun.empty() && shard.count == 1) return options.suite.file;
  std::string name = suite.name;
  std::replace(name.begin(), name.end(), '/', '_');
  std::error_code error;
  fs::create_directory("results", error);  // where it cannot be, opening the store says why
  if (shard.count > 1) name += fmt::format(".shard-{}-of-{}", shard.index, shard.count);
  return fs::path("results") / (name + ".db");
}

int lead(const RunOptions& options, Cluster* cluster) {
  Suite suite = load(options);
  if (!options.quiet) print_warnings(suite.warnings);
  RunRequest request;
  request.arguments = options.arguments;
  request.quiet = options.quiet;
  if (!options.shard.empty()) request.shard = Shard::read(options.shard);
  if (suite.until && request.shard.count > 1) {
    throw UsageError(
        "run: --shard needs a fixed number of trials: when 'trials: {until: ...}' ends depends on all worlds");
  }
  request.file = output_file(options, suite, request.shard);
  request.threads = threads_of(options, cluster != nullptr);
  if (cluster != nullptr) {
    cluster->lead(suite.resolved.dump(), store::this_machine().machine_class,
                  [](const std::string& words) { std::cerr << terminal_safe(words) << std::endl; });
  }
  return run_suite(request, std::move(suite), cluster);
}

/// A rank other than 0: it gets the suite from rank 0 and reads no file.
int follow(const RunOptions& options, Cluster& cluster) {
  const InterruptGuard interrupt;  // a signal reaches every rank; rank 0 decides what becomes of it
  const std::optional<std::string> setup = cluster.setup();
  if (!setup) return kOk;
  Suite suite;
  try {
    suite = suite_from_resolved(nlohmann::ordered_json::parse(*setup));
  } catch (const std::exception& error) {
    cluster.refuse(error.what());
    return kOk;
  }
  BatchOptions batch;
  batch.threads = threads_of(options, true);
  batch.finish = finishing(suite);
  cluster.work(suite.points, store::this_machine().machine_class, batch);
  return kOk;
}

int run(const RunOptions& options) {
  if (Cluster::launched() == 1) return lead(options, nullptr);
  if (!Cluster::built()) {
    throw UsageError(
        "run: started by mpirun, but this moma was built without MPI, so that every process would compute everything; "
        "install libopenmpi-dev and build again, or use --shard");
  }
  Cluster cluster(options.lost_after);
  return cluster.rank() == 0 ? lead(options, &cluster) : follow(options, cluster);
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
  command->add_option("--shard", options->shard,
                      "I/N: part I of N (from 1), for N machines; 'moma merge' joins their stores");
  command
      ->add_option("--lost-after", options->lost_after, "Seconds of silence after which an MPI rank is given up (30)")
      ->check(CLI::Range(0.1, 1e6));
  command->add_flag("-q,--quiet", options->quiet, "No progress and no remarks");
  command->footer(
      "Trials that the store already holds are not computed again, so the same command goes on after a stop.\n"
      "Ctrl-C finishes the trials in flight and saves them. A second run on the same store waits for the first.\n"
      "On a cluster (docs/cluster.md): mpirun -n N moma run SUITE, or --shard I/N in every task and moma merge.\n"
      "Example: moma run configs/suites/demo.yaml -o results/demo.db --set simulation.mode=kinematic");
  command->callback([&action, options] { action = [options] { return run(*options); }; });
}

}  // namespace moma::cli
