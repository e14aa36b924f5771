#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "eval/store/reader.h"
#include "eval/suite/controller_entry.h"

namespace moma::run {

struct SearchesRequest {
  std::set<std::string> chosen;  ///< trials that are computed again
  int threads = 0;               ///< 0: one per core
  Plugins plugins = Plugins::kRefused;
  const std::atomic<bool>* stop = nullptr;
  std::function<void(const std::string&)> finding;  ///< hears a sentence for each
};

struct SearchesFound {
  std::size_t searches = 0;  ///< run again over their stored trials
  std::size_t verdicts = 0;  ///< judged again likewise
  std::size_t replayed = 0;
  std::vector<std::string> not_checked, in_doubt;  ///< as in Verification
  std::map<std::string_view, std::size_t>
      missing;  ///< trials without a column's value, although they come out with one
  bool stopped = false;
};

/// Runs every search of the store (moma tune) again: the same candidates must come, and what they cost must follow from
/// the trials that are stored, of which the chosen ones are computed anew; then judges what was found on the stored
/// trials of the held-out worlds. Every row of the tables tune_* must come out. Throws store::StoreError.
SearchesFound verify_searches(const store::Reader& reader, const SearchesRequest& request);

}  // namespace moma::run
