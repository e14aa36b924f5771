#include "eval/store/merge_parts.h"

#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <cstdint>

#include "controller/describe/enumeration.h"
#include "eval/search/variables.h"
#include "eval/store/definition.h"
#include "eval/store/error.h"
#include "eval/store/query.h"
#include "eval/store/table.h"

namespace moma::store {
namespace {

using tune::SearchStatus;

/// Tables with the results of a search, replaced as a whole; evaluations are only added.
constexpr const char* kResults[] = {"tune_variable", "tune_finalist", "tune_sensitivity", "tune_comparison"};

struct Search {
  std::int64_t source = 0;
  std::int64_t target = 0;  ///< 0: not there yet
  std::string suite;
};

struct Searches {
  SQLite::Database& db;
  const fs::path& file;
  std::vector<std::string>& notes;

  std::size_t execute() {
    std::vector<Search> searches = rows_as<Search, std::int64_t, std::int64_t, std::string>(
        db,
        "SELECT s.id, coalesce(o.id, 0), s.suite FROM source.tune_search AS s "
        "LEFT JOIN main.tune_search AS o USING (hash) ORDER BY s.id");
    std::size_t changed = 0;
    for (Search& search : searches) changed += (search.target == 0 ? add(search) : go_on(search)) ? 1 : 0;
    return changed;
  }

  /// The columns of tune_search with the held-out suite by the name that it has in OUT.
  std::string values() {
    return columns_of(
        db, "tune_search", "s.",
        {{"held_out_suite",
          "coalesce((SELECT o.name FROM source.suite AS i JOIN map_suite AS m ON m.source = i.id "
          "JOIN main.suite AS o ON o.id = m.target WHERE i.name = s.held_out_suite), s.held_out_suite)"}});
  }

  void copy(const char* table, const Search& search) {
    db.exec(fmt::format(
        "INSERT INTO main.{0} ({1}) SELECT {2} FROM source.{0} WHERE search_id = {3} ON CONFLICT DO NOTHING", table,
        columns_of(db, table), columns_of(db, table, "", {{"search_id", std::to_string(search.target)}}),
        search.source));
  }

  bool add(Search& search) {
    db.exec(fmt::format("INSERT INTO main.tune_search ({}) SELECT {} FROM source.tune_search AS s WHERE s.id = {}",
                        columns_of(db, "tune_search"), values(), search.source));
    search.target = db.getLastInsertRowid();
    copy("tune_evaluation", search);
    for (const char* table : kResults) copy(table, search);
    return true;
  }

  bool go_on(const Search& search) {
    if (contradicts(search)) return false;
    const int before = db.getTotalChanges();
    copy("tune_evaluation", search);
    // 0: under way, 1: searched, 2: judged
    const auto how_far = [&](const char* schema, std::int64_t id) {
      return row<int>(
          db,
          fmt::format("SELECT (status = ?1) * (1 + (verdict IS NOT NULL)) FROM {}.tune_search WHERE id = ?2", schema),
          SearchStatus::kFinished, id);
    };
    if (how_far("source", search.source) > how_far("main", search.target)) {
      const std::string columns = columns_of(db, "tune_search");
      db.exec(
          fmt::format("UPDATE main.tune_search SET ({}) = (SELECT {} FROM source.tune_search AS s WHERE s.id = {}) "
                      "WHERE id = {}",
                      columns, values(), search.source, search.target));
      for (const char* table : kResults) {
        db.exec(fmt::format("DELETE FROM main.{} WHERE search_id = {}", table, search.target));
        copy(table, search);
      }
    }
    return db.getTotalChanges() != before;
  }

