#include "eval/store/merge.h"

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
#include <system_error>
#include <utility>

#include "controller/describe/enumeration.h"
#include "eval/store/columns.h"
#include "eval/store/contents.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/merge_parts.h"
#include "eval/store/migrations.h"
#include "eval/store/records.h"
#include "eval/store/run_lock.h"
#include "eval/store/table.h"
#include "files/output_file.h"

namespace moma::store {
namespace {

using SQLite::Statement;

/// A column that holds the id of a row of `table`.
struct Reference {
  std::string column, table;
};

/// A table whose rows have ids, which each store gives on its own.
struct IdTable {
  std::string name;
  std::vector<std::string> same;  ///< columns that identify a row across stores
  std::vector<Reference> references = {};
  std::string shown = {}, file_name = {};  ///< columns: the shown name, and its source; a taken name becomes NAME@2
  std::vector<std::string> within = {};    ///< columns within whose values shown names are distinct
};

/// The tables with ids; a table follows those that its rows refer to.
const std::vector<IdTable>& id_tables() {
  static const std::vector<IdTable> kTables{
      {"robot", {"hash"}},
      {"controller", {"hash"}},
      {"resolved_suite", {"hash"}},
      {"world", {"hash"}},
      {"suite", {"file_name", "setting_hash"}, {}, "name", "file_name"},
      {"point",
       {"suite_id", "controller_name", "label", "content_hash"},
       {{"suite_id", "suite"},
        {"robot_id", "robot"},
        {"controller_id", "controller"},
        {"resolved_suite_id", "resolved_suite"}},
       "controller",
       "controller_name",
       {"suite_id", "label"}},
      // Merging the same store twice adds its invocations once.
      {"invocation",
       {"suite_id", "resolved_suite_id", "started", "host", "arguments"},
       {{"suite_id", "suite"}, {"resolved_suite_id", "resolved_suite"}}},
      {"metric", {"file_name", "expression"}, {}, "name", "file_name"},
  };
  return kTables;
}

/// Adds the rows of the database that is attached as `source`. Temporary tables map its ids to ours. ON CONFLICT skips
/// existing rows; OR IGNORE would also skip rows that violate a constraint. SQLite requires a WHERE before ON CONFLICT.
struct Importer {
  SQLite::Database& db;
  const fs::path& file;

  MergeSummary import() {
    check_columns();
    for (const IdTable& table : id_tables()) import_ids(table);
    check_contradictions();
    MergeSummary summary = import_trials();
    summary.searches = merge_searches(db, file, summary.notes);
    merge_others(db, file, summary.notes);
    for (const IdTable& table : id_tables()) db.exec(fmt::format("DROP TABLE map_{}", table.name));
    return summary;
  }

  /// Rejects a source with a column of moma's tables that this store does not have: it would be lost.
  void check_columns() {
    const std::set<std::string> own = own_names();
    for (const std::string& table :
         rows<std::string>(db, "SELECT name FROM source.sqlite_schema WHERE type = 'table'")) {
      if (own.count(table) == 0) continue;
      const std::set<std::string> ours = stored_columns(db, table);
      for (const std::string& name : stored_columns(db, table, "source")) {
        if (ours.count(name) > 0) continue;
        throw unusable(file, fmt::format("table {} has a column {} that would be lost: it was written by a newer moma, "
                                         "or somebody added it; use that moma, or add it to the output",
                                         table, name));
      }
    }
  }

  /// Rows of a source's table `s`, joined with the ids that their references have here.
  struct Mapped {
    std::string from;                           ///< "FROM source.TABLE AS s JOIN map_..."
    std::map<std::string, std::string> values;  ///< of its references

