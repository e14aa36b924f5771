#pragma once

#include <string>
#include <vector>

#include "eval/search/search.h"
#include "eval/tune/held_out.h"
#include "eval/tune/tuning.h"

namespace moma::tune {

/// A controller file with the found gains: the tuned controller as it was written, the found values in place, and
/// in comments where they come from (suite, search, worlds, verdict, sensitivity, importance, version, date).
/// Without a verdict the file says that none was made.
std::string tuned_file(const Tuning& tuning, const SearchResult& result, const HeldOutVerdict* verdict,
                       const std::string& provenance);

/// What a search is going to do, in a sentence.
std::string plan_text(const Tuning& tuning);

/// Found against start, with importance and sensitivity: the table that `moma tune` prints.
std::string gains_table(const Tuning& tuning, const SearchResult& result);

}  // namespace moma::tune
