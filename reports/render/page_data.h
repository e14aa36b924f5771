#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <nlohmann/json.hpp>

#include "reports/render/report.h"

namespace moma::reports {

/// Everything the page shows, as one JSON object (reports/web/src/data.ts has its shape): rows as the queries of
/// reports/sql give them; trials by column, texts as codes into a list; infinities as "inf" and "-inf".
nlohmann::ordered_json page_data(SQLite::Database& store, const ReportOptions& options);

}  // namespace moma::reports
