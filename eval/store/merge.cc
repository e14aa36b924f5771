#include "eval/store/merge.h"

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>

#include <set>
#include <string>
#include <system_error>

#include "eval/store/columns.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/migrations.h"
#include "eval/store/registry.h"

namespace moma::store {
namespace {

using SQLite::Statement;
namespace fs = std::filesystem;

constexpr const char* kContent[] = {"robot", "controller", "resolved_suite", "world"};

/// Names of a table's columns, stored ones only, without the integer key that each store gives on its own.
std::string columns_of(SQLite::Database& db, const std::string& table, const std::string& prefix = {}) {
  Statement s(db, fmt::format("SELECT name FROM pragma_table_xinfo('{}') WHERE hidden = 0 AND name <> 'id'", table));
  std::string names;
  while (s.executeStep()) names += (names.empty() ? "" : ", ") + prefix + s.getColumn(0).getString();
  return names;
}

/// Adds what is attached as `source`. Maps from its ids to ours are temporary tables.
class Importer {
 public:
  Importer(SQLite::Database& db, fs::path file) : db_(db), file_(std::move(file)) {}

  MergeSummary import() {
    for (const char* table : kContent) import_content(table);
    import_suites();
    import_points();
    import_invocations();
    check_contradictions();
    return import_trials();
  }

 private:
  /// Columns of a table of results that both stores have: the other one may be from before a metric was there. One from
  /// after would lose it.
  std::string shared_columns(const std::string& table, const std::string& prefix = {}) {
    const std::set<std::string> ours = stored_columns(db_, table);
    for (const std::string& name : stored_columns(db_, table, "source")) {
      if (ours.count(name) > 0) continue;
      throw StoreError(
          StoreError::Kind::kUnusable,
          fmt::format("{}: was written by a newer moma, which measures {}; use that moma", file_.string(), name));
    }
    Statement s(db_,
                "SELECT name FROM pragma_table_xinfo(?1, 'main') WHERE hidden = 0 AND name IN "
                "(SELECT name FROM pragma_table_xinfo(?1, 'source'))");
    s.bind(1, table);
    std::string names;
    while (s.executeStep()) names += (names.empty() ? "" : ", ") + prefix + s.getColumn(0).getString();
    return names;
  }

  void import_content(const std::string& table) {
    const std::string columns = columns_of(db_, table);
    db_.exec(fmt::format("INSERT OR IGNORE INTO {0} ({1}) SELECT {1} FROM source.{0} ORDER BY id", table, columns));
    make_map(table, fmt::format("SELECT s.id, o.id FROM source.{0} AS s JOIN main.{0} AS o USING (hash)", table));
  }

  void make_map(const std::string& name, const std::string& select) {
    db_.exec(fmt::format("CREATE TEMP TABLE map_{} (source INTEGER PRIMARY KEY, target INTEGER NOT NULL)", name));
    if (!select.empty()) db_.exec(fmt::format("INSERT INTO map_{} {}", name, select));
  }

  bool exists(const std::string& sql, const std::vector<std::string>& values) {
    Statement s(db_, sql);
    for (std::size_t i = 0; i < values.size(); ++i) s.bind(static_cast<int>(i) + 1, values[i]);
    return s.executeStep();
  }

  void import_suites() {
    make_map("suite", "");
    Statement missing(db_,
                      "SELECT s.id, s.file_name FROM source.suite AS s LEFT JOIN main.suite AS o "
                      "USING (file_name, setting_hash) WHERE o.id IS NULL ORDER BY s.id");
    Statement insert(db_,
                     "INSERT INTO main.suite (name, file_name, setting_hash) "
                     "SELECT ?, file_name, setting_hash FROM source.suite WHERE id = ?");
    while (missing.executeStep()) {
      const std::string shown = free_name(missing.getColumn(1).getString(), [&](const std::string& name) {
        return exists("SELECT 1 FROM main.suite WHERE name = ?", {name});
      });
      insert.reset();
      insert.bind(1, shown);
      insert.bind(2, missing.getColumn(0).getInt64());
      insert.exec();
    }
    db_.exec(
        "INSERT INTO map_suite SELECT s.id, o.id FROM source.suite AS s "
        "JOIN main.suite AS o USING (file_name, setting_hash)");
  }

