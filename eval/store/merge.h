#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace moma::store {

struct MergeSummary {
  std::size_t added = 0;    ///< trials that OUT did not have
  std::size_t present = 0;  ///< trials of the inputs that were there already
};

/// Adds every store of `in` to `out` (made if missing): all of it or nothing, by a new file that takes its place.
/// Suites and controllers whose names mean something else in `out` get @2. Throws StoreError: kUnusable for a file,
/// kContradiction where one key has two results from machines of one class.
MergeSummary merge(const std::filesystem::path& out, const std::vector<std::filesystem::path>& in);

}  // namespace moma::store
