#pragma once

#include <SQLiteCpp/Database.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "controller/config/paths.h"

namespace moma::store {

// Parts of merge(), from the attached store `source` into `main`, in the caller's transaction.

/// Names of the stored columns that a table has in both stores, without `id`, each after `prefix`. `instead`: SQL that
/// replaces a column.
std::string columns_of(SQLite::Database& db, const std::string& table, const std::string& prefix = {},
                       const std::map<std::string, std::string>& instead = {});

/// Names of moma's own tables, indices and views.
std::set<std::string> own_names();

/// Adds searches, and continues those that both stores have; needs the temporary table map_suite (source, target).
/// Returns the number of changed searches. Throws StoreError{kContradiction} if machines of one class took different
/// paths in one search.
std::size_t merge_searches(SQLite::Database& db, const fs::path& file, std::vector<std::string>& notes);

/// Adds tables, indices and views of other programs. Throws StoreError if rows would be lost.
void merge_others(SQLite::Database& db, const fs::path& file, std::vector<std::string>& notes);

}  // namespace moma::store
