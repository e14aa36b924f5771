#pragma once

#include <set>
#include <string>

#include "eval/run/verify.h"
#include "eval/store/reader.h"

namespace moma::run {

/// Runs every search of the store (moma tune) again: the same candidates must come, and what they cost must follow from
/// the trials that are stored, of which the chosen ones are computed anew; then judges what was found on the stored
/// trials of the held-out worlds. Every row of the tables tune_* must come out. Adds to `found`; `finding` hears a
/// sentence for each disagreement. Throws store::StoreError.
void verify_searches(const store::Reader& reader, const VerifyRequest& request, const std::set<std::string>& chosen,
                     const Listener::Text& finding, Verification& found);

}  // namespace moma::run
