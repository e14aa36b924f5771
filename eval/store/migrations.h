#pragma once

#include <SQLiteCpp/Database.h>

#include <set>
#include <string>

namespace moma::store {

/// The version that this program writes: that of schema.sql.
inline constexpr int kSchemaVersion = 4;

int schema_version(SQLite::Database& db);

/// Creates the store's tables in an empty database, in one transaction.
void create_schema(SQLite::Database& db);

/// Makes kSchemaVersion of an older store, in one transaction, for add_described_columns() to complete. Throws
/// SQLite::Exception.
void migrate(SQLite::Database& db);

/// True if an earlier build wrote the store, whose tables lack columns of this build.
bool lacks_columns(SQLite::Database& db);

/// Hides the views of another build, and tables that lack columns, from a read-only connection by temporary views, in
/// which these columns have their defaults.
void shadow_views(SQLite::Database& db);

/// Adds missing described columns and words, and replaces the views if they differ, in one transaction: a new metric or
/// outcome needs no migration. Unknown columns stay. Throws SQLite::Exception.
void add_described_columns(SQLite::Database& db);

/// Names of a table's columns.
std::set<std::string> stored_columns(SQLite::Database& db, const std::string& table,
                                     const std::string& schema = "main");

}  // namespace moma::store
