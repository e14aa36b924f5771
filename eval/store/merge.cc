#include "eval/store/merge.h"

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "eval/store/columns.h"
#include "eval/store/contents.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/late.h"
#include "eval/store/merge_searches.h"
#include "eval/store/migrations.h"
#include "eval/store/registry.h"
#include "eval/store/run_lock.h"
#include "files/output_file.h"

namespace moma::store {
namespace {

using SQLite::Statement;
namespace fs = std::filesystem;

constexpr const char* kContent[] = {"robot", "controller", "resolved_suite", "world"};

/// Adds what is attached as `source`. Maps from its ids to ours are temporary tables. ON CONFLICT leaves out what is
/// there already; OR IGNORE would leave out what breaks a rule of its table, too. SQLite wants a WHERE before it.
class Importer {
 public:
  Importer(SQLite::Database& db, fs::path file) : db_(db), file_(std::move(file)) {}

  MergeSummary import() {
    check_columns();
    for (const char* table : kContent) import_content(table);
    import_suites();
    import_points();
    import_invocations();
    check_contradictions();
    MergeSummary summary = import_trials();
    summary.searches = merge_searches(db_, file_, summary.notes);
    merge_others(db_, file_, summary.notes);
    for (const char* map : {"robot", "controller", "resolved_suite", "world", "suite", "point", "invocation"})
      db_.exec(fmt::format("DROP TABLE map_{}", map));
    return summary;
  }

 private:
  /// A column that moma's tables have there and not here would be lost.
  void check_columns() {
    const std::set<std::string> own = own_names();
    std::vector<std::string> tables;
    Statement all(db_, "SELECT name FROM source.sqlite_schema WHERE type = 'table'");
    while (all.executeStep())
      if (own.count(all.getColumn(0).getString()) > 0) tables.push_back(all.getColumn(0).getString());
    all.reset();
    for (const std::string& table : tables) {
      const std::set<std::string> ours = stored_columns(db_, table);
      for (const std::string& name : stored_columns(db_, table, "source")) {
        if (ours.count(name) > 0) continue;
        throw StoreError(StoreError::Kind::kUnusable,
                         fmt::format("{}: table {} has a column {} that would be lost: it was written by a newer moma, "
                                     "or somebody added it; use that moma, or add it to the output",
                                     file_.string(), table, name));
      }
    }
  }

  void import_content(const std::string& table) {
    const std::string columns = columns_of(db_, table);
    db_.exec(
        fmt::format("INSERT INTO {0} ({1}) SELECT {1} FROM source.{0} WHERE true ORDER BY id "
                    "ON CONFLICT DO NOTHING",
                    table, columns));
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
    const std::string columns = columns_of(db_, "point");
    const std::string values = columns_of(db_, "point", "s.",
                                          {{"suite_id", "ms.target"},
                                           {"controller", "?1"},
                                           {"robot_id", "mr.target"},
                                           {"controller_id", "mc.target"},
                                           {"resolved_suite_id", "mx.target"}});
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
    const std::string columns = columns_of(db_, "invocation");
    const std::string values =
        columns_of(db_, "invocation", "s.", {{"suite_id", "ms.target"}, {"resolved_suite_id", "mx.target"}});
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
    const std::string trial = columns_of(db_, "trial");
    const std::string values = columns_of(db_, "trial", "t.", {{"world_id", "mw.target"}});
    summary.added = static_cast<std::size_t>(
        db_.exec(fmt::format("INSERT INTO main.trial ({}) SELECT {} FROM source.trial AS t "
                             "JOIN map_world AS mw ON mw.source = t.world_id WHERE true ORDER BY t.key "
                             "ON CONFLICT DO NOTHING",
                             trial, values)));
    summary.present = total - summary.added;
    const std::string execution = columns_of(db_, "execution", "e.", {{"invocation_id", "mi.target"}});
    db_.exec(
        fmt::format("INSERT INTO main.execution ({}) SELECT {} FROM source.execution AS e "
                    "JOIN map_invocation AS mi ON mi.source = e.invocation_id WHERE true ORDER BY e.key "
                    "ON CONFLICT DO NOTHING",
                    columns_of(db_, "execution"), execution));
    db_.exec(
        fmt::format("INSERT INTO main.samples ({0}) SELECT {0} FROM source.samples WHERE true ORDER BY key "
                    "ON CONFLICT DO NOTHING",
                    columns_of(db_, "samples")));
    db_.exec(
        fmt::format("INSERT INTO main.point_trial (point_id, world_index, key, world_id, family, outcome, "
                    "time_to_goal_s, {}) "
                    "SELECT mp.target, m.world_index, m.key, t.world_id, w.family, t.outcome, t.time_to_goal_s, {} "
                    "FROM source.point_trial AS m "
                    "JOIN map_point AS mp ON mp.source = m.point_id JOIN main.trial AS t ON t.key = m.key "
                    "JOIN main.world AS w ON w.id = t.world_id WHERE true ORDER BY 1, 2 "
                    "ON CONFLICT DO NOTHING",
                    summary_list(), summary_list("t.")));
    import_metrics();
    return summary;
  }

