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

/// Steps from every released version; continuous, ending at kSchemaVersion.
std::span<const Migration> migrations() noexcept;

int schema_version(SQLite::Database& db);

/// Makes an empty database into a store of the current version, in one transaction.
void create_schema(SQLite::Database& db);

/// Applies the steps from the file's version up to `target` and makes the views anew, all in one transaction: either
/// all or none happen. Throws SQLite::Exception; std::logic_error where a step is missing.
void migrate(SQLite::Database& db, std::span<const Migration> steps, int target);

/// Gives a connection that only reads this build's views, where the file has those of another.
void shadow_views(SQLite::Database& db);

/// Adds the columns of results that are described (eval/trial/row.h) and that a store of this version does not have
/// yet, and makes the views anew where they differ: a new metric needs neither a version of the store nor a migration.
/// Columns that this program does not know stay as they are. In one transaction; throws SQLite::Exception.
void add_described_columns(SQLite::Database& db);

/// Names of a table's columns.
std::set<std::string> stored_columns(SQLite::Database& db, const std::string& table,
                                     const std::string& schema = "main");

}  // namespace moma::store
