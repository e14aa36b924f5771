#pragma once

#include <SQLiteCpp/Database.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "eval/store/error.h"

namespace moma::store {

inline constexpr int kApplicationId = 0x6d6f6d61;  // "moma"

enum class Access { kReadOnly, kReadWrite, kCreate };

/// Opens a store. kCreate makes a missing or empty file into one, in a single transaction; kReadWrite and kCreate
/// migrate an older version and add the columns of new metrics. A read-only connection refuses every write, also by SQL
/// (query_only), and works where the folder cannot be written. Throws StoreError{kUnusable}: missing, a folder, no
/// permission, not SQLite, another program's, from a newer moma, locked.
SQLite::Database open_database(const std::filesystem::path& file, Access access);

/// Removes a store with the files that SQLite keeps beside it.
void remove_store(const std::filesystem::path& file);

/// A read-only connection that leaves no -wal and -shm files behind, which SQLite's read-only connections to a WAL
/// database otherwise do.
class ReadConnection {
 public:
  /// Throws as open_database(file, Access::kReadOnly).
  explicit ReadConnection(const std::filesystem::path& file);
  ~ReadConnection();
  ReadConnection(const ReadConnection&) = delete;
  ReadConnection& operator=(const ReadConnection&) = delete;
  SQLite::Database& db() noexcept { return *db_; }

 private:
  std::filesystem::path file_;
  std::optional<SQLite::Database> db_;
};

/// Turns an SQLite failure into words that name the file and what can be done.
StoreError explain(const SQLite::Exception& error, const std::filesystem::path& file, StoreError::Kind kind);

/// "" or a warning that the file lies on a network file system, where SQLite's locks are not to be trusted.
std::string file_system_warning(const std::filesystem::path& file);

/// Trials that ended because real time ran out, which stores of earlier versions hold as results (plugin/host/late.h).
std::size_t count_late(const SQLite::Database& db);
/// Removes them with all that belongs to them, so that they are tried again; returns how many. One look through all
/// rows.
std::size_t forget_late(SQLite::Database& db);

}  // namespace moma::store