    Mapped(const std::string& table, const std::vector<Reference>& references)
        : from(fmt::format("FROM source.{} AS s", table)) {
      for (const auto& [column, to] : references) {
        from += fmt::format(" JOIN map_{0} AS of_{1} ON of_{1}.source = s.{1}", to, column);
        values[column] = fmt::format("of_{}.target", column);
      }
    }
    /// "o.COLUMN = its value AND ..."
    std::string equal(const std::vector<std::string>& columns) const {
      const auto text = [&](const std::string& column) {
        const auto found = values.find(column);
        return fmt::format("o.{} = {}", column, found != values.end() ? found->second : "s." + column);
      };
      return joined(columns, text, " AND ");
    }
  };

  std::string insert_sql(const std::string& table, const Mapped& mapped) {
    return fmt::format("INSERT INTO main.{} ({}) SELECT {} {} ", table, columns_of(db, table),
                       columns_of(db, table, "s.", mapped.values), mapped.from);
  }

  /// Adds the rows that are not there, and makes the table map_NAME (source, target).
  void import_ids(const IdTable& table) {
    Mapped mapped(table.name, table.references);
    const std::string there = fmt::format("main.{} AS o ON {}", table.name, mapped.equal(table.same));
    const std::string missing = fmt::format("LEFT JOIN {} WHERE o.id IS NULL ORDER BY s.id", there);
    if (table.same.front() == "hash") {
      db.exec(insert_sql(table.name, mapped) + "WHERE true ORDER BY s.id ON CONFLICT DO NOTHING");
    } else if (table.shown.empty()) {
      db.exec(insert_sql(table.name, mapped) + missing);
    } else {
      mapped.values[table.shown] = "?1";
      Statement insert(db, insert_sql(table.name, mapped) + "WHERE s.id = ?2");
      std::vector<std::string> distinct = table.within;
      distinct.push_back(table.shown);
      Statement taken(db, fmt::format("SELECT 1 {} JOIN main.{} AS o ON {} WHERE s.id = ?2", mapped.from, table.name,
                                      mapped.equal(distinct)));
      for (const auto& [id, name] : rows<std::int64_t, std::string>(
               db, fmt::format("SELECT s.id, s.{} {} {}", table.file_name, mapped.from, missing))) {
        const std::string shown =
            free_name(name, [&](const std::string& candidate) { return row<int>(taken, candidate, id).has_value(); });
        execute(insert, shown, id);
      }
    }
    db.exec(fmt::format("CREATE TEMP TABLE map_{} (source INTEGER PRIMARY KEY, target INTEGER NOT NULL)", table.name));
    db.exec(fmt::format("INSERT INTO map_{} SELECT s.id, min(o.id) {} JOIN {} GROUP BY s.id", table.name, mapped.from,
                        there));
  }

  /// Adds the rows of a table with keys of its own that are not there; returns how many.
  std::size_t import_rows(const std::string& table, const std::vector<Reference>& references) {
    return static_cast<std::size_t>(
        db.exec(insert_sql(table, {table, references}) + "WHERE true ORDER BY s.key ON CONFLICT DO NOTHING"));
  }

  /// Two results for one key must agree in every deterministic column, within a class of machines.
  void check_contradictions() {
    const std::set<std::string> theirs = stored_columns(db, "trial", "source");
    std::string differ = "t.outcome IS NOT o.outcome";
    for (const TrialColumn& column : trial_columns()) {
      if (theirs.count(std::string(column.name)) == 0) continue;  // from before it was measured
      differ += fmt::format(" OR (t.{0} IS NOT o.{0}{1})", column.name,
                            column.about.earlier == Earlier::kUnknown
                                ? fmt::format(" AND t.{0} IS NOT NULL AND o.{0} IS NOT NULL", column.name)
                                : "");
    }
    const std::vector<std::string> found =
        rows<std::string>(db, fmt::format("SELECT t.trial FROM source.trial AS t JOIN main.trial AS o USING (key) "
                                          "LEFT JOIN source.execution AS te ON te.key = t.key "
                                          "LEFT JOIN source.invocation AS ti ON ti.id = te.invocation_id "
                                          "LEFT JOIN main.execution AS oe ON oe.key = o.key "
                                          "LEFT JOIN main.invocation AS oi ON oi.id = oe.invocation_id "
                                          "WHERE (ti.machine_class IS NULL OR oi.machine_class IS NULL "
                                          "       OR ti.machine_class = oi.machine_class) AND ({}) ORDER BY t.key",
                                          differ));
    if (found.empty()) return;
    constexpr std::size_t kShown = 5;
    throw StoreError(
        StoreError::Kind::kContradiction,
        fmt::format("{}: {} trials have other results than the same trials merged before, from machines of "
                    "the same class ({}{}); nothing was merged",
                    file.string(), found.size(),
                    fmt::join(found.begin(), found.begin() + std::min(kShown, found.size()), ", "),
                    found.size() > kShown ? ", ..." : ""));
  }

