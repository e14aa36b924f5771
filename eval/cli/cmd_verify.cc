#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <vector>

#include "eval/batch/batch.h"
#include "eval/cli/command.h"
#include "eval/cli/interrupt.h"
#include "eval/cli/progress.h"
#include "eval/cli/stored_suites.h"
#include "eval/cli/table.h"
#include "eval/store/columns.h"
#include "eval/store/hash.h"
#include "eval/store/machine.h"
#include "eval/store/reader.h"
#include "eval/trial/trial.h"

namespace moma::cli {
namespace {

struct VerifyOptions {
  std::string file;
  double fraction = 0.1;
  std::int64_t seed = 1;
  int threads = 0;
  bool hash = false;
  bool quiet = false;
};

/// The `fraction` of the keys that come first when all are ordered by a hash with the seed; at least one.
std::vector<std::string> choose(const std::vector<std::string>& keys, double fraction, std::int64_t seed) {
  const auto wanted = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(keys.size())));
  std::map<store::Hash, std::string> ordered;
  for (const std::string& key : keys) ordered.emplace(store::hash_text(fmt::format("{} {}", seed, key)), key);
  std::vector<std::string> chosen;
  for (const auto& [hash, key] : ordered) {
    if (chosen.size() == wanted) break;
    chosen.push_back(key);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

class Verifier {
 public:
  explicit Verifier(const VerifyOptions& options) : options_(options), reader_(options.file) {}

  int execute() {
    for (const std::string& problem : reader_.integrity_problems()) complain("integrity: " + problem);
    const std::vector<std::string> keys = reader_.keys();
    collect(choose(keys, options_.fraction, options_.seed));
    const bool stopped = replay();
    std::cout << fmt::format(
        "{} of {} trials replayed{}: {}\n", replayed_, keys.size(),
        skipped_ > 0 ? fmt::format(" ({} cannot be)", skipped_) : "",
        findings_ == 0 ? "all the same, bit for bit; the store is sound" : fmt::format("{} findings", findings_));
    if (options_.hash) std::cout << fmt::format("results {}\n", reader_.result_hash());
    if (stopped) return kStoppedEarly;
    return findings_ == 0 ? kOk : kCheckFailed;
  }

 private:
  void complain(const std::string& text) {
    ++findings_;
    std::cerr << terminal_safe(text) << '\n';
  }

  /// Turns the chosen trials into jobs of a batch over copies of their points.
  void collect(const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
      store::StoredTrial trial = reader_.trial(key);
      const Point* point = nullptr;
      std::shared_ptr<const World> world;
      try {
        point = &suites_.point_of(trial);
        world = std::make_shared<const World>(world_of(trial));
      } catch (const store::StoreError& error) {
        if (error.kind() != store::StoreError::Kind::kNotFound) throw;
        ++skipped_;
        continue;
      }
      if (trial_key(*point, trial.world_index) != key) {
        complain(fmt::format("trial {}: its content gives another key; the store was changed", key.substr(0, 16)));
      }
      // One point per trial: the batch hands worlds out by point and index, which need not be unique in a store.
      jobs_.push_back({points_.size(), trial.world_index, key});
      points_.push_back(*point);
      worlds_.push_back(std::move(world));
      rows_.push_back(std::move(trial.row));
      classes_.push_back(std::move(trial.machine_class));
    }
  }

  bool replay() {
    const InterruptGuard interrupt;
    ProgressPrinter progress(options_.quiet, "success");
    BatchOptions batch;
    batch.threads = options_.threads;
    batch.stop = &InterruptGuard::flag();
    batch.progress = [&](const BatchProgress& p) { progress.update(p); };
    batch.world = [this](const Point& point, std::uint64_t) {
      return worlds_[static_cast<std::size_t>(&point - points_.data())];
    };
    const std::string here = store::this_machine().machine_class;
    const BatchSummary summary = run_batch(points_, jobs_, batch, [&](const BatchJob& job, BatchResult&& result) {
      ++replayed_;
      const std::vector<std::string> found = store::differences(rows_[job.point], result.output.row);
      if (found.empty()) return true;
      progress.clear();
      const bool other = !classes_[job.point].empty() && classes_[job.point] != here;
      complain(fmt::format("trial {}: {}{}", job.key.substr(0, 16), fmt::join(found, "; "),
                           other ? " (computed on a machine of another class)" : ""));
      return true;
    });
    progress.clear();
    return summary.stopped;
  }

  const VerifyOptions& options_;
  store::Reader reader_;
  StoredSuites suites_;
  std::vector<Point> points_;
  std::vector<BatchJob> jobs_;
  std::vector<std::shared_ptr<const World>> worlds_;
  std::vector<TrialRow> rows_;
  std::vector<std::string> classes_;
  std::size_t replayed_ = 0;
  std::size_t skipped_ = 0;
  std::size_t findings_ = 0;
};

}  // namespace

void add_verify(CLI::App& app, Action& action) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command = app.add_subcommand("verify", "Replay a fraction of a store's trials and check its integrity");
  command->add_option("DB", options->file, "Store")->required();
  command->add_option("--fraction", options->fraction, "Fraction of the trials to replay (0.1)")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--seed", options->seed, "Chooses other trials");
  command->add_option("--threads", options->threads, "Threads (all cores)")->check(CLI::Range(1, 4096));
  command->add_flag("--hash", options->hash, "Print one hash over all results: equal hashes mean equal rows");
  command->add_flag("-q,--quiet", options->quiet, "No progress");
  command->footer(
      "Exit 1 where a trial differs or the store is damaged.\n"
      "Example: moma verify results/demo.db --fraction 0.05 --hash");
  command->callback([&action, options] { action = [options] { return Verifier(*options).execute(); }; });
}

}  // namespace moma::cli
