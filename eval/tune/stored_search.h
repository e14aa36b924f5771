#pragma once

#include <string>

#include "eval/search/search.h"
#include "eval/store/tuning.h"
#include "eval/store/writer.h"
#include "eval/tune/held_out.h"
#include "eval/tune/trial_objective.h"
#include "eval/tune/tuning.h"

namespace moma::tune {

/// The objective in words, for tables and the store.
std::string objective_text(const Tuning& tuning);

/// Returns the search's row of the table tune_search.
store::TuneSearchRecord search_record(const Tuning& tuning);

/// Column held_out of the verdict.
std::string held_out_json(const Tuning& tuning);

/// The suite whose row the search's invocation belongs to: the tuned controller's points only.
Suite searched_suite(const Tuning& tuning);

}  // namespace moma::tune
