#pragma once

#include <string>

#include "eval/store/search_tables.h"
#include "eval/tune/tuning.h"

namespace moma::tune {

/// Returns the search's row of the table tune_search.
store::TuneSearchRecord search_record(const Tuning& tuning);

/// Column held_out of the verdict.
std::string held_out_json(const Tuning& tuning);

/// The suite whose row the search's invocation belongs to: the tuned controller's points only.
Suite searched_suite(const Tuning& tuning);

}  // namespace moma::tune
