#include "eval/store/statement.h"

#include <new>
#include <stdexcept>

namespace moma::store {

StatementPtr prepare_statement(sqlite3* connection, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(connection, sql, -1, &raw, nullptr) != SQLITE_OK)
    throw std::runtime_error(sqlite3_errmsg(connection));
  return StatementPtr(raw);
}

bool step(sqlite3* connection, sqlite3_stmt* statement) {
  const int code = sqlite3_step(statement);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  throw std::runtime_error(sqlite3_errmsg(connection));
}

std::string column_text(sqlite3_stmt* statement, int column) {
  if (sqlite3_column_type(statement, column) == SQLITE_NULL) return {};
  const unsigned char* const text = sqlite3_column_text(statement, column);
  return text_of(text, sqlite3_column_bytes(statement, column));
}

std::string text_of(const unsigned char* text, int bytes) {
  if (text == nullptr) throw std::bad_alloc();
  return {reinterpret_cast<const char*>(text), static_cast<std::size_t>(bytes)};
}

}  // namespace moma::store
