#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/batch/cluster.h"
#include "eval/cli/command.h"
#include "eval/cli/progress.h"
#include "eval/store/writer.h"
#include "eval/suite/suite.h"

namespace moma::cli {

/// Part `index` of `count`, from 1: the worlds whose index leaves `index` - 1 when divided by `count`, for all points.
struct Shard {
  std::uint64_t index = 1;
  std::uint64_t count = 1;
  /// Reads "I/N". Throws UsageError.
  static Shard read(const std::string& text);
  bool has(std::uint64_t world) const { return world % count == index - 1; }
};

struct RunRequest {
  std::filesystem::path file;  ///< store
  Arguments arguments;         ///< the command line, for provenance and "to go on"
  int threads = 1;
  bool quiet = false;
  Shard shard;
};

/// The suite's own rule of what is kept.
bool keeps_samples(const Suite& suite, const TrialRow& row);

/// What every process does to a trial that it computed: evaluates the suite's own metrics, and drops samples that it
/// does not keep. `suite` must live as long. Throws UsageError where a metric's SQL cannot be used.
std::function<void(const Point&, BatchResult&)> finishing(const Suite& suite);

/// Evaluates a suite into a store, resuming what is there: alone, or with the ranks of `cluster`. Returns the exit
/// code; throws store::StoreError.
int run_suite(const RunRequest& request, Suite suite, Cluster* cluster = nullptr);

}  // namespace moma::cli
