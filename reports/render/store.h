#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>

namespace moma::reports {

/// Schema versions whose tables and views have what the queries of reports/sql ask for.
inline constexpr int kOldestSchema = 2;
inline constexpr int kNewestSchema = 3;

/// Opens moma's store for reading. Throws ReportError naming the file and what is wrong with it.
SQLite::Database open_store(const std::filesystem::path& db);

}  // namespace moma::reports
