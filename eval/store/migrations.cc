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

/// ALTER TABLE for each described column that its table does not have, and what follows.
std::vector<std::string> all_additions(SQLite::Database& db) {
  std::vector<std::string> sql;
  for (const auto& [table, columns] : described_tables()) {
    const std::set<std::string> stored = stored_columns(db, table);
    for (const ColumnDefinition& column : columns)
      if (stored.count(column.name) == 0)
        sql.push_back(fmt::format("ALTER TABLE {} ADD COLUMN {} {}", table, column.name, column.type));
  }
  const std::set<std::string> there = stored_columns(db, "point_trial");
  bool copied = false;
  for (const TrialColumn& column : trial_columns()) {
    if (!column.about.averaged() || there.count(std::string(column.name)) != 0) continue;
    sql.push_back(fmt::format("ALTER TABLE point_trial ADD COLUMN {} REAL", column.name));
    sql.push_back(fmt::format(
        "UPDATE point_trial SET {0} = (SELECT t.{0} FROM trial AS t WHERE t.key = point_trial.key)", column.name));
    copied = true;
  }
  if (copied) sql.push_back(summary_index_sql());
  return sql;
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

bool lacks_columns(SQLite::Database& db) { return !all_additions(db).empty(); }

void shadow_views(SQLite::Database& db) {
  bool lacks = false;
  const auto shadow = [&](const std::string& table, const std::string& more) {
    if (more.empty()) return;
    db.exec(fmt::format("CREATE TEMP VIEW {0} AS SELECT *{1} FROM main.{0}", table, more));
    lacks = true;
  };
  for (const auto& [table, columns] : described_tables()) {
    const std::set<std::string> stored = stored_columns(db, table);
    std::string more;
    for (const ColumnDefinition& column : columns)
      if (!stored.contains(column.name))
        more += fmt::format(", {} AS {}", column.type.ends_with("DEFAULT 0") ? "0" : "NULL", column.name);
    shadow(table, more);
  }
  const std::set<std::string> copied = stored_columns(db, "point_trial");
  std::string more;
  for (const TrialColumn& column : trial_columns())
    if (column.about.averaged() && !copied.contains(std::string(column.name)))
      more += fmt::format(", NULL AS {}", column.name);
  shadow("point_trial", more);
  if (lacks || !has_our_views(db)) db.exec(temporary_views_sql());
}

void add_described_columns(SQLite::Database& db) {
  if (all_additions(db).empty() && all_few_words(db).empty() && has_our_views(db)) return;
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  // Asked again under the lock: another process may have been quicker.
  add_words(db);
  const std::vector<std::string> sql = all_additions(db);
  for (const std::string& statement : sql) db.exec(statement);
  db.exec(views_sql());
  transaction.commit();
}

}  // namespace moma::store