  void import_points() {
    make_map("point", "");
    const std::string same =
        "o.suite_id = ms.target AND o.controller_name = s.controller_name AND o.label = s.label AND "
        "o.content_hash = s.content_hash";
    Statement missing(db_, fmt::format("SELECT s.id, s.controller_name, s.label, ms.target FROM source.point AS s "
                                       "JOIN map_suite AS ms ON ms.source = s.suite_id "
                                       "LEFT JOIN main.point AS o ON {} WHERE o.id IS NULL ORDER BY s.id",
                                       same));
    std::string columns;
    std::string values;
    Statement names(db_, "SELECT name FROM pragma_table_xinfo('point') WHERE name <> 'id'");
    while (names.executeStep()) {
      const std::string name = names.getColumn(0).getString();
      columns += (columns.empty() ? "" : ", ") + name;
      values += values.empty() ? "" : ", ";
      values += name == "suite_id"            ? "ms.target"
                : name == "controller"        ? "?1"
                : name == "robot_id"          ? "mr.target"
                : name == "controller_id"     ? "mc.target"
                : name == "resolved_suite_id" ? "mx.target"
                                              : "s." + name;
    }
    Statement insert(db_,
                     fmt::format("INSERT INTO main.point ({}) SELECT {} FROM source.point AS s "
                                 "JOIN map_suite AS ms ON ms.source = s.suite_id "
                                 "JOIN map_robot AS mr ON mr.source = s.robot_id "
                                 "JOIN map_controller AS mc ON mc.source = s.controller_id "
                                 "JOIN map_resolved_suite AS mx ON mx.source = s.resolved_suite_id WHERE s.id = ?2",
                                 columns, values));
    while (missing.executeStep()) {
      const std::string label = missing.getColumn(2).getString();
      const std::string suite = missing.getColumn(3).getString();
      const std::string shown = free_name(missing.getColumn(1).getString(), [&](const std::string& name) {
        return exists("SELECT 1 FROM main.point WHERE controller = ? AND label = ? AND suite_id = CAST(? AS INTEGER)",
                      {name, label, suite});
      });
      insert.reset();
      insert.bind(1, shown);
      insert.bind(2, missing.getColumn(0).getInt64());
      insert.exec();
    }
    db_.exec(
        fmt::format("INSERT INTO map_point SELECT s.id, o.id FROM source.point AS s "
                    "JOIN map_suite AS ms ON ms.source = s.suite_id JOIN main.point AS o ON {}",
                    same));
  }

  /// Merging the same store twice adds its invocations once.
  void import_invocations() {
    make_map("invocation", "");
    const std::string same =
        "o.suite_id = ms.target AND o.resolved_suite_id = mx.target AND o.started = s.started AND o.host = s.host AND "
        "o.arguments = s.arguments";
    const std::string from = fmt::format(
        "FROM source.invocation AS s JOIN map_suite AS ms ON ms.source = s.suite_id "
        "JOIN map_resolved_suite AS mx ON mx.source = s.resolved_suite_id "
        "LEFT JOIN main.invocation AS o ON {}",
        same);
    std::string columns;
    std::string values;
    Statement names(db_, "SELECT name FROM pragma_table_xinfo('invocation') WHERE name <> 'id'");
    while (names.executeStep()) {
      const std::string name = names.getColumn(0).getString();
      columns += (columns.empty() ? "" : ", ") + name;
      values += values.empty() ? "" : ", ";
      values += name == "suite_id" ? "ms.target" : name == "resolved_suite_id" ? "mx.target" : "s." + name;
    }
    db_.exec(fmt::format("INSERT INTO main.invocation ({}) SELECT {} {} WHERE o.id IS NULL ORDER BY s.id", columns,
                         values, from));
    db_.exec(fmt::format("INSERT INTO map_invocation SELECT s.id, min(o.id) {} GROUP BY s.id", from));
  }

  /// Two results for one key must agree in every deterministic column, within a class of machines.
  void check_contradictions() {
    const std::set<std::string> theirs = stored_columns(db_, "trial", "source");
    std::string differ = "t.outcome IS NOT o.outcome";
    for (const TrialColumn& column : trial_columns()) {
      if (theirs.count(std::string(column.name)) == 0) continue;  // from before it was measured
      differ += fmt::format(" OR (t.{0} IS NOT o.{0}{1})", column.name,
                            column.about.earlier == Earlier::kUnknown
                                ? fmt::format(" AND t.{0} IS NOT NULL AND o.{0} IS NOT NULL", column.name)
                                : "");
    }
    Statement s(db_, fmt::format("SELECT t.trial FROM source.trial AS t JOIN main.trial AS o USING (key) "
                                 "LEFT JOIN source.execution AS te ON te.key = t.key "
                                 "LEFT JOIN source.invocation AS ti ON ti.id = te.invocation_id "
                                 "LEFT JOIN main.execution AS oe ON oe.key = o.key "
                                 "LEFT JOIN main.invocation AS oi ON oi.id = oe.invocation_id "
                                 "WHERE (ti.machine_class IS NULL OR oi.machine_class IS NULL "
                                 "       OR ti.machine_class = oi.machine_class) AND ({}) ORDER BY t.key",
                                 differ));
    std::string found;
    std::size_t n = 0;
    while (s.executeStep()) {
      if (++n <= 5) found += (found.empty() ? "" : ", ") + s.getColumn(0).getString();
    }
    if (n == 0) return;
    throw StoreError(
        StoreError::Kind::kContradiction,
        fmt::format("{}: {} trials have other results than the same trials merged before, from machines of "
                    "the same class ({}{}); nothing was merged",
                    file_.string(), n, found, n > 5 ? ", ..." : ""));
  }

