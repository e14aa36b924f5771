#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "reports/render/report.h"

namespace moma::reports {

/// Adds to the page "replays", the worst trials of each kind among those with samples of worlds before `worlds`, and
/// "robots", each robot that one of them needs, by its id. With `options.served` the trials are named only: their
/// motion is asked for later.
void add_replays(SQLite::Database& store, const ReportOptions& options, std::int64_t worlds,
                 nlohmann::ordered_json& page);

/// One trial as the page plays it, with its robot: an element of "replays" and "resolved". `trial` is its whole
/// name; nothing where the store has no such trial. `simulate` stands in for samples that the store does not hold, and
/// gives the rows of the QP; without samples "n" is 0. Throws what `simulate` throws, unless samples are stored.
std::optional<nlohmann::ordered_json> replay_of(SQLite::Database& store, const std::string& trial, double hz,
                                                const Simulate& simulate);

}  // namespace moma::reports
