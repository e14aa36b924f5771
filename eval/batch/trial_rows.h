#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "eval/batch/batch.h"

namespace moma {

/// A source of known trials and sink of new ones: the store, or a part of it.
class TrialSource {
 public:
  virtual ~TrialSource() = default;
  virtual std::optional<TrialRow> find(const std::string& key) = 0;
  /// Accepts a new trial, in the order of the jobs.
  virtual void add(const SuitePoint& point, const BatchJob& job, const BatchResult& result) = 0;
};

struct TrialCounts {
  std::uint64_t computed = 0;
  std::uint64_t reused = 0;  ///< trials found in the source
  std::uint64_t errors = 0;  ///< computed trials with outcome `error`
  std::string first_error;
};

/// The stop flag was set or, with a text, real time ran out in a trial, which has no result. The source has the trials
/// computed before.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns the row of each job, the same for any number of threads. Trials that `source` knows are not computed; null:
/// none is known. `options.skip` has no effect. Adds to `counts`. Throws Interrupted and the exceptions of run_batch().
std::vector<TrialRow> trial_rows(std::span<const SuitePoint> points, std::span<const BatchJob> jobs,
                                 BatchOptions options, TrialSource* source, TrialCounts& counts);

}  // namespace moma
