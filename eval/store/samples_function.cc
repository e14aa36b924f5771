#include "eval/store/samples_function.h"

#include <SQLiteCpp/Exception.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/config/json_node.h"
#include "eval/store/hash.h"
#include "eval/store/samples.h"
#include "eval/store/statement.h"

namespace moma::store {
namespace {

struct Table : sqlite3_vtab {
  sqlite3* connection = nullptr;
  std::vector<std::string> columns;  // after `step`; the hidden `trial` comes last
};

struct Cursor : sqlite3_vtab_cursor {
  std::string trial;  // as it was asked for
  SampleTable samples;
  std::vector<int> place;  // of each declared column among those of the samples; -1: has none
  std::int64_t n = 0;
  std::int64_t row = 0;
};

Table& table_of(sqlite3_vtab* base) { return *static_cast<Table*>(base); }
Cursor& cursor_of(sqlite3_vtab_cursor* base) { return *static_cast<Cursor*>(base); }

/// Sets the words that SQLite shows to the user, and gives the code that says so.
int fail(char*& words, const char* text) noexcept {
  sqlite3_free(words);
  words = sqlite3_mprintf("%s", text);
  return SQLITE_ERROR;
}

/// Runs `work`, which gives a code of SQLite; what it throws becomes a code and words, since SQLite calls from C and no
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

/// The columns of all robots' samples, in the order in which they appear. All trials of a robot have the same, but for
/// what the controller remembered, of which earlier versions wrote less: what this one writes is among them.
std::vector<std::string> known_columns(sqlite3* connection) {
  const StatementPtr query =
      prepare_statement(connection,
                        "SELECT (SELECT x.columns FROM main.point AS p JOIN main.point_trial AS m "
                        "ON m.point_id = p.id JOIN main.samples AS x ON x.key = m.key WHERE p.robot_id = r.id "
                        "AND x.n > 0 LIMIT 1) FROM main.robot AS r WHERE EXISTS (SELECT 1 FROM main.samples)");
  std::vector<std::string> names;
  while (step(connection, query.get())) {
    const std::string text = column_text(query.get(), 0);
    if (text.empty()) continue;
    std::vector<std::string> of_robot = column_names_of(text);
    add_written_columns(of_robot);
    for (const std::string& word : of_robot) {
      if (std::find(names.begin(), names.end(), word) == names.end()) names.push_back(word);
    }
  }
  if (names.empty()) names.emplace_back("t");
  return names;
}

std::string declaration(const std::vector<std::string>& columns) {
  std::string sql = "CREATE TABLE samples (step INTEGER";
  for (const std::string& column : columns) {
    std::string quoted;
    for (const char c : column) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    sql += fmt::format(", \"{}\" REAL", quoted);
  }
  return sql + ", trial TEXT HIDDEN)";
}

/// The full key; throws with words for a person where there is none, or more than one.
std::string find_key(sqlite3* connection, std::string prefix) {
  std::transform(prefix.begin(), prefix.end(), prefix.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool hex = !prefix.empty() && prefix.size() <= 32 &&
                   std::all_of(prefix.begin(), prefix.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
  if (!hex) throw std::runtime_error(fmt::format("samples('{}'): a trial is named by its first hex digits", prefix));
  std::string low = prefix;
  std::string high = prefix;
  low.resize(32, '0');
  high.resize(32, 'f');
  const Hash first = hash_from_hex(low);
  const Hash last = hash_from_hex(high);
  const StatementPtr query =
      prepare_statement(connection, "SELECT key FROM main.trial WHERE key BETWEEN ? AND ? ORDER BY key LIMIT 2");
  sqlite3_bind_blob(query.get(), 1, first.data(), static_cast<int>(first.size()), SQLITE_STATIC);
  sqlite3_bind_blob(query.get(), 2, last.data(), static_cast<int>(last.size()), SQLITE_STATIC);
  if (!step(connection, query.get()))
    throw std::runtime_error(fmt::format("samples('{}'): there is no such trial", prefix));
  const auto bytes = static_cast<std::size_t>(sqlite3_column_bytes(query.get(), 0));
  if (bytes != first.size())
    throw std::runtime_error(
        fmt::format("samples('{}'): the trial's key has {} bytes instead of {}; the store is damaged", prefix, bytes,
                    first.size()));
  std::string key(static_cast<const char*>(sqlite3_column_blob(query.get(), 0)), bytes);
  if (step(connection, query.get()))
    throw std::runtime_error(fmt::format("samples('{}'): several trials begin so; give more digits", prefix));
  return key;
}

void load(Cursor& cursor, const Table& table) {
  const std::string key = find_key(table.connection, cursor.trial);
  const StatementPtr query =
      prepare_statement(table.connection, "SELECT layout, n, columns, data FROM main.samples WHERE key = ?");
  sqlite3_bind_blob(query.get(), 1, key.data(), static_cast<int>(key.size()), SQLITE_STATIC);
  cursor.n = 0;
  cursor.place.assign(table.columns.size(), -1);
  if (!step(table.connection, query.get())) return;  // not kept
  EncodedSamples encoded;
  encoded.layout = sqlite3_column_int(query.get(), 0);
  encoded.n = sqlite3_column_int64(query.get(), 1);
  encoded.columns = column_text(query.get(), 2);
  const auto* data = static_cast<const unsigned char*>(sqlite3_column_blob(query.get(), 3));
  if (data != nullptr) encoded.data.assign(data, data + sqlite3_column_bytes(query.get(), 3));
  cursor.samples = decode_table(encoded);
  cursor.n = encoded.n;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const auto& names = cursor.samples.names;
    const auto found = std::find(names.begin(), names.end(), table.columns[c]);
    if (found != names.end()) cursor.place[c] = static_cast<int>(found - names.begin());
  }
}

int connect(sqlite3* connection, void* /*data*/, int /*argc*/, const char* const* /*argv*/, sqlite3_vtab** out,
            char** error) {
  return guarded(*error, [&] {
    auto table = std::make_unique<Table>();
    table->connection = connection;
    table->columns = known_columns(connection);
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
  Cursor& cursor = cursor_of(base);
  cursor.row = cursor.n = 0;
  return guarded(base->pVtab->zErrMsg, [&] {
    if (argc < 1 || sqlite3_value_type(argv[0]) == SQLITE_NULL) return SQLITE_OK;
    const unsigned char* const trial = sqlite3_value_text(argv[0]);
    cursor.trial = text_of(trial, sqlite3_value_bytes(argv[0]));
    load(cursor, table_of(base->pVtab));
    return SQLITE_OK;
  });
}

int column(sqlite3_vtab_cursor* base, sqlite3_context* context, int index) {
  const Cursor& cursor = cursor_of(base);
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

/// https://sqlite.org/vtab.html
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
    *out = new (std::nothrow) Cursor;
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

void execute(sqlite3* connection, const char* sql) {
  if (sqlite3_exec(connection, sql, nullptr, nullptr, nullptr) != SQLITE_OK) throw SQLite::Exception(connection);
}

}  // namespace

void add_samples_function(sqlite3* connection) {
  static const sqlite3_module kModule = make_module();
  if (sqlite3_create_module_v2(connection, "moma_samples", &kModule, nullptr, nullptr) != SQLITE_OK)
    throw SQLite::Exception(connection);
  execute(connection, "PRAGMA query_only = OFF");  // the file itself is opened for reading only
  execute(connection, "PRAGMA temp_store = MEMORY");
  execute(connection, "CREATE VIRTUAL TABLE temp.samples USING moma_samples");
  execute(connection, "PRAGMA query_only = ON");
}

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

}  // namespace moma::store
