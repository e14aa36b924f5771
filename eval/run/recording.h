#pragma once

#include <functional>

#include "eval/batch/batch.h"
#include "eval/store/records.h"

namespace moma::run {

/// Drops the samples that a suite does not keep: all, none, or those of successes.
void drop_samples(SamplesKept kept, TrialOutput& output);

/// What every process does to a trial that it computed (BatchOptions::finish): evaluates the suite's own metrics, and
/// drops samples that it does not keep. Throws config::ConfigError where a metric's SQL cannot be used.
std::function<void(const SuitePoint&, BatchResult&)> finishing(const Suite& suite);

/// The world of a result, whether it could be made or not.
store::WorldRecord world_record(const SuitePoint& point, const BatchJob& job, const BatchResult& result);

}  // namespace moma::run
