#include "eval/store/planner_arena.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <new>
#include <set>
#include <string_view>
#include <system_error>

#include "eval/store/build_info.h"
#include "eval/store/columns.h"
#include "eval/store/database.h"
#include "eval/store/migrations.h"
#include "eval/store/samples.h"
#include "eval/store/table.h"
#include "files/output_file.h"

namespace moma::store {
namespace {

namespace fs = std::filesystem;
using SQLite::Statement;

// Tables and key columns as OMPL documents them; the last statement's list goes on with the properties.
constexpr const char* kTables = R"(
PRAGMA foreign_keys = ON;
CREATE TABLE experiments (id INTEGER PRIMARY KEY AUTOINCREMENT, name VARCHAR(512), totaltime REAL, timelimit REAL,
  memorylimit REAL, runcount INTEGER, version VARCHAR(128), hostname VARCHAR(1024), cpuinfo TEXT, date DATETIME,
  seed INTEGER, setup TEXT);
CREATE TABLE plannerConfigs (id INTEGER PRIMARY KEY AUTOINCREMENT, name VARCHAR(512) NOT NULL, settings TEXT);
CREATE TABLE enums (name VARCHAR(512), value INTEGER, description TEXT, PRIMARY KEY (name, value));
CREATE TABLE progress (runid INTEGER, time REAL, position_error_m REAL, orientation_error_rad REAL,
  manipulability REAL, least_distance_m REAL, PRIMARY KEY (runid, time),
  FOREIGN KEY (runid) REFERENCES runs(id) ON DELETE CASCADE);
)";

struct Property {
  const char* name;
  const char* type;
  const char* sql;  // over t (trial), e (execution), w (world)
};

// OMPL's own names first.
constexpr Property kProperties[] = {
    {"time", "REAL", "e.t_trial_us * 1e-6"},
    {"solved", "BOOLEAN", "t.outcome = 'success'"},
    {"status", "ENUM", "o.value"},
    {"correct_solution", "BOOLEAN", "iif(t.outcome = 'success', t.collision_count = 0, NULL)"},
    {"approximate_solution", "BOOLEAN", "nullif(t.outcome, 'error') <> 'success'"},
    {"solution_difference", "REAL", "t.position_error_m"},
    {"solution_length", "REAL", "t.path_ee_m"},
    {"solution_smoothness", "REAL", "t.jerk_ee_rms"},
    {"solution_clearance", "REAL", "t.clearance_min_m"},
    {"world", "INTEGER", "w.world_index"},
    {"objects", "INTEGER", "w.objects"},
};

class Exporter {
 public:
  Exporter(SQLite::Database& db, int progress_per_run) : db_(db), progress_per_run_(progress_per_run) {}

  PlannerArenaSummary fill() {
    SQLite::Transaction transaction(db_);
    db_.exec(kTables);
    make_runs_table();
    constexpr auto outcomes = words(Of<Outcome>{});
    for (std::size_t i = 0; i < outcomes.size(); ++i)
      execute(db_, "INSERT INTO enums VALUES ('status', ?, ?)", i, outcomes[i]);
    fill_planners();
    fill_experiments();
    fill_runs();
    if (progress_per_run_ > 0) fill_progress();
    const auto n = [&](const char* table) { return count(db_, fmt::format("SELECT count(*) FROM main.{}", table)); };
    PlannerArenaSummary summary{n("experiments"), n("plannerConfigs"), n("runs"), n("progress")};
    db_.exec("DROP TABLE temp.run_of; DROP TABLE temp.experiment_of; DROP TABLE temp.planner_of");
    transaction.commit();
    return summary;
  }

