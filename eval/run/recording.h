#pragma once

#include <functional>

#include "eval/batch/batch.h"
#include "eval/store/records.h"

namespace moma::run {

/// Drops the samples that a suite does not keep: all, none, or those of successes.
void drop_samples(SamplesKept kept, TrialOutput& output);

/// Returns the BatchOptions::finish of every process: it evaluates the suite's own metrics and drops the samples that
/// the suite does not keep. Throws config::ConfigError if a metric's SQL is invalid.
std::function<void(const SuitePoint&, BatchResult&)> finishing(const Suite& suite);

/// Returns the record of a result's world, even if the world could not be made.
store::WorldRecord world_record(const SuitePoint& point, const BatchJob& job, const BatchResult& result);

}  // namespace moma::run
