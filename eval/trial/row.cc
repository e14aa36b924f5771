#include "eval/trial/row.h"

#include "controller/describe/complete.h"

namespace moma {

static_assert(is_complete<TrialRow>(), "a member of TrialRow without its line in describe()");
static_assert(is_complete<TrialRow::Timing>(), "a member of TrialRow::Timing without its line in describe()");
static_assert(is_complete<Sample>(), "a member of Sample without its line in describe()");
static_assert(is_complete<EscapeState>(), "a member of EscapeState without its line in describe()");

}  // namespace moma
