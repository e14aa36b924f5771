#pragma once

#include <set>
#include <string>

#include "eval/run/verify.h"
#include "eval/store/reader.h"

namespace moma::run {

/// Repeats every search of the store (moma tune). The candidates must be the same, their costs must follow from the
/// stored trials, of which the chosen ones are simulated again, and so must the verdict from the stored trials of the
/// held-out worlds. Every row of the tables tune_* must be reproduced. Adds to `found`; `finding` gets a sentence for
/// each disagreement. Throws store::StoreError.
void verify_searches(const store::Reader& reader, const VerifyRequest& request, const std::set<std::string>& chosen,
                     const Listener::Text& finding, Verification& found);

}  // namespace moma::run
