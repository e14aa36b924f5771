#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <set>

#include "eval/store/definition.h"
#include "eval/store/error.h"
#include "eval/store/merge_searches.h"
#include "eval/store/table.h"

namespace moma::store {
namespace {

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

struct Object {
  std::string type, name, sql;
};

class Others {
 public:
  Others(SQLite::Database& db, const std::filesystem::path& file, std::vector<std::string>& notes)
      : db_(db), file_(file), notes_(notes) {}

  void execute() {
    const std::set<std::string> own = own_names();
    const auto objects = rows_as<Object, std::string, std::string, std::string>(
        db_,
        // Asked once: for each row of the join SQLite would compile every view again. A shadow goes with its table.
        "WITH l AS MATERIALIZED (SELECT name, type FROM pragma_table_list WHERE schema = 'source') "
        "SELECT iif(l.type = 'virtual', 'virtual table', s.type), s.name, s.sql FROM source.sqlite_schema AS s "
        "LEFT JOIN l ON l.name = s.name WHERE s.sql IS NOT NULL AND s.name NOT LIKE 'sqlite\\_%' ESCAPE '\\' "
        "AND l.type IS NOT 'shadow' ORDER BY s.type <> 'table', s.rowid");
    for (const Object& object : objects)
      if (own.count(object.name) == 0) bring(object);
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
    return row<std::string>(db_, "SELECT sql FROM main.sqlite_schema WHERE name = ?", name).value_or("");
  }

  /// One statement of SQL, as SQLite itself reads it out of the schema.
  void create(const Object& o) { SQLite::Statement(db_, o.sql).exec(); }

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
    std::string columns;
    for (const std::string& name :
         rows<std::string>(db_, "SELECT name FROM pragma_table_xinfo(?, 'source') WHERE hidden = 0", o.name))
      columns += (columns.empty() ? "" : ", ") + quoted(name);
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
  const std::vector<std::string> names = rows<std::string>(fresh, "SELECT name FROM sqlite_schema");
  return {names.begin(), names.end()};
}

void merge_others(SQLite::Database& db, const std::filesystem::path& file, std::vector<std::string>& notes) {
  Others(db, file, notes).execute();
}

}  // namespace moma::store
