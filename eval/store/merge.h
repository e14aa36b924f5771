#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "controller/config/paths.h"

namespace moma::store {

struct MergeSummary {
  std::size_t added = 0;           ///< trials that OUT did not have
  std::size_t present = 0;         ///< trials of the inputs that were there already
  std::size_t searches = 0;        ///< of moma tune, that OUT did not have or not so far
  std::vector<std::string> notes;  ///< sentences about parts of inputs that were left out, and why
};

struct MergeOptions {
  const std::atomic<bool>* stop = nullptr;          ///< if set, waiting ends and nothing is merged
  std::function<void(const std::string&)> waiting;  ///< called with the program that merge() waits for
};

/// Adds the stores `in` to `out` (created if missing): all or nothing, by a new file that replaces it, under the locks
/// of all stores. Suites and controllers whose names mean something else in `out` get @2. Searches are added; one that
/// both have is kept as far as either went. Missing tables and rows of other programs are added too. Stores of older
/// versions are migrated, inputs by a copy. Throws StoreError: kUnusable for a file, kContradiction if one key has two
/// results from machines of one class, kInterrupted if stopped.
MergeSummary merge(const fs::path& out, const std::vector<fs::path>& in, const MergeOptions& options = {});

}  // namespace moma::store
