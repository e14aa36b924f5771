#pragma once

#include <SQLiteCpp/Statement.h>

#include <set>
#include <string>

#include "eval/store/columns.h"
#include "eval/store/hash.h"
#include "eval/trial/row.h"

namespace moma::store {

/// "outcome, reason, ..., steps": all deterministic columns of table trial.
std::string trial_column_list(const std::string& prefix = {});
/// The same to be read from a store that an older moma wrote: NULL in place of columns that it does not have.
std::string trial_column_list(const std::string& prefix, const std::set<std::string>& stored);

/// Binds outcome and all deterministic columns from parameter `first` on; returns the next free parameter.
int bind_row(SQLite::Statement& statement, int first, const TrialRow& row);
/// Reads what trial_column_list() selects, from column `first` on.
TrialRow read_row(SQLite::Statement& statement, int first);

void bind_hash(SQLite::Statement& statement, int index, const Hash& hash);
/// Absent and infinite values become NULL.
void bind_number(SQLite::Statement& statement, int index, double value);

}  // namespace moma::store