 private:
  void make_runs_table() {
    std::string sql =
        "CREATE TABLE runs (id INTEGER PRIMARY KEY AUTOINCREMENT, experimentid INTEGER, plannerid INTEGER";
    const auto add = [&](std::string_view name, std::string_view type, const std::string& value) {
      sql += fmt::format(", {} {}", name, type);
      names_ += fmt::format(", {}", name);
      values_ += ", " + value;
    };
    for (const Property& p : kProperties) add(p.name, p.type, p.sql);
    const std::set<std::string> stored = stored_columns(db_, "trial", "source");
    for (const TrialColumn& column : trial_columns()) {
      if (std::holds_alternative<std::string TrialRow::*>(column.member)) continue;
      const bool real = std::holds_alternative<double TrialRow::*>(column.member);
      const bool there = stored.count(std::string(column.name)) > 0;  // else from before it was measured
      add(column.name, real ? "REAL" : "INTEGER", there ? fmt::format("t.{}", column.name) : "NULL");
    }
    add_own_metrics(add);
    db_.exec(sql +
             ", FOREIGN KEY (experimentid) REFERENCES experiments(id) ON DELETE CASCADE, "
             "FOREIGN KEY (plannerid) REFERENCES plannerConfigs(id) ON DELETE CASCADE)");
  }

  /// Metrics of the suites' own, under names that other programs can write: metric_NAME, NAME@2 as metric_NAME_2.
  template <class Add>
  void add_own_metrics(const Add& add) {
    std::set<std::string> taken;
    for (auto& [id, shown] : rows<std::int64_t, std::string>(db_, "SELECT id, name FROM source.metric ORDER BY id")) {
      std::string name = "metric_" + shown;
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
      while (!taken.insert(name).second) name += '_';
      add(name, "REAL",
          fmt::format("(SELECT x.value FROM source.metric_value AS x WHERE x.metric_id = {} AND x.key = t.key)", id));
    }
  }

  // The same name with the same parameters is one configuration, also in several suites.
  void fill_planners() {
    db_.exec(R"(
CREATE TEMP TABLE planner_of AS
SELECT p.id AS point, p.controller || iif(p.label = '', '', ' ' || p.label) AS name,
       json_object('params', json(p.params), 'controller', json(c.resolved)) AS settings
FROM source.point AS p JOIN source.controller AS c ON c.id = p.controller_id;
INSERT INTO plannerConfigs (name, settings) SELECT name, settings FROM planner_of GROUP BY name, settings
ORDER BY min(point);
)");
  }

  void fill_experiments() {
    db_.exec(R"(
CREATE TEMP TABLE experiment_of (id INTEGER PRIMARY KEY, suite_id, robot_id, mode, family, point);
INSERT INTO experiment_of (suite_id, robot_id, mode, family, point)
SELECT p.suite_id, p.robot_id, p.mode, w.family, min(p.id)
FROM source.point_trial AS m JOIN source.point AS p ON p.id = m.point_id
JOIN source.trial AS t ON t.key = m.key JOIN source.world AS w ON w.id = t.world_id
GROUP BY p.suite_id, p.robot_id, p.mode, w.family ORDER BY min(p.id), w.family;
INSERT INTO experiments (id, name, timelimit, hostname, cpuinfo, date, seed, setup)
SELECT x.id, s.name || ': ' || x.family || ' (' || r.name || ', ' || x.mode || ')', p.time_limit_s, i.host,
       i.cpu || ', ' || i.cpu_count || ' cores; ' || i.os, replace(substr(i.started, 1, 19), 'T', ' '),
       json_extract(p.worlds, '$.seed'),
       json_object('worlds', json(p.worlds), 'mode', p.mode, 'control_period_s', p.control_period_s,
                   'physics_step_s', p.physics_step_s, 'success_position_m', p.success_position_m,
                   'success_orientation_rad', p.success_orientation_rad, 'success_dwell_s', p.success_dwell_s)
FROM experiment_of AS x JOIN source.point AS p ON p.id = x.point JOIN source.suite AS s ON s.id = x.suite_id
JOIN source.robot AS r ON r.id = x.robot_id
LEFT JOIN source.invocation AS i ON i.id = (SELECT min(id) FROM source.invocation WHERE suite_id = x.suite_id);
)");
    execute(db_, "UPDATE experiments SET version = ?", fmt::format("moma {}", kVersion));
  }

