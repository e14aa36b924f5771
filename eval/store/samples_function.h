#pragma once

#include <SQLiteCpp/Database.h>

namespace moma::store {

/// Adds the table-valued function samples('TRIAL') to a connection to a store: the time series of the trial whose name
/// begins with TRIAL, one row per control step, with the column `step` from 0 and the columns that table `samples`
/// lists (store.md); NULL where a value is not finite, or where the trial's robot has no such column. A trial
/// without stored samples gives no rows, so that the function can be joined with v_trials; an unknown one is an error.
///
/// SQLite finds the function as a virtual table in `temp`, which hides the table of the same name: main.samples is
/// that. Call it before the connection is made read-only by query_only or an authorizer. The connection stays
/// where it is. Throws SQLite::Exception.
void add_samples_function(SQLite::Database& db);

/// Whether `sql` calls it: the word, followed by "(".
bool calls_samples_function(const char* sql) noexcept;

}  // namespace moma::store
