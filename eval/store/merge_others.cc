#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <set>

#include "eval/store/definition.h"
#include "eval/store/error.h"
#include "eval/store/merge_searches.h"

namespace moma::store {
namespace {

using SQLite::Statement;

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

struct Object {
  std::string type, name, table, sql;
};

class Others {
 public:
  Others(SQLite::Database& db, const std::filesystem::path& file, std::vector<std::string>& notes)
      : db_(db), file_(file), notes_(notes) {}

  void execute() {
    const std::set<std::string> own = own_names();
    std::vector<Object> objects;
    Statement all(
        db_,
        // Asked once: for each row of the join SQLite would compile every view again.
        "WITH l AS MATERIALIZED (SELECT name, type FROM pragma_table_list WHERE schema = 'source') "
        "SELECT s.type, s.name, s.tbl_name, s.sql, coalesce(l.type, '') FROM source.sqlite_schema AS s "
        "LEFT JOIN l ON l.name = s.name "
        "WHERE s.sql IS NOT NULL AND s.name NOT LIKE 'sqlite\\_%' ESCAPE '\\' ORDER BY s.type <> 'table', s.rowid");
    while (all.executeStep()) {
      Object o{all.getColumn(0).getString(), all.getColumn(1).getString(), all.getColumn(2).getString(),
               all.getColumn(3).getString()};
      if (own.count(o.name) > 0) continue;
      const std::string kind = all.getColumn(4).getString();
      if (kind == "shadow") continue;  // goes with its virtual table
      if (kind == "virtual") o.type = "virtual table";
      objects.push_back(std::move(o));
    }
    all.reset();
    for (const Object& object : objects) bring(object);
  }

 private:
  void bring(const Object& o) {
    if (o.type == "table") return bring_table(o);
    if (!there(o.name).empty()) return;
    if (o.type == "index" || o.type == "view") return create(o);
    notes_.push_back(fmt::format("{}: its {} {} does not come along: merging takes tables, indices and views of others",
                                 file_.string(), o.type, o.name));
  }

  /// How OUT defines what has this name; "" where nothing has.
  std::string there(const std::string& name) {
    Statement s(db_, "SELECT sql FROM main.sqlite_schema WHERE name = ?");
    s.bind(1, name);
    return s.executeStep() ? s.getColumn(0).getString() : std::string();
  }

  /// One statement of SQL, as SQLite itself reads it out of the schema.
  void create(const Object& o) { Statement(db_, o.sql).exec(); }

  void bring_table(const Object& o) {
    const std::string ours = there(o.name);
    if (!ours.empty() && ours != o.sql) {
      throw StoreError(
          StoreError::Kind::kUnusable,
          fmt::format("{}: its table {}, which is not moma's, has other columns than the one merged before; "
                      "rename one of them",
                      file_.string(), o.name));
    }
    if (ours.empty()) create(o);
    Statement names(db_, "SELECT name FROM pragma_table_xinfo(?, 'source') WHERE hidden = 0");
    names.bind(1, o.name);
    std::string columns;
    while (names.executeStep()) columns += (columns.empty() ? "" : ", ") + quoted(names.getColumn(0).getString());
    names.reset();
    try {
      db_.exec(fmt::format("INSERT INTO main.{0} ({1}) SELECT {1} FROM source.{0}{2}", quoted(o.name), columns,
                           ours.empty() ? "" : fmt::format(" EXCEPT SELECT {} FROM main.{}", columns, quoted(o.name))));
    } catch (const SQLite::Exception& error) {
      if (error.getErrorCode() != SQLITE_CONSTRAINT) throw;
      throw StoreError(
          StoreError::Kind::kUnusable,
          fmt::format("{}: its table {}, which is not moma's, contradicts the one merged before ({}); rename "
                      "one of them",
                      file_.string(), o.name, error.what()));
    }
  }

  SQLite::Database& db_;
  const std::filesystem::path& file_;
  std::vector<std::string>& notes_;
};

}  // namespace

std::set<std::string> own_names() {
  SQLite::Database fresh(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  fresh.exec(tables_sql());
  fresh.exec(views_sql());
  std::set<std::string> names;
  Statement s(fresh, "SELECT name FROM sqlite_schema");
  while (s.executeStep()) names.insert(s.getColumn(0).getString());
  return names;
}

void merge_others(SQLite::Database& db, const std::filesystem::path& file, std::vector<std::string>& notes) {
  Others(db, file, notes).execute();
}

}  // namespace moma::store
