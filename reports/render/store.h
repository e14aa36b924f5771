#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>

namespace moma::reports {

/// Schema version that the queries of reports/sql are written for.
inline constexpr int kSchemaVersion = 3;

/// Opens moma's store for reading. Throws ReportError naming the file and what is wrong with it.
SQLite::Database open_store(const std::filesystem::path& db);

}  // namespace moma::reports
