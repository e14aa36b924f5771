#pragma once

#include <sqlite3.h>

#include <memory>
#include <string>

namespace moma::store {

struct StatementFinalizer {
  void operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
};

/// A prepared statement of SQLite's C interface, for what SQLiteCpp does not reach: places of errors, limits,
/// statements inside of virtual tables.
using StatementPtr = std::unique_ptr<sqlite3_stmt, StatementFinalizer>;

/// The first statement of `sql`. Throws std::runtime_error with SQLite's message.
StatementPtr prepare_statement(sqlite3* connection, const char* sql);

/// The next row; false at the end. Throws std::runtime_error with SQLite's message.
bool step(sqlite3* connection, sqlite3_stmt* statement);

/// A value of SQLite's that is text, of so many bytes. Throws std::bad_alloc for nullptr, which SQLite gives where it
/// has no memory to end it.
std::string text_of(const unsigned char* text, int bytes);

/// A column of the present row as text; empty for NULL.
std::string column_text(sqlite3_stmt* statement, int column);

}  // namespace moma::store
