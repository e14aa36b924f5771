#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "eval/batch/trial_rows.h"
#include "eval/search/objective.h"
#include "eval/trial/key.h"
#include "eval/tune/tuning.h"

namespace moma::tune {

/// A candidate's cost in the worlds of a tuning, by simulated trials. The worlds of one measurement run in parallel;
/// trials in the source are not run. Candidates share worlds that do not depend on them.
class TrialObjective : public Objective {
 public:
  TrialObjective(const Tuning& tuning, TrialSource& source, int threads, const std::atomic<bool>* stop);

  std::size_t width() const override { return 1 + tuning_.config.bounds.size(); }
  bool valid(const Candidate& candidate) override;
  /// Throws Interrupted, NullMetric (with trial, world and outcome).
  std::vector<double> measure(const Candidate& candidate, std::span<const std::uint64_t> worlds) override;

  const TrialCounts& counts() const { return counts_; }
  /// Called after each trial.
  std::function<void()> on_trial;

 private:
  const std::vector<SuitePoint>* points_of(const Candidate& candidate);
  std::string key_of(const std::vector<TrialKeys>& keys, const std::vector<SuitePoint>& points,
                     const WorldOfPart& world);
  std::shared_ptr<const World> world(const SuitePoint& point, std::size_t part, std::uint64_t index);

  const Tuning& tuning_;
  TrialSource& source_;
  Points points_;
  BatchOptions batch_;
  Candidate at_;  ///< candidate of the present points
  std::vector<SuitePoint> made_;
  bool made_valid_ = false;
  std::vector<TrialCost::Scale> scales_;
  std::vector<std::unordered_map<std::uint64_t, Json>> identities_;  ///< per part
  std::mutex mutex_;
  std::vector<std::unordered_map<std::uint64_t, std::shared_ptr<const World>>> worlds_;  ///< per part
  TrialCounts counts_;
};

}  // namespace moma::tune