  MergeSummary import_trials() {
    MergeSummary summary;
    const auto total = static_cast<std::size_t>(db_.execAndGet("SELECT count(*) FROM source.trial").getInt64());
    const std::string trial = shared_columns("trial");
    std::string values = shared_columns("trial", "t.");
    values.replace(values.find("t.world_id"), 10, "mw.target");
    summary.added = static_cast<std::size_t>(
        db_.exec(fmt::format("INSERT OR IGNORE INTO main.trial ({}) SELECT {} FROM source.trial AS t "
                             "JOIN map_world AS mw ON mw.source = t.world_id ORDER BY t.key",
                             trial, values)));
    summary.present = total - summary.added;
    std::string execution = shared_columns("execution", "e.");
    execution.replace(execution.find("e.invocation_id"), 15, "mi.target");
    db_.exec(
        fmt::format("INSERT OR IGNORE INTO main.execution ({}) SELECT {} FROM source.execution AS e "
                    "JOIN map_invocation AS mi ON mi.source = e.invocation_id ORDER BY e.key",
                    shared_columns("execution"), execution));
    db_.exec(fmt::format("INSERT OR IGNORE INTO main.samples ({0}) SELECT {0} FROM source.samples ORDER BY key",
                         columns_of(db_, "samples")));
    db_.exec(
        fmt::format("INSERT OR IGNORE INTO main.point_trial (point_id, world_index, key, world_id, family, outcome, "
                    "time_to_goal_s, {}) "
                    "SELECT mp.target, m.world_index, m.key, t.world_id, w.family, t.outcome, t.time_to_goal_s, {} "
                    "FROM source.point_trial AS m "
                    "JOIN map_point AS mp ON mp.source = m.point_id JOIN main.trial AS t ON t.key = m.key "
                    "JOIN main.world AS w ON w.id = t.world_id ORDER BY 1, 2",
                    summary_list(), summary_list("t.")));
    import_metrics();
    for (const char* map : {"robot", "controller", "resolved_suite", "world", "suite", "point", "invocation"}) {
      db_.exec(fmt::format("DROP TABLE map_{}", map));
    }
    return summary;
  }

  /// Values of metrics; names as in the suite files, another expression under one name becomes NAME@2.
  void import_metrics() {
    Statement missing(db_,
                      "SELECT s.file_name, s.expression FROM source.metric AS s LEFT JOIN main.metric AS o "
                      "USING (file_name, expression) WHERE o.id IS NULL ORDER BY s.id");
    while (missing.executeStep()) metric_id(db_, missing.getColumn(0).getString(), missing.getColumn(1).getString());
    db_.exec(
        "INSERT OR IGNORE INTO main.metric_value (metric_id, key, value) SELECT o.id, v.key, v.value "
        "FROM source.metric_value AS v JOIN source.metric AS s ON s.id = v.metric_id "
        "JOIN main.metric AS o ON o.file_name = s.file_name AND o.expression = s.expression ORDER BY 1, 2");
  }

  SQLite::Database& db_;
  fs::path file_;
};

/// ATTACH cannot be in a transaction, so that each input has its own; the caller works on a new file.
void merge_into(SQLite::Database& db, const fs::path& file, MergeSummary& summary) {
  { const ReadConnection look(file); }  // ours, and of this version
  Statement attach(db, "ATTACH ? AS source");
  attach.bind(1, file.string());
  attach.exec();
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  const MergeSummary one = Importer(db, file).import();
  transaction.commit();
  db.exec("DETACH source");
  summary.added += one.added;
  summary.present += one.present;
}

void remove_store(const fs::path& file) {
  std::error_code ignored;
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(file.string() + suffix, ignored);
}

/// `out` is replaced by renaming, which must not happen under a program that has it open.
void check_unused(const fs::path& out) {
  { const SQLite::Database db = open_database(out, Access::kReadWrite); }  // the last to close removes the WAL
  std::error_code error;
  if (fs::exists(out.string() + "-wal", error)) {
    throw StoreError(StoreError::Kind::kUnusable,
                     fmt::format("{}: another program has it open; try again when it is done", out.string()));
  }
}

}  // namespace

MergeSummary merge(const fs::path& out, const std::vector<fs::path>& in) {
  std::error_code error;
  const bool there = fs::exists(out, error);
  if (there) check_unused(out);
  for (const fs::path& file : in) {
    if (fs::equivalent(file, out, error)) {
      throw StoreError(StoreError::Kind::kUnusable, fmt::format("{}: is input and output at once", out.string()));
    }
  }
  const fs::path part = out.string() + ".part";
  remove_store(part);
  const fs::path* current = &out;
  try {
    MergeSummary own;
    MergeSummary summary;
    {
      SQLite::Database db = open_database(part, Access::kCreate);
      if (there) merge_into(db, out, own);
      for (const fs::path& file : in) {
        current = &file;
        merge_into(db, file, summary);
      }
    }
    fs::rename(part, out);
    return summary;
  } catch (const SQLite::Exception& failure) {
    remove_store(part);
    throw explain(failure, *current, StoreError::Kind::kUnusable);
  } catch (...) {
    remove_store(part);
    throw;
  }
}

}  // namespace moma::store
