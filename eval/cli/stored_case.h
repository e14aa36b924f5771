#pragma once

#include <filesystem>
#include <string>

#include "controller/case/case_file.h"
#include "eval/run/replay.h"

namespace moma::cli {

/// Control step `step` of a stored trial as a case, from the store alone. `trial`: its name or a unique beginning.
/// Throws UsageError where the trial ends before or its controller is a plugin, and what run::StoredSuites does.
ControlCase stored_case(run::StoredSuites& suites, const std::filesystem::path& db, const std::string& trial,
                        long step);

}  // namespace moma::cli
