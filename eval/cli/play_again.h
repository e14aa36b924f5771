#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "eval/run/replay.h"
#include "reports/render/replay_data.h"

namespace moma::cli {

/// A stored trial's motion, simulated again from the store alone, as the report page takes it. Nothing where the trial
/// has no samples. Throws store::StoreError and config::ConfigError where the store or what it names cannot be read.
std::optional<reports::OwnedSamples> play_again(run::StoredSuites& suites, const std::filesystem::path& db,
                                                const std::string& trial);

}  // namespace moma::cli