  MergeSummary import_trials() {
    MergeSummary summary;
    summary.added = import_rows("trial", {{"world_id", "world"}});
    summary.present = count(db, "SELECT count(*) FROM source.trial") - summary.added;
    import_rows("execution", {{"invocation_id", "invocation"}});
    import_rows("samples", {});
    import_rows("metric_value", {{"metric_id", "metric"}});
    db.exec(
        fmt::format("INSERT INTO main.point_trial (point_id, world_index, key, world_id, family, outcome, "
                    "time_to_goal_s, {}) "
                    "SELECT mp.target, m.world_index, m.key, t.world_id, w.family, t.outcome, t.time_to_goal_s, {} "
                    "FROM source.point_trial AS m "
                    "JOIN map_point AS mp ON mp.source = m.point_id JOIN main.trial AS t ON t.key = m.key "
                    "JOIN main.world AS w ON w.id = t.world_id WHERE true ORDER BY 1, 2 "
                    "ON CONFLICT DO NOTHING",
                    summary_list(), summary_list("t.")));
    return summary;
  }
};

/// ATTACH cannot be in a transaction, so that each input has its own; the caller works on a new file.
void merge_into(SQLite::Database& db, const fs::path& file, MergeSummary& summary) {
  execute(db, "ATTACH ? AS source", file.string());
  check_hashes(db, "source", [&](const std::string& finding) {
    throw StoreError(StoreError::Kind::kContradiction,
                     fmt::format("{}: {}; nothing was merged ('moma verify' says all)", file.string(), finding));
  });
  SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
  MergeSummary one = Importer{db, file}.import();
  transaction.commit();
  db.exec("DETACH source");
  summary.added += one.added;
  summary.present += one.present;
  summary.searches += one.searches;
  std::move(one.notes.begin(), one.notes.end(), std::back_inserter(summary.notes));
}

struct Removed {
  fs::path file;
  ~Removed() { remove_store(file); }
};

/// Returns true for an older version, or one with trials to try again.
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
    throw unusable(out, "another program has it open; try again when it is done");
  }
}

/// Everything that was committed goes into the file itself: what SQLite cannot write when it closes, it does not tell.
void settle(SQLite::Database& db, const fs::path& part) {
  Statement checkpoint(db, "PRAGMA wal_checkpoint(TRUNCATE)");
  const bool whole = checkpoint.executeStep() && checkpoint.getColumn(0).getInt() == 0;
  if (!whole) throw unusable(part, "cannot be written");
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
  /// Returns true if no other process can be writing the output's part file.
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
  if (error) throw unusable(to, "cannot be written: " + error.message());
}

}  // namespace

MergeSummary merge(const fs::path& out, const std::vector<fs::path>& in, const MergeOptions& options) {
  std::error_code error;
  const fs::path place = files::behind_links(out);
  for (const fs::path& file : in)
    if (fs::equivalent(file, place, error)) throw unusable(out, "is input and output at once");
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
    // Existing rows of OUT stay as they are.
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
