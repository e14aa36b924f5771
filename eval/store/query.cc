#include "eval/store/query.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <bit>
#include <cstring>
#include <new>

#include "eval/store/database.h"
#include "eval/store/samples_function.h"
#include "eval/store/statement.h"

namespace moma::store {
namespace {

/// Read-only opening already forbids changes to the file; this forbids reaching other files.
int authorize(void* /*unused*/, int action, const char* first, const char* second, const char* /*database*/,
              const char* /*trigger*/) {
  switch (action) {
    case SQLITE_ATTACH:
    case SQLITE_DETACH:
    case SQLITE_CREATE_TEMP_TABLE:
    case SQLITE_CREATE_VTABLE:
      return SQLITE_DENY;
    case SQLITE_FUNCTION:  // tells where code lies in memory, and takes such a place
      return second != nullptr && std::strcmp(second, "fts3_tokenizer") == 0 ? SQLITE_DENY : SQLITE_OK;
    case SQLITE_PRAGMA:
      // PRAGMAs that only tell something; the argument of the table ones is a name.
      for (const char* allowed : {"table_info", "table_xinfo", "table_list", "index_list", "index_info",
                                  "foreign_key_list", "foreign_key_check", "integrity_check", "quick_check"}) {
        if (std::strcmp(first, allowed) == 0) return SQLITE_OK;
      }
      return second == nullptr ? SQLITE_OK : SQLITE_DENY;
    default:
      return SQLITE_OK;
  }
}

/// SQLite's message, with the line of the statement where it knows the place.
QueryError sql_error(sqlite3* handle, const std::string& sql) {
  const int code = sqlite3_errcode(handle);
  std::string message = sqlite3_errmsg(handle);
  if (code == SQLITE_READONLY) message = "the store is opened for reading only: a query cannot change it";
  if (code == SQLITE_AUTH)
    message = "not allowed in a query: it reads this one store and nothing else (" + message + ")";
  const int offset = sqlite3_error_offset(handle);
  if (offset < 0 || static_cast<std::size_t>(offset) >= sql.size()) return QueryError("SQL: " + message);
  const std::size_t begin = sql.rfind('\n', static_cast<std::size_t>(offset));
  const std::size_t start = begin == std::string::npos ? 0 : begin + 1;
  const std::string line = sql.substr(start, sql.find('\n', start) - start);
  const std::size_t column = static_cast<std::size_t>(offset) - start;
  return QueryError(fmt::format("SQL: {}\n  {}\n  {:>{}}", message, line, "^", column + 1));
}

void bit_count(sqlite3_context* context, int /*count*/, sqlite3_value** values) {
  sqlite3_result_int(context, std::popcount(static_cast<std::uint64_t>(sqlite3_value_int64(values[0]))));
}

Cell read_cell(sqlite3_stmt* statement, int i) {
  switch (sqlite3_column_type(statement, i)) {
    case SQLITE_INTEGER:
      return sqlite3_column_int64(statement, i);
    case SQLITE_FLOAT:
      return sqlite3_column_double(statement, i);
    case SQLITE_TEXT: {
      const unsigned char* const text = sqlite3_column_text(statement, i);
      if (text == nullptr) throw std::bad_alloc();  // no memory to end it
      return std::string(reinterpret_cast<const char*>(text),
                         static_cast<std::size_t>(sqlite3_column_bytes(statement, i)));
    }
    case SQLITE_BLOB: {
      const auto* bytes = static_cast<const unsigned char*>(sqlite3_column_blob(statement, i));
      std::string hex;
      for (int k = 0; k < sqlite3_column_bytes(statement, i); ++k) hex += fmt::format("{:02x}", bytes[k]);
      return hex;
    }
    default:
      return std::monostate{};
  }
}

StatementPtr prepare_query(sqlite3* handle, const std::string& sql) {
  sqlite3_stmt* raw = nullptr;
  const char* tail = nullptr;
  if (sqlite3_prepare_v2(handle, sql.c_str(), static_cast<int>(sql.size() + 1), &raw, &tail) != SQLITE_OK) {
    throw sql_error(handle, sql);
  }
  StatementPtr statement(raw);
  if (statement == nullptr) throw QueryError("SQL: the query is empty; try 'SELECT * FROM v_trials' or @summary");
  sqlite3_stmt* second = nullptr;  // comments and blanks after the statement are fine
  const int code = sqlite3_prepare_v2(handle, tail, -1, &second, nullptr);
  const StatementPtr rest(second);
  if (code != SQLITE_OK || rest != nullptr) throw QueryError("SQL: one statement at a time, please");
  if (sqlite3_bind_parameter_count(statement.get()) > 0) {
    throw QueryError("SQL: the query has an unbound parameter (? or :name); write the value instead");
  }
  return statement;
}

}  // namespace

QueryResult query(const std::filesystem::path& file, const std::string& sql, std::chrono::milliseconds patience) {
  ReadConnection connection(file);
  sqlite3* const handle = connection.db().getHandle();
  try {
    if (calls_samples_function(sql.c_str())) add_samples_function(connection.db());
  } catch (const SQLite::Exception& error) {
    throw explain(error, file, StoreError::Kind::kUnusable);
  }
  connection.db().createFunction("bit_count", 1, true, nullptr, &bit_count);
  sqlite3_set_authorizer(handle, &authorize, nullptr);
  const StatementPtr statement = prepare_query(handle, sql);
  const auto end = std::chrono::steady_clock::now() + patience;
  const auto over = [](void* moment) {
    return std::chrono::steady_clock::now() > *static_cast<const std::chrono::steady_clock::time_point*>(moment) ? 1
                                                                                                                 : 0;
  };
  if (patience.count() > 0)
    sqlite3_progress_handler(handle, 10000, over, const_cast<std::chrono::steady_clock::time_point*>(&end));
  QueryResult result;
  const int columns = sqlite3_column_count(statement.get());
  for (int i = 0; i < columns; ++i) result.columns.emplace_back(sqlite3_column_name(statement.get(), i));
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(statement.get())) == SQLITE_ROW) {
    std::vector<Cell>& row = result.rows.emplace_back();
    row.reserve(static_cast<std::size_t>(columns));
    for (int i = 0; i < columns; ++i) row.push_back(read_cell(statement.get(), i));
  }
  if (code == SQLITE_INTERRUPT)
    throw QueryError(fmt::format("SQL: given up after {} s; the store's views may not be moma's ('moma verify' tells)",
                                 static_cast<double>(patience.count()) / 1000.0));
  if (code != SQLITE_DONE) throw sql_error(handle, sql);
  result.steps = sqlite3_stmt_status(statement.get(), SQLITE_STMTSTATUS_VM_STEP, 0);
  return result;
}

std::string sql_literal(std::string_view text) {
  std::string literal = "'";
  for (const char c : text) literal += c == '\'' ? std::string("''") : std::string(1, c);
  return literal + "'";
}

}  // namespace moma::store
