#pragma once

#include <iosfwd>

#include "eval/trial/profile.h"

namespace moma::cli {

/// Where the time of trials went, a row for each part that took any. Milliseconds and microseconds are wall time of
/// threads, so that other work on the machine lengthens all parts.
void print_profile(std::ostream& out, const Profile& profile);

}  // namespace moma::cli
