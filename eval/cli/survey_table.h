#pragma once

#include <iosfwd>

#include "eval/run/survey.h"

namespace moma::cli {

/// How worlds are made, as tables. Times only where asked for: all else is the same every time. Nothing where no world
/// had to be made.
void print_survey(std::ostream& out, const run::WorldSurvey& survey, bool times);

}  // namespace moma::cli
