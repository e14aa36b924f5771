#include "eval/store/query.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include "eval/store/database.h"
#include "eval/store/hash.h"
#include "eval/store/samples.h"
#include "eval/store/statement.h"
#include "eval/store/table.h"

namespace moma::store {
namespace {

/// A table that is computed row by row: https://sqlite.org/vtab.html.
struct SamplesTable : sqlite3_vtab {
  SQLite::Database* db = nullptr;
  std::vector<std::string> columns;  // after `step`; the hidden `trial` comes last
};

struct SamplesCursor : sqlite3_vtab_cursor {
  std::string trial;  // as it was asked for
  SampleTable samples;
  std::vector<int> place;  // of each declared column among those of the samples; -1: has none
  std::int64_t n = 0;
  std::int64_t row = 0;
};

SamplesTable& table_of(sqlite3_vtab* base) { return *static_cast<SamplesTable*>(base); }
SamplesCursor& cursor_of(sqlite3_vtab_cursor* base) { return *static_cast<SamplesCursor*>(base); }

/// Sets the words that SQLite shows to the user, and gives the code that says so.
int fail(char*& words, const char* text) noexcept {
  sqlite3_free(words);
  words = sqlite3_mprintf("%s", text);
  return SQLITE_ERROR;
}

/// Runs `work`, which returns a code of SQLite. An exception becomes a code and a message: SQLite is C, and no
/// exception may pass through it.
template <typename Work>
int guarded(char*& words, Work&& work) noexcept {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return SQLITE_NOMEM;
  } catch (const std::exception& failure) {
    return fail(words, failure.what());
  }
}

/// The columns of all robots' samples, in the order of their first appearance. All trials of a robot have the same
/// ones, except for the controller's memory: earlier versions wrote fewer of these columns, and never others.
std::vector<std::string> known_columns(SQLite::Database& db) {
  std::vector<std::string> names;
  for (const std::string& text :
       rows<std::string>(db,
                         "SELECT (SELECT x.columns FROM main.point AS p JOIN main.point_trial AS m "
                         "ON m.point_id = p.id JOIN main.samples AS x ON x.key = m.key WHERE p.robot_id = r.id "
                         "AND x.n > 0 LIMIT 1) FROM main.robot AS r WHERE EXISTS (SELECT 1 FROM main.samples)")) {
    if (text.empty()) continue;
    std::vector<std::string> of_robot = column_names_of(text);
    add_written_columns(of_robot);
    for (const std::string& word : of_robot) {
      if (std::ranges::find(names, word) == names.end()) names.push_back(word);
    }
  }
  if (names.empty()) names.emplace_back("t");
  return names;
}

std::string declaration(const std::vector<std::string>& columns) {
  std::string sql = "CREATE TABLE samples (step INTEGER";
  for (const std::string& column : columns) sql += fmt::format(", {} REAL", sql_name(column));
  return sql + ", trial TEXT HIDDEN)";
}

/// The full key; throws with words for a person where there is none, or more than one.
Hash find_key(SQLite::Database& db, const std::string& prefix) {
  const auto range = key_range(prefix);
  if (!range) throw std::runtime_error(fmt::format("samples('{}'): a trial is named by its first hex digits", prefix));
  const std::vector<Hash> found =
      rows<Hash>(db, "SELECT key AS \"the trial's key\" FROM main.trial WHERE key BETWEEN ? AND ? ORDER BY key LIMIT 2",
                 range->first, range->second);
  if (found.empty()) throw std::runtime_error(fmt::format("samples('{}'): there is no such trial", prefix));
  if (found.size() > 1)
    throw std::runtime_error(fmt::format("samples('{}'): several trials begin so; give more digits", prefix));
  return found[0];
}

void load(SamplesCursor& cursor, const SamplesTable& table) {
  const Hash key = find_key(*table.db, cursor.trial);
  cursor.n = 0;
  cursor.place.assign(table.columns.size(), -1);
  const auto encoded = Table<EncodedSamples>(*table.db, "main.samples", {"key"}).find(key);
  if (!encoded) return;  // not kept
  cursor.samples = decode_table(*encoded);
  cursor.n = encoded->n;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const auto& names = cursor.samples.names;
    const auto found = std::ranges::find(names, table.columns[c]);
    if (found != names.end()) cursor.place[c] = static_cast<int>(found - names.begin());
  }
}

int connect(sqlite3* connection, void* db, int /*argc*/, const char* const* /*argv*/, sqlite3_vtab** out,
            char** error) {
  return guarded(*error, [&] {
    auto table = std::make_unique<SamplesTable>();
    table->db = static_cast<SQLite::Database*>(db);
    table->columns = known_columns(*table->db);
    const int code = sqlite3_declare_vtab(connection, declaration(table->columns).c_str());
    if (code == SQLITE_OK) *out = table.release();
    return code;
  });
}

int best_index(sqlite3_vtab* base, sqlite3_index_info* info) {
  const int hidden = static_cast<int>(table_of(base).columns.size()) + 1;
  for (int i = 0; i < info->nConstraint; ++i) {
    const auto& constraint = info->aConstraint[i];
    if (constraint.iColumn != hidden || constraint.op != SQLITE_INDEX_CONSTRAINT_EQ) continue;
    if (constraint.usable == 0) return SQLITE_CONSTRAINT;
    info->aConstraintUsage[i].argvIndex = 1;
    info->aConstraintUsage[i].omit = 1;
    info->estimatedCost = 1000.0;
    info->estimatedRows = 1000;
    return SQLITE_OK;
  }
  return fail(base->zErrMsg,
              "samples needs a trial, as in samples('06566cfa'); the table of the store is main.samples");
}

