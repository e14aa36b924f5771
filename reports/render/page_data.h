#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "reports/render/report.h"

namespace moma::reports {

/// Everything the page shows, as one JSON object (reports/web/src/data.ts has its shape): rows as the queries of
/// reports/sql give them; trials by column, texts as codes into a list; infinities as "inf" and "-inf".
nlohmann::ordered_json page_data(SQLite::Database& store, const ReportOptions& options);

/// The same of several stores, so that their controllers stand side by side. Where each store holds one suite, all
/// trials are shown as one; else equal names of suites are the same suite. A controller that several stores hold
/// under one name is called "NAME (STORE)". Rows of invocations, points, summaries, trials and replays tell their
/// store. `labels` are the stores' distinct names.
nlohmann::ordered_json combined(std::vector<nlohmann::ordered_json> pages, const std::vector<std::string>& labels);

/// Opens and reads the stores; several are combined. Throws ReportError.
nlohmann::ordered_json read_stores(const Stores& stores, const ReportOptions& options);

/// Gives the page its `changes`: each version of a controller at a sweep point against the one before, with every
/// setting in which it differs, gains first. Versions have one name but for the store or the number behind it. Settings
/// are what rows of points.sql hold: `parameters`, and disturbances, worlds, times, tolerances and robot beside them.
/// Numbers that are equal are no change, however they are written.
void add_changes(nlohmann::ordered_json& page);

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
