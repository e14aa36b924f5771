#include "eval/run/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "eval/batch/batch.h"
#include "eval/run/replay.h"
#include "eval/store/hash.h"
#include "eval/store/reader.h"

namespace moma::run {
namespace {

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
  Verifier(const VerifyRequest& request, const Listener& listener)
      : request_(request), listener_(listener), reader_(request.file) {}

  Verification execute() {
    for (const std::string& problem : reader_.integrity_problems()) complain("integrity: " + problem);
    const std::vector<std::string> keys = reader_.keys();
    found_.trials = keys.size();
    collect(choose(keys, request_.fraction, request_.seed));
    if (replay()) found_.end = End::kStopped;
    found_.hash = reader_.result_hash();
    return found_;
  }

 private:
  void complain(const std::string& text) {
    ++found_.findings;
    listener_.tell(listener_.warning, text);
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
        ++found_.skipped;
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
    BatchOptions batch;
    batch.threads = request_.threads;
    batch.stop = request_.stop;
    batch.progress = listener_.progress;
    batch.world = [this](const Point& point, std::uint64_t) {
      return worlds_[static_cast<std::size_t>(&point - points_.data())];
    };
    const BatchSummary summary = run_batch(points_, jobs_, batch, [&](const BatchJob& job, BatchResult&& result) {
      ++found_.replayed;
      const ReplayDifferences found = differences(rows_[job.point], classes_[job.point], result.output.row);
      if (found.lines.empty()) return true;
      if (listener_.progress_end) listener_.progress_end();
      complain(fmt::format("trial {}: {}{}", job.key.substr(0, 16), fmt::join(found.lines, "; "),
                           !found.stored_machine.empty() ? " (computed on a machine of another class)" : ""));
      return true;
    });
    if (listener_.progress_end) listener_.progress_end();
    return summary.stopped;
  }

  const VerifyRequest& request_;
  const Listener& listener_;
  store::Reader reader_;
  StoredSuites suites_;
  std::vector<Point> points_;
  std::vector<BatchJob> jobs_;
  std::vector<std::shared_ptr<const World>> worlds_;
  std::vector<TrialRow> rows_;
  std::vector<std::string> classes_;
  Verification found_;
};

}  // namespace

Verification verify(const VerifyRequest& request, const Listener& listener) {
  return Verifier(request, listener).execute();
}

}  // namespace moma::run