int filter(sqlite3_vtab_cursor* base, int /*number*/, const char* /*text*/, int argc, sqlite3_value** argv) {
  SamplesCursor& cursor = cursor_of(base);
  cursor.row = cursor.n = 0;
  return guarded(base->pVtab->zErrMsg, [&] {
    if (argc < 1 || sqlite3_value_type(argv[0]) == SQLITE_NULL) return SQLITE_OK;
    const unsigned char* const trial = sqlite3_value_text(argv[0]);
    if (trial == nullptr) throw std::bad_alloc();  // no memory to end the text
    cursor.trial.assign(reinterpret_cast<const char*>(trial), static_cast<std::size_t>(sqlite3_value_bytes(argv[0])));
    load(cursor, table_of(base->pVtab));
    return SQLITE_OK;
  });
}

int column(sqlite3_vtab_cursor* base, sqlite3_context* context, int index) {
  const SamplesCursor& cursor = cursor_of(base);
  if (index == 0) {
    sqlite3_result_int64(context, cursor.row);
  } else if (static_cast<std::size_t>(index) > cursor.place.size()) {
    sqlite3_result_text(context, cursor.trial.c_str(), -1, SQLITE_TRANSIENT);
  } else if (const int place = cursor.place[static_cast<std::size_t>(index) - 1]; place >= 0) {
    const double value = cursor.samples.columns[static_cast<std::size_t>(place)][static_cast<std::size_t>(cursor.row)];
    if (std::isfinite(value)) sqlite3_result_double(context, value);  // NULL otherwise
  }
  return SQLITE_OK;
}

sqlite3_module make_module() {
  sqlite3_module module{};
  module.xCreate = module.xConnect = &connect;
  module.xBestIndex = &best_index;
  module.xFilter = &filter;
  module.xColumn = &column;
  module.xDisconnect = module.xDestroy = [](sqlite3_vtab* base) {
    delete &table_of(base);
    return SQLITE_OK;
  };
  module.xOpen = [](sqlite3_vtab* /*table*/, sqlite3_vtab_cursor** out) {
    *out = new (std::nothrow) SamplesCursor;
    return *out == nullptr ? SQLITE_NOMEM : SQLITE_OK;
  };
  module.xClose = [](sqlite3_vtab_cursor* base) {
    delete &cursor_of(base);
    return SQLITE_OK;
  };
  module.xNext = [](sqlite3_vtab_cursor* base) {
    ++cursor_of(base).row;
    return SQLITE_OK;
  };
  module.xEof = [](sqlite3_vtab_cursor* base) { return cursor_of(base).row >= cursor_of(base).n ? 1 : 0; };
  module.xRowid = [](sqlite3_vtab_cursor* base, sqlite3_int64* out) {
    *out = cursor_of(base).row;
    return SQLITE_OK;
  };
  return module;
}

/// Adds the table-valued function samples('TRIAL') to a connection to a store: the time series of the trial whose name
/// begins with TRIAL, one row per control step, with the column `step` from 0 and the columns that table `samples`
/// lists (store.md); NULL where a value is not finite, or where the trial's robot has no such column. A trial
/// without stored samples gives no rows, so that the function can be joined with v_trials; an unknown one is an error.
/// SQLite finds the function as a virtual table in `temp`, which hides the table of the same name: main.samples is
/// that. The connection has to stay where it is, and is not restricted by an authorizer yet.
void add_samples_function(SQLite::Database& db) {
  static const sqlite3_module kModule = make_module();
  if (sqlite3_create_module_v2(db.getHandle(), "moma_samples", &kModule, &db, nullptr) != SQLITE_OK)
    throw SQLite::Exception(db.getHandle());
  db.exec(
      "PRAGMA query_only = OFF;"  // the file itself is opened for reading only
      "PRAGMA temp_store = MEMORY; CREATE VIRTUAL TABLE temp.samples USING moma_samples; PRAGMA query_only = ON");
}

/// Returns true if `sql` calls it: the word, followed by "(".
bool calls_samples_function(const char* sql) noexcept {
  constexpr const char* kName = "samples";
  constexpr std::size_t kLength = 7;
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; };
  for (const char* p = sql; *p != '\0'; ++p) {
    if (sqlite3_strnicmp(p, kName, kLength) != 0 || (p != sql && letter(p[-1]))) continue;
    const char* after = p + kLength;
    while (std::isspace(static_cast<unsigned char>(*after)) != 0) ++after;
    if (*after == '(') return true;
  }
  return false;
}

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

QueryResult query(const fs::path& file, const std::string& sql, std::chrono::milliseconds patience) {
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

std::optional<double> number_in(const Cell& cell) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*integer);
  if (const auto* real = std::get_if<double>(&cell)) return *real;
  return std::nullopt;
}

namespace {

std::string in_quotes(std::string_view text, char quote) {
  std::string quoted(1, quote);
  for (const char c : text) quoted.append(c == quote ? 2 : 1, c);
  return quoted + quote;
}

}  // namespace

std::string sql_literal(std::string_view text) { return in_quotes(text, '\''); }
std::string sql_name(std::string_view name) { return in_quotes(name, '"'); }

}  // namespace moma::store
