#pragma once

#include <string>

#include "eval/search/search.h"
#include "eval/tune/held_out.h"
#include "eval/tune/tuning.h"

namespace moma::tune {

/// Returns a controller file with the found gains: the tuned controller as written with the found values in place, and
/// their origin in comments (suite, search, worlds, verdict, sensitivity, importance, version, date). The file also
/// states if there is no verdict.
std::string tuned_file(const Tuning& tuning, const SearchResult& result, const HeldOutVerdict* verdict,
                       const std::string& provenance);

/// Describes the plan of a search in a sentence.
std::string plan_text(const Tuning& tuning);

/// Returns the table of `moma tune`: found against start, with importance and sensitivity.
std::string gains_table(const Tuning& tuning, const SearchResult& result);

}  // namespace moma::tune
