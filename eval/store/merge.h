#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace moma::store {

struct MergeSummary {
  std::size_t added = 0;           ///< trials that OUT did not have
  std::size_t present = 0;         ///< trials of the inputs that were there already
  std::size_t searches = 0;        ///< of moma tune, that OUT did not have or not so far
  std::vector<std::string> notes;  ///< what of an input could not come along, and why; sentences
};

struct MergeOptions {
  const std::atomic<bool>* stop = nullptr;          ///< set: waiting ends, nothing is merged
  std::function<void(const std::string&)> waiting;  ///< hears whom it waits for
};

/// Adds every store of `in` to `out` (made if missing): all of it or nothing, by a new file that takes its place. Holds
/// the locks of all of them, so that a run that ends meanwhile loses nothing and two merges follow each other.
/// Suites and controllers whose names mean something else in `out` get @2. Searches are added, and those that both have
/// go on as far as either went. Other programs' tables stay in `out`; those of `in` come along, rows that `out` has
/// not. Stores of older versions are brought up to date, in `in` by a copy. Throws StoreError: kUnusable for a file,
/// kContradiction where one key has two results from machines of one class, kInterrupted where it was stopped.
MergeSummary merge(const std::filesystem::path& out, const std::vector<std::filesystem::path>& in,
                   const MergeOptions& options = {});

}  // namespace moma::store