  void fill_runs() {
    db_.exec(R"(
CREATE TEMP TABLE run_of AS
SELECT row_number() OVER (ORDER BY x.id, m.point_id, m.world_index) AS id, m.key AS key, x.id AS experiment,
       c.id AS planner
FROM source.point_trial AS m JOIN source.point AS p ON p.id = m.point_id
JOIN source.trial AS t ON t.key = m.key JOIN source.world AS w ON w.id = t.world_id
JOIN experiment_of AS x ON x.suite_id = p.suite_id AND x.robot_id = p.robot_id AND x.mode = p.mode
                       AND x.family = w.family
JOIN planner_of AS q ON q.point = m.point_id JOIN plannerConfigs AS c ON c.name = q.name AND c.settings = q.settings;
)");
    db_.exec(
        fmt::format("INSERT INTO runs (id, experimentid, plannerid{}) SELECT r.id, r.experiment, r.planner{} "
                    "FROM run_of AS r JOIN source.trial AS t ON t.key = r.key "
                    "JOIN source.world AS w ON w.id = t.world_id "
                    "JOIN enums AS o ON o.name = 'status' AND o.description = t.outcome "
                    "LEFT JOIN source.execution AS e ON e.key = t.key ORDER BY r.id",
                    names_, values_));
    db_.exec(R"(
UPDATE experiments SET totaltime = (SELECT sum(time) FROM runs WHERE experimentid = experiments.id),
  runcount = (SELECT max(n) FROM (SELECT count(*) AS n FROM runs WHERE experimentid = experiments.id GROUP BY plannerid));
)");
  }

  static Trace decoded(const EncodedSamples& encoded) {
    try {
      return decode_samples(encoded);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {  // a store from anywhere
      throw StoreError(StoreError::Kind::kUnusable, error.what());
    }
  }

  void fill_progress() {
    Statement insert(db_, "INSERT INTO progress VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING");
    for_rows<std::int64_t, EncodedSamples>(
        db_,
        fmt::format("SELECT r.id, {} FROM run_of AS r JOIN source.samples AS x ON x.key = r.key ORDER BY r.id",
                    column_names<EncodedSamples>("x.")),
        [&](std::int64_t run, const EncodedSamples& encoded) {
          const Trace trace = decoded(encoded);
          const std::size_t rows = std::min(trace.size(), static_cast<std::size_t>(progress_per_run_));
          for (std::size_t k = 0; k < rows; ++k) {  // spread evenly, first and last included
            const std::size_t last = trace.size() - 1;
            const Sample& sample = trace[rows > 1 ? k * last / (rows - 1) : last];
            execute(insert, run, sample.t, stored(sample.error.tail<3>().norm()), stored(sample.error.head<3>().norm()),
                    stored(sample.manipulability), stored(sample.least_distance));
          }
        });
  }

  SQLite::Database& db_;
  int progress_per_run_;
  std::string names_;
  std::string values_;
};

}  // namespace

PlannerArenaSummary export_planner_arena(const fs::path& file, const fs::path& named, files::Replace replace,
                                         int progress_per_run) {
  const fs::path out = files::behind_links(named);
  { const ReadConnection look(file); }  // ours, and of this version
  std::error_code error;
  if (fs::equivalent(file, out, error))
    throw StoreError(StoreError::Kind::kUnusable, fmt::format("{}: is input and output at once", out.string()));
  files::check_replace(named, {"benchmark database", ""}, replace);
  if (fs::exists(out, error) && !fs::is_regular_file(out, error))
    throw StoreError(StoreError::Kind::kUnusable,
                     fmt::format("{}: is no regular file; a database cannot be written into it", named.string()));
  const fs::path part = out.string() + fmt::format(".{}.part", getpid());
  fs::remove(part, error);
  PlannerArenaSummary summary;
  const fs::path* current = &out;
  try {
    {
      SQLite::Database db(part.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
      current = &file;
      execute(db, "ATTACH ? AS source", file.string());
      current = &out;
      summary = Exporter(db, progress_per_run).fill();
      db.exec("DETACH source");
    }
    files::put_in_place(part, out);
    return summary;
  } catch (const SQLite::Exception& failure) {
    fs::remove(part, error);
    throw explain(failure, *current, StoreError::Kind::kUnusable);
  } catch (const files::OutputError& failure) {
    fs::remove(part, error);
    throw StoreError(StoreError::Kind::kUnusable, failure.what());
  } catch (...) {
    fs::remove(part, error);
    throw;
  }
}

}  // namespace moma::store
