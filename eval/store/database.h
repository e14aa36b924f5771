#pragma once

#include <SQLiteCpp/Database.h>

#include <cstddef>
#include <optional>
#include <string>

#include "eval/store/error.h"

namespace moma::store {

inline constexpr int kApplicationId = 0x6d6f6d61;  // "moma"

enum class Access { kReadOnly, kReadWrite, kCreate };

/// Opens a store. kCreate also creates it, in one transaction; kReadWrite and kCreate migrate older versions and add
/// the columns of new metrics. A read-only connection refuses every write and works in a read-only folder. Throws
/// StoreError{kUnusable}: missing, a folder, no permission, not SQLite, another program's, from a newer moma, locked.
SQLite::Database open_database(const fs::path& file, Access access);

/// Removes a store with the files that SQLite keeps beside it.
void remove_store(const fs::path& file);

/// A read-only connection that, unlike SQLite's own, leaves no -wal and -shm files behind.
class ReadConnection {
 public:
  /// Throws as open_database(file, Access::kReadOnly).
  explicit ReadConnection(const fs::path& file);
  ~ReadConnection();
  ReadConnection(const ReadConnection&) = delete;
  ReadConnection& operator=(const ReadConnection&) = delete;
  SQLite::Database& db() noexcept { return *db_; }

 private:
  fs::path file_;
  std::optional<SQLite::Database> db_;
};

/// Describes a failure of SQLite, with the file and the remedy.
StoreError explain(const SQLite::Exception& error, const fs::path& file, StoreError::Kind kind);

/// Returns a warning if the file is on a network file system, whose locks SQLite cannot trust; otherwise "".
std::string file_system_warning(const fs::path& file);

/// Counts the trials that ended because real time ran out; earlier versions stored them (plugin/host/plugin.h).
std::size_t count_late(const SQLite::Database& db);
/// Removes these trials, so that they are computed again; returns their number. Reads all rows once.
std::size_t forget_late(SQLite::Database& db);

}  // namespace moma::store
