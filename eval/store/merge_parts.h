#pragma once

#include <SQLiteCpp/Database.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace moma::store {

// Parts of merge(): into `main`, from what is attached as `source`, in the caller's transaction.

/// Names of the columns that a table has here and in what is attached as `source`, which may be from before one of
/// them; stored ones only, without the integer key that each store gives on its own. `instead`: what stands in the list
/// for a column, in place of its name behind `prefix`.
std::string columns_of(SQLite::Database& db, const std::string& table, const std::string& prefix = {},
                       const std::map<std::string, std::string>& instead = {});

/// Everything that a new store has: tables, indices and views of moma's own.
std::set<std::string> own_names();

/// Adds searches, and continues those that both have; needs the temporary table map_suite (source, target). Returns how
/// many it changed. Throws StoreError{kContradiction} where one search has two paths from machines of one class.
std::size_t merge_searches(SQLite::Database& db, const std::filesystem::path& file, std::vector<std::string>& notes);

/// Brings tables, indices and views along that are not moma's. Throws StoreError where that would lose rows.
void merge_others(SQLite::Database& db, const std::filesystem::path& file, std::vector<std::string>& notes);

}  // namespace moma::store
