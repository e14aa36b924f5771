#pragma once

#include <SQLiteCpp/Database.h>

#include <set>
#include <span>
#include <string>

namespace moma::store {

/// SQL that turns a store of version `from` into one of version `from + 1`.
struct Migration {
  int from = 0;
  const char* sql = nullptr;
};

/// The version that this program writes: that of schema.sql.
inline constexpr int kSchemaVersion = 4;

/// Steps from every released version up to kSchemaVersion.
std::span<const Migration> migrations() noexcept;

int schema_version(SQLite::Database& db);

/// Creates the store's tables in an empty database, in one transaction.
void create_schema(SQLite::Database& db);

/// Applies the steps up to version `target` and replaces the views, in one transaction. Throws SQLite::Exception;
/// std::logic_error if a step is missing.
void migrate(SQLite::Database& db, std::span<const Migration> steps, int target);

/// Hides the views of another build from a read-only connection by temporary ones of this build.
void shadow_views(SQLite::Database& db);

/// Adds missing described columns and words, and replaces the views if they differ, in one transaction: a new metric or
/// outcome needs no migration. Unknown columns stay. Throws SQLite::Exception.
void add_described_columns(SQLite::Database& db);

/// Names of a table's columns.
std::set<std::string> stored_columns(SQLite::Database& db, const std::string& table,
                                     const std::string& schema = "main");

}  // namespace moma::store
