#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "reports/render/json.h"
#include "reports/render/replay_data.h"

namespace moma::reports {

/// Schema versions whose tables and views have what the queries of reports/sql ask for.
inline constexpr int kOldestSchema = 4;
inline constexpr int kNewestSchema = 4;

/// Time limit for reading a store, since its views may run for ever. A million trials take far less.
inline constexpr std::chrono::seconds kPatience{600};

/// Opens moma's store for reading. Its triggers do not run; after `patience` whatever is asked of it fails with
/// SQLITE_INTERRUPT. Throws ReportError naming the file and what is wrong with it.
SQLite::Database open_store(const std::filesystem::path& db, std::chrono::milliseconds patience = kPatience);

/// A JSON text of a store. Throws ReportError where it is none, or is nested deeper than anything that moma writes:
/// walking over it would not end well.
Json parse_stored(const std::string& text);

/// A row's columns layout, n, columns and data; valid until the next row.
StoredSamples samples_of(SQLite::Statement& row);

enum class Writer {
  kAtWork,   ///< a program that computes trials holds the store's lock
  kGone,     ///< the lock's file is there and nobody holds it: its program was killed
  kUnknown,  ///< there is no such file: nobody writes, the store was copied, or its file system has no locks
};

/// Who writes to a store, by the advisory lock on DB-lock that a run holds (store.md) and the kernel releases
/// whatever happens to its holder. Looks without waiting and holds nothing afterwards.
Writer writer_of(const std::filesystem::path& db);

}  // namespace moma::reports