  bool contradicts(const Search& search) {
    const auto columns = rows<std::string>(db,
                                           "SELECT name FROM pragma_table_xinfo('tune_evaluation', 'main') WHERE "
                                           "hidden = 0 AND name NOT IN ('search_id', 'evaluation')");
    const std::string differ = joined(
        columns, [](const std::string& name) { return fmt::format("s.{0} IS NOT o.{0}", name); }, " OR ");
    const std::size_t n =
        count(db,
              fmt::format("SELECT count(*) FROM source.tune_evaluation AS s JOIN main.tune_evaluation AS o "
                          "USING (evaluation) WHERE s.search_id = ? AND o.search_id = ? AND ({})",
                          differ),
              search.source, search.target);
    if (n == 0) return false;
    const bool one_class = count(db,
                                 "SELECT count(*) FROM (SELECT machine_class FROM main.invocation UNION "
                                 "SELECT machine_class FROM source.invocation)") == 1;
    const std::string what =
        fmt::format("{}: its search in suite {} has {} evaluations that differ from those merged before", file.string(),
                    search.suite, n);
    if (one_class)
      throw StoreError(StoreError::Kind::kContradiction,
                       what + ", from machines of the same class; nothing was merged");
    notes.push_back(what + ", from machines of another class: the search that was there is kept");
    return true;
  }
};

}  // namespace

std::string columns_of(SQLite::Database& db, const std::string& table, const std::string& prefix,
                       const std::map<std::string, std::string>& instead) {
  const auto names = rows<std::string>(db,
                                       "SELECT name FROM pragma_table_xinfo(?1, 'main') WHERE hidden = 0 AND name <> "
                                       "'id' AND name IN (SELECT name FROM pragma_table_xinfo(?1, 'source'))",
                                       table);
  return joined(names, [&](const std::string& name) {
    const auto other = instead.find(name);
    return other != instead.end() ? other->second : prefix + name;
  });
}

std::size_t merge_searches(SQLite::Database& db, const fs::path& file, std::vector<std::string>& notes) {
  return Searches{db, file, notes}.execute();
}

namespace {

struct Object {
  std::string type, name, sql;
};

struct Others {
  SQLite::Database& db;
  const fs::path& file;
  std::vector<std::string>& notes;

  void execute() {
    const std::set<std::string> own = own_names();
    const auto objects = rows_as<Object, std::string, std::string, std::string>(
        db,
        // Asked once: for each row of the join SQLite would compile every view again. A shadow goes with its table.
        "WITH l AS MATERIALIZED (SELECT name, type FROM pragma_table_list WHERE schema = 'source') "
        "SELECT iif(l.type = 'virtual', 'virtual table', s.type), s.name, s.sql FROM source.sqlite_schema AS s "
        "LEFT JOIN l ON l.name = s.name WHERE s.sql IS NOT NULL AND s.name NOT LIKE 'sqlite\\_%' ESCAPE '\\' "
        "AND l.type IS NOT 'shadow' ORDER BY s.type <> 'table', s.rowid");
    for (const Object& object : objects)
      if (own.count(object.name) == 0) bring(object);
  }

  void bring(const Object& o) {
    if (o.type == "table") return bring_table(o);
    if (!there(o.name).empty()) return;
    if (o.type == "index" || o.type == "view") return create(o);
    notes.push_back(fmt::format("{}: its {} {} does not come along: merging takes tables, indices and views of others",
                                file.string(), o.type, o.name));
  }

  /// Definition of this name in OUT; "" without one.
  std::string there(const std::string& name) {
    return row<std::string>(db, "SELECT sql FROM main.sqlite_schema WHERE name = ?", name).value_or("");
  }

  /// One statement of SQL, as SQLite itself reads it out of the schema.
  void create(const Object& o) { SQLite::Statement(db, o.sql).exec(); }

  void bring_table(const Object& o) {
    const std::string ours = there(o.name);
    if (!ours.empty() && ours != o.sql) {
      throw unusable(file, fmt::format("its table {}, which is not moma's, has other columns than the one merged "
                                       "before; rename one of them",
                                       o.name));
    }
    if (ours.empty()) create(o);
    const std::string columns = joined(
        rows<std::string>(db, "SELECT name FROM pragma_table_xinfo(?, 'source') WHERE hidden = 0", o.name), &sql_name);
    try {
      db.exec(
          fmt::format("INSERT INTO main.{0} ({1}) SELECT {1} FROM source.{0}{2}", sql_name(o.name), columns,
                      ours.empty() ? "" : fmt::format(" EXCEPT SELECT {} FROM main.{}", columns, sql_name(o.name))));
    } catch (const SQLite::Exception& error) {
      if (error.getErrorCode() != SQLITE_CONSTRAINT) throw;
      throw unusable(file, fmt::format("its table {}, which is not moma's, contradicts the one merged before ({}); "
                                       "rename one of them",
                                       o.name, error.what()));
    }
  }
};

}  // namespace

std::set<std::string> own_names() {
  SQLite::Database fresh(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  fresh.exec(tables_sql());
  fresh.exec(views_sql());
  const std::vector<std::string> names = rows<std::string>(fresh, "SELECT name FROM sqlite_schema");
  return {names.begin(), names.end()};
}

void merge_others(SQLite::Database& db, const fs::path& file, std::vector<std::string>& notes) {
  Others{db, file, notes}.execute();
}

}  // namespace moma::store
