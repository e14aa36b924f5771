#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/summary_table.h"
#include "eval/cli/table.h"
#include "eval/store/query.h"
#include "files/output_file.h"
#include "reports/render/own_metrics.h"

namespace moma::cli {
namespace {

namespace fs = std::filesystem;

struct Export {
  const char* name;
  const char* sql;
};

constexpr Export kFiles[] = {
    {"pairs", "SELECT * FROM v_pairs ORDER BY suite, controller_a, point_a, controller_b, point_b, world"},
    {"worlds",
     "SELECT DISTINCT s.name AS suite, w.world_index AS world, w.seed, w.family, w.goal_distance_m, w.objects, "
     "w.witness_clearance_m, w.blocked_fraction, w.narrowest_gap_m FROM point_trial AS m JOIN trial AS t USING (key) "
     "JOIN world AS w ON w.id = t.world_id JOIN point AS p ON p.id = m.point_id JOIN suite AS s ON s.id = p.suite_id "
     "ORDER BY 1, 2"},
    {"points",
     "SELECT s.name AS suite, r.name AS robot, p.controller, p.label AS point, p.params, p.mode, p.control_period_s, "
     "p.physics_step_s, p.time_limit_s, c.resolved AS controller_parameters FROM point AS p "
     "JOIN suite AS s ON s.id = p.suite_id JOIN robot AS r ON r.id = p.robot_id "
     "JOIN controller AS c ON c.id = p.controller_id ORDER BY p.id"},
    {"invocations",
     "SELECT i.id, s.name AS suite, i.started, i.ended, i.status, i.arguments, i.moma_version, i.git_commit, "
     "i.git_dirty, i.build_type, i.compiler, i.compiler_flags, i.libraries, i.host, i.os, i.cpu, i.cpu_count, "
     "i.threads, i.machine_class, i.trials_planned, i.trials_present, i.trials_done FROM invocation AS i "
     "JOIN suite AS s ON s.id = i.suite_id ORDER BY i.id"},
};

/// v_trials with the suites' own metrics as further columns.
store::QueryResult trials(const fs::path& db) {
  const std::vector<std::string> columns = store::query(db, "SELECT * FROM v_trials LIMIT 0").columns;
  std::string own;
  for (const reports::OwnMetric& metric : reports::own_metrics(db, {columns.begin(), columns.end()}))
    own += fmt::format(", {} AS {}", reports::value_sql(metric, "(SELECT key FROM trial WHERE trial.trial = v.trial)"),
                       reports::sql_name(metric.column));
  return store::query(db, fmt::format("SELECT v.*{} FROM v_trials AS v ORDER BY suite, controller, point, world", own));
}

/// Recognised by the beginning of its head, which the suites' own metrics follow.
files::Kind kind_of(const std::string& name, const store::QueryResult& table) {
  std::string head;
  for (std::size_t i = 0; i < std::min<std::size_t>(table.columns.size(), 5); ++i) head += table.columns[i] + ",";
  return {fmt::format("table of {} by moma export", name), head};
}

struct ExportOptions {
  fs::path file;
  fs::path csv;
  std::string parquet;
  files::Replace replace = files::Replace::kOwn;
};

int export_csv(const ExportOptions& options) {
  if (!options.parquet.empty())
    throw UsageError(
        fmt::format("export: Parquet files are written by the Python package (pip install \"moma[parquet]\"): "
                    "python3 -m moma export {} --parquet {}",
                    options.file.string(), options.parquet));
  const fs::path& folder = options.csv;
  if (folder.empty()) throw UsageError("export: --csv FOLDER is required");
  // All are read before the first is written.
  std::vector<std::pair<std::string, store::QueryResult>> results;
  results.emplace_back("trials", trials(options.file));
  results.emplace_back("summary", summary_table(options.file));
  for (const Export& file : kFiles) results.emplace_back(file.name, store::query(options.file, file.sql));
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder)) {
    throw UsageError(fmt::format("{}: cannot be made a folder: {}", folder.string(),
                                 error ? error.message() : "something else has this name"));
  }
  for (const auto& [name, table] : results)
    files::check_replace(folder / (name + ".csv"), kind_of(name, table), options.replace);
  for (const auto& [name, table] : results) {
    const fs::path file = folder / (name + ".csv");
    files::write_file(file, kind_of(name, table), options.replace,
                      [&rows = table](std::ostream& out) { write(out, rows, Format::kCsv); });
    std::cerr << fmt::format("wrote {} ({} rows)\n", file.string(), table.rows.size());
  }
  return kOk;
}

}  // namespace

void add_export(Commands& commands) {
  auto [command, options] = commands.add<ExportOptions>("export", "Write a store as flat CSV files", &export_csv);
  add_store(command, options.file);
  command.add_option("--csv", options.csv, "Folder for the files, made if missing");
  command.add_option("--parquet", options.parquet,
                     "Folder for Parquet files; by the Python package: python3 -m moma export DB --parquet FOLDER");
  add_force(command, options.replace);
  command.footer("Example: moma export results/demo.db --csv results/demo-csv");
}

}  // namespace moma::cli
