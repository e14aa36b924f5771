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

}  // namespace moma::reports
