#pragma once

#include <SQLiteCpp/Database.h>

#include <cstddef>

namespace moma::store {

/// Trials that ended because real time ran out, which stores of earlier versions hold as results (plugin/host/late.h).
std::size_t count_late(const SQLite::Database& db);
/// Removes them with all that belongs to them, so that they are tried again; returns how many. One look through all
/// rows.
std::size_t forget_late(SQLite::Database& db);

}  // namespace moma::store
