#include "eval/store/migrations.h"

#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <vector>

#include "eval/store/columns.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/table.h"

namespace moma::store {

extern const char* const kMigrate1To2Sql;

int schema_version(SQLite::Database& db) { return db.execAndGet("PRAGMA user_version").getInt(); }

void create_schema(SQLite::Database& db) {
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  // Another process may have been quicker between the look at the file and the lock.
  if (schema_version(db) != 0) return;
  db.exec(tables_sql());
  db.exec(views_sql());
  db.exec(fmt::format("PRAGMA application_id = {}", kApplicationId));
  db.exec(fmt::format("PRAGMA user_version = {}", kSchemaVersion));
  transaction.commit();
}

void migrate(SQLite::Database& db) {
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  // Version 2 moved what summaries ask for; the later ones brought described columns and other views.
  if (schema_version(db) == 1) db.exec(kMigrate1To2Sql);
  db.exec(fmt::format("PRAGMA user_version = {}", kSchemaVersion));
  transaction.commit();
}

std::set<std::string> stored_columns(SQLite::Database& db, const std::string& table, const std::string& schema) {
  const std::vector<std::string> names =
      rows<std::string>(db, "SELECT name FROM pragma_table_xinfo(?, ?)", table, schema);
  return {names.begin(), names.end()};
}

namespace {

/// A column that a table lacks, with its definition, and SQL of its value in the rows that are there.
struct Missing {
  std::string table, column, type, value;
  bool copied;  ///< of point_trial, from trial
};

/// Missing columns, those of one table one after the other.
std::vector<Missing> all_missing(SQLite::Database& db) {
  std::vector<Missing> missing;
  for (const auto& [table, columns] : described_tables()) {
    const std::set<std::string> stored = stored_columns(db, table);
    for (const ColumnDefinition& column : columns)
      if (!stored.contains(column.name))
        missing.push_back({table, column.name, column.type, column.type.ends_with("DEFAULT 0") ? "0" : "NULL", false});
  }
  const std::set<std::string> stored = stored_columns(db, "point_trial");
  for (const TrialColumn& column : trial_columns())
    if (column.about.averaged() && !stored.contains(std::string(column.name)))
      missing.push_back({"point_trial", std::string(column.name), "REAL",
                         fmt::format("(SELECT t.{} FROM trial AS t WHERE t.key = point_trial.key)", column.name),
                         true});
  return missing;
}

/// Returns the CHECK of a column's words in its definition; "" if it has none.
std::string words_check(const std::string& sql, std::string_view column) {
  const std::size_t from = sql.find(fmt::format("CHECK ({} IN (", column));
  const std::size_t to = from == std::string::npos ? from : sql.find("))", from);
  return to == std::string::npos ? "" : sql.substr(from, to + 2 - from);
}

/// A CHECK of a table's definition that lacks words, and what replaces it.
struct FewWords {
  std::string table, check, ours;
};

/// Words, in quotation marks, are only ever added: a list of more is a newer build's, and stays.
std::vector<FewWords> all_few_words(SQLite::Database& db) {
  std::vector<FewWords> found;
  SQLite::Statement find(db, "SELECT sql FROM main.sqlite_schema WHERE type = 'table' AND name = ?");
  for (const auto& [table, columns] : described_tables()) {
    const std::string stored = row<std::string>(find, table).value_or("");
    for (const ColumnDefinition& column : columns) {
      const std::string ours = words_check(column.type, column.name), check = words_check(stored, column.name);
      const auto marks = [](const std::string& sql) { return std::ranges::count(sql, '\''); };
      if (!check.empty() && marks(check) < marks(ours)) found.push_back({table, check, ours});
    }
  }
  return found;
}

/// Lets SQL write the schema while it lives (harden() in database.cc forbids it).
struct Undefended {
  explicit Undefended(SQLite::Database& of) : db(of) { defend(0); }
  ~Undefended() { defend(1); }
  Undefended(const Undefended&) = delete;
  Undefended& operator=(const Undefended&) = delete;
  void defend(int on) const { sqlite3_db_config(db.getHandle(), SQLITE_DBCONFIG_DEFENSIVE, on, nullptr); }
  SQLite::Database& db;
};

/// SQLite has no ALTER TABLE for CHECKs; its documentation of ALTER TABLE allows this for them, since they are in no
/// row.
void add_words(SQLite::Database& db) {
  const std::vector<FewWords> all = all_few_words(db);
  if (all.empty()) return;
  const Undefended undefended(db);
  db.exec("PRAGMA writable_schema = ON");
  for (const FewWords& few : all)
    execute(db, "UPDATE main.sqlite_schema SET sql = replace(sql, ?, ?) WHERE type = 'table' AND name = ?", few.check,
            few.ours, few.table);
  db.exec("PRAGMA writable_schema = RESET");
}

bool has_our_views(SQLite::Database& db) {
  const auto& ours = views();
  SQLite::Statement find(db, "SELECT sql FROM main.sqlite_schema WHERE type = 'view' AND name = ?");
  return std::ranges::all_of(ours, [&](const auto& view) { return row<std::string>(find, view.first) == view.second; });
}

}  // namespace

bool lacks_columns(SQLite::Database& db) { return !all_missing(db).empty(); }

void shadow_views(SQLite::Database& db) {
  const std::vector<Missing> missing = all_missing(db);
  for (auto at = missing.begin(); at != missing.end();) {
    const std::string& table = at->table;
    std::string values;
    for (; at != missing.end() && at->table == table; ++at) values += fmt::format(", {} AS {}", at->value, at->column);
    db.exec(fmt::format("CREATE TEMP VIEW {0} AS SELECT *{1} FROM main.{0}", table, values));
  }
  if (!missing.empty() || !has_our_views(db)) db.exec(temporary_views_sql());
}

void add_described_columns(SQLite::Database& db) {
  if (!lacks_columns(db) && all_few_words(db).empty() && has_our_views(db)) return;
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  // Asked again under the lock: another process may have been quicker.
  add_words(db);
  bool copied = false;
  for (const Missing& missing : all_missing(db)) {
    db.exec(fmt::format("ALTER TABLE {} ADD COLUMN {} {}", missing.table, missing.column, missing.type));
    if (missing.copied) db.exec(fmt::format("UPDATE {} SET {} = {}", missing.table, missing.column, missing.value));
    copied = copied || missing.copied;
  }
  if (copied) db.exec(summary_index_sql());
  db.exec(views_sql());
  transaction.commit();
}

}  // namespace moma::store
