#pragma once

#include <sqlite3.h>

#include <memory>

namespace moma::store {

struct StatementFinalizer {
  void operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
};

/// A prepared statement of SQLite's C interface, for what SQLiteCpp does not reach: places of errors, limits.
using StatementPtr = std::unique_ptr<sqlite3_stmt, StatementFinalizer>;

}  // namespace moma::store