  /// Values of metrics; names as in the suite files, another expression under one name becomes NAME@2.
  void import_metrics() {
    Statement missing(db_,
                      "SELECT s.file_name, s.expression FROM source.metric AS s LEFT JOIN main.metric AS o "
                      "USING (file_name, expression) WHERE o.id IS NULL ORDER BY s.id");
    while (missing.executeStep()) metric_id(db_, missing.getColumn(0).getString(), missing.getColumn(1).getString());
    db_.exec(
        "INSERT INTO main.metric_value (metric_id, key, value) SELECT o.id, v.key, v.value "
        "FROM source.metric_value AS v JOIN source.metric AS s ON s.id = v.metric_id "
        "JOIN main.metric AS o ON o.file_name = s.file_name AND o.expression = s.expression WHERE true ORDER BY 1, 2 "
        "ON CONFLICT DO NOTHING");
  }

  SQLite::Database& db_;
  fs::path file_;
};

/// ATTACH cannot be in a transaction, so that each input has its own; the caller works on a new file.
void merge_into(SQLite::Database& db, const fs::path& file, MergeSummary& summary) {
  Statement attach(db, "ATTACH ? AS source");
  attach.bind(1, file.string());
  attach.exec();
  check_hashes(db, "source", [&](const std::string& finding) {
    throw StoreError(StoreError::Kind::kContradiction,
                     fmt::format("{}: {}; nothing was merged ('moma verify' says all)", file.string(), finding));
  });
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  MergeSummary one = Importer(db, file).import();
  transaction.commit();
  db.exec("DETACH source");
  summary.added += one.added;
  summary.present += one.present;
  summary.searches += one.searches;
  std::move(one.notes.begin(), one.notes.end(), std::back_inserter(summary.notes));
}

void remove_store(const fs::path& file) {
  std::error_code ignored;
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(file.string() + suffix, ignored);
}

struct Removed {
  fs::path file;
  ~Removed() { remove_store(file); }
};

/// Of an older version, or with trials that are to be tried again.
bool needs_change(const fs::path& file) {
  try {
    SQLite::Database db(file.string(), SQLite::OPEN_READONLY);
    return db.execAndGet("PRAGMA application_id").getInt() == kApplicationId && schema_version(db) > 0 &&
           (schema_version(db) < kSchemaVersion || (schema_version(db) == kSchemaVersion && count_late(db) > 0));
  } catch (const SQLite::Exception&) {
    return false;  // opening it as a store says why
  }
}

/// An input is only read: where it needs a change it is copied, and the copy brought up to date.
void merge_input(SQLite::Database& db, const fs::path& file, const fs::path& copy, MergeSummary& summary) {
  if (!needs_change(file)) {
    { const ReadConnection look(file); }  // ours, and of this version
    return merge_into(db, file, summary);
  }
  const Removed removed{copy};
  remove_store(copy);
  {
    SQLite::Database old(file.string(), SQLite::OPEN_READONLY);
    old.backup(copy.string().c_str(), SQLite::Database::Save);  // VACUUM INTO fails at generated columns
  }
  {
    SQLite::Database migrated = open_database(copy, Access::kReadWrite);
    forget_late(migrated);
  }
  merge_into(db, copy, summary);
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

/// Everything that was committed goes into the file itself: what SQLite cannot write when it closes, it does not tell.
void settle(SQLite::Database& db, const fs::path& part) {
  Statement checkpoint(db, "PRAGMA wal_checkpoint(TRUNCATE)");
  const bool whole = checkpoint.executeStep() && checkpoint.getColumn(0).getInt() == 0;
  if (!whole) throw StoreError(StoreError::Kind::kUnusable, fmt::format("{}: cannot be written", part.string()));
}

/// Locks of all files, always taken in one order, so that two merges cannot wait for each other.
class Locks {
 public:
  Locks(const fs::path& out, const std::vector<fs::path>& in, const MergeOptions& options) {
    std::map<fs::path, RunLock::Use> uses;
    for (const fs::path& file : in) uses.emplace(place_of(file), RunLock::Use::kMergeFrom);
    uses[place_of(out)] = RunLock::Use::kWrite;
    for (const auto& [file, use] : uses) {
      std::error_code error;
      if (use == RunLock::Use::kMergeFrom && !fs::is_regular_file(file, error)) continue;  // opening it says why
      auto lock = std::make_unique<RunLock>(
          file, options.stop,
          [&](const std::string& words) {
            if (options.waiting) options.waiting(words);
          },
          use);
      if (!lock->held()) throw StoreError(StoreError::Kind::kInterrupted, "stopped while waiting; nothing was merged");
      if (use == RunLock::Use::kWrite) exclusive_ = lock->exclusive();
      locks_.push_back(std::move(lock));
    }
  }
  /// Whether nobody else can be writing the output's part file.
  bool exclusive() const { return exclusive_; }

 private:
  static fs::path place_of(const fs::path& file) {
    std::error_code error;
    const fs::path place = fs::weakly_canonical(files::behind_links(file), error);
    return error ? file : place;
  }

  std::vector<std::unique_ptr<RunLock>> locks_;
  bool exclusive_ = false;
};

void copy_store(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) {
    throw StoreError(StoreError::Kind::kUnusable,
                     fmt::format("{}: cannot be written: {}", to.string(), error.message()));
  }
}

}  // namespace

MergeSummary merge(const fs::path& out, const std::vector<fs::path>& in, const MergeOptions& options) {
  std::error_code error;
  const fs::path place = files::behind_links(out);
  for (const fs::path& file : in) {
    if (fs::equivalent(file, place, error)) {
      throw StoreError(StoreError::Kind::kUnusable, fmt::format("{}: is input and output at once", out.string()));
    }
  }
  const Locks locks(place, in, options);
  const bool there = fs::exists(place, error);
  if (there) check_unused(place);
  // Without locks two merges may be at work at once.
  const fs::path part = place.string() + (locks.exclusive() ? ".part" : fmt::format(".{}.part", getpid()));
  const Removed removed{part};
  remove_store(part);
  const fs::path* current = &out;
  try {
    MergeSummary summary;
    // What is in OUT already stays as it is, whoever made it.
    if (there) copy_store(place, part);
    {
      SQLite::Database db = open_database(part, Access::kCreate);
      forget_late(db);
      for (const fs::path& file : in) {
        current = &file;
        merge_input(db, file, part.string() + "-in", summary);
      }
      current = &out;
      settle(db, part);
    }
    files::put_in_place(part, place);
    return summary;
  } catch (const SQLite::Exception& failure) {
    throw explain(failure, *current, StoreError::Kind::kUnusable);
  } catch (const files::OutputError& failure) {
    throw StoreError(StoreError::Kind::kUnusable, failure.what());
  }
}

}  // namespace moma::store
