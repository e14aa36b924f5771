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
Hash find_key(SQLite::Database& db, const std::string& prefix) {
  const auto range = key_range(prefix);
  if (!range) throw std::runtime_error(fmt::format("samples('{}'): a trial is named by its first hex digits", prefix));
  const std::vector<Hash> found = rows<Hash>(
      db, "SELECT key FROM main.trial WHERE key BETWEEN ? AND ? ORDER BY key LIMIT 2", range->first, range->second);
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
    const auto found = std::find(names.begin(), names.end(), table.columns[c]);
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

}  // namespace

void add_samples_function(SQLite::Database& db) {
  static const sqlite3_module kModule = make_module();
  if (sqlite3_create_module_v2(db.getHandle(), "moma_samples", &kModule, &db, nullptr) != SQLITE_OK)
    throw SQLite::Exception(db.getHandle());
  db.exec(
      "PRAGMA query_only = OFF;"  // the file itself is opened for reading only
      "PRAGMA temp_store = MEMORY; CREATE VIRTUAL TABLE temp.samples USING moma_samples; PRAGMA query_only = ON");
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
