#include "eval/store/contents.h"

#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <optional>
#include <set>
#include <utility>

#include "controller/config/json_node.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/hash.h"
#include "eval/store/machine.h"
#include "eval/store/migrations.h"
#include "eval/store/records.h"
#include "eval/store/samples.h"
#include "eval/store/table.h"
#include "world/world_json.h"

namespace moma::store {
namespace {

using SQLite::Statement;
using Found = std::function<void(const std::string&)>;

struct Checker {
  SQLite::Database& db;
  const Found& tell;
  ContentCounts counts = {};

  ContentCounts execute() {
    check_definitions();
    counts.hashes = check_hashes(db, "main", tell);
    check_worlds();
    check_names();
    check_suites();
    check_keys();
    check_copies();
    check_missing();
    check_samples();
    hash_tables();
    return counts;
  }

  /// `sql` gives a sentence for each disagreement.
  void tell_all(const std::string& sql) const { for_rows<std::string>(db, sql, tell); }

  /// Returns true if another build wrote to the store.
  bool other_builds() const {
    return count(db,
                 "SELECT count(*) FROM main.invocation WHERE moma_version IS NOT ? OR coalesce(git_commit, '') <> ? OR "
                 "coalesce(git_dirty, 0) <> ?",
                 kVersion, kGitCommit, kGitDirty) > 0;
  }

  /// All tables and pages are read from views, and triggers could change written rows. Another build may have other
  /// views; only that build could tell whether they are its own.
  void check_definitions() {
    for (const auto& [name, statement] : views()) {
      const auto ours =
          row<std::string>(db, "SELECT sql FROM main.sqlite_schema WHERE type = 'view' AND name = ?", name);
      if (ours == statement) continue;
      if (ours && other_builds()) {
        counts.foreign_views.push_back(name);
      } else {
        tell(fmt::format("view {} is {}; no other build of moma wrote to this store", name,
                         ours ? "not the one that this moma makes" : "missing"));
      }
    }
    tell_all(
        "SELECT printf('trigger %s on %s: moma makes none, and none runs while moma writes', name, tbl_name) FROM "
        "sqlite_schema WHERE type = 'trigger'");
  }

  /// Checks shown names: the file's, or NAME@2, NAME@3 ... if that was taken (free_name()). A suite, controller or
  /// metric with another's name would be mistaken for it.
  void check_names() {
    for_rows<std::string, std::string, std::string>(
        db,
        "SELECT 'suite ' || id, name, file_name FROM main.suite UNION ALL SELECT 'point ' || id, controller, "
        "controller_name FROM main.point UNION ALL SELECT 'metric ' || id, name, file_name FROM main.metric",
        [&](const std::string& what, const std::string& shown, const std::string& name) {
          const bool numbered = shown.size() > name.size() + 1 && shown.starts_with(name + "@") &&
                                shown.find_first_not_of("0123456789", name.size() + 1) == std::string::npos;
          if (shown != name && !numbered)
            tell(fmt::format("{} is shown as {:.80}, but its name is {:.80}", what, shown, name));
        });
  }

  /// Tells what stands in the way of a check: nearly anything can be in a store that was changed.
  template <class Work>
  void attempt(const std::string& name, const Work& work) const {
    try {
      work();
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const SQLite::Exception&) {
      throw;
    } catch (const std::exception& error) {
      tell(fmt::format("{}: cannot be read: {}", name, error.what()));
    }
  }

  /// A suite must be the one that its points and invocations were resolved from.
  void check_suites() {
    for (const char* table : {"point", "invocation"}) {
      Statement s(db, fmt::format("SELECT min(x.id), u.id, u.file_name, u.setting_hash, r.resolved FROM main.{} AS x "
                                  "JOIN main.suite AS u ON u.id = x.suite_id JOIN main.resolved_suite AS r "
                                  "ON r.id = x.resolved_suite_id GROUP BY u.id, r.id",
                                  table));
      while (s.executeStep()) {
        const std::string name = fmt::format("{} {}", table, s.getColumn(0).getInt64());
        attempt(name + ", resolved_suite", [&] {
          const auto [point, suite, file_name, setting, text] =
              field::read_row<std::tuple<int, int, std::string, Hash, std::string>, int, int, std::string, Hash,
                              std::string>(s);
          const auto resolved = config::parse_json(text, name);
          const std::string said = resolved.value("name", "");
          if (file_name != said) {
            tell(fmt::format("{}: suite {}: its name is {:.80}, but that of its resolved suite {:.80}", name, suite,
                             file_name, said));
          } else if (!has_setting(resolved, setting)) {
            tell(fmt::format("{}: suite {}: setting_hash not as its resolved suite says", name, suite));
          }
        });
      }
    }
  }

  void check_worlds() {
    Statement s(db, "SELECT id, " + column_names<WorldRecord>() + " FROM main.world");
    while (s.executeStep()) {
      ++counts.worlds;
      const std::string name = fmt::format("world {}", s.getColumn(0).getInt64());
      attempt(name, [&] {
        int column = 1;
        const auto kept = field::read_next<WorldRecord>(s, column);
        const auto json = config::parse_json(kept.json, name);
        if (json.contains("missing")) {
          if (json.value("index", std::uint64_t{0}) != kept.index || json.value("family", "") != kept.family)
            tell(name + ": its columns are not those of its text");
          return;
        }
        WorldRecord said = store::describe(world_from_json(json, name));
        said.hash = kept.hash, said.json = kept.json;  // compared with each other elsewhere
        const std::string differ = differing_columns(kept, said);
        if (!differ.empty()) tell(fmt::format("{}: {} not as the world itself says", name, differ));
      });
    }
  }

  /// Rows without their trial are SQLite's check of foreign keys; here: keys that are none.
  void check_keys() const {
    for (const char* table : {"trial", "point_trial", "execution", "samples", "metric_value"})
      tell_all(
          fmt::format("SELECT printf('{0}: %d keys are not of 16 bytes', n) FROM (SELECT count(*) AS n FROM main.{0} "
                      "WHERE typeof(key) <> 'blob' OR length(key) <> 16) WHERE n > 0",
                      table));
  }

  void check_copies() {
    std::string differ;
    const std::set<std::string> there = stored_columns(db, "point_trial");
    for (const std::string& name : stored_columns(db, "trial"))
      if (name != "key" && there.count(name) > 0)
        differ += fmt::format("iif(m.{0} IS NOT t.{0}, ' {0}', '') || ", name);
    tell_all(fmt::format(
        "SELECT printf('trial %s: its copy in point_trial (point %d, world %d) differs in:%s', "
        "lower(substr(hex(m.key), 1, 16)), m.point_id, m.world_index, {0}) FROM main.point_trial AS m JOIN main.trial "
        "AS t ON t.key = m.key JOIN main.world AS w ON w.id = t.world_id WHERE {0} <> ''",
        differ + "iif(m.family IS NOT w.family, ' family', '')"));
    counts.copies = count(db, "SELECT count(*) FROM main.point_trial");
  }

  /// Finds removed rows: trials that a run stored and no point has (a search plans none, and links
  /// none), trials that a finished run had, and values of the metrics that a suite has.
  void check_missing() const {
    tell_all(
        "SELECT printf('%d trials belong to no point, although execution and invocation say that a run stored them: "
        "tables leave them out', n) FROM (SELECT count(*) AS n FROM main.trial AS t LEFT JOIN main.execution AS e "
        "USING "
        "(key) LEFT JOIN main.invocation AS i ON i.id = e.invocation_id WHERE coalesce(i.trials_planned, 1) > 0 AND "
        "NOT "
        "EXISTS (SELECT 1 FROM main.point_trial AS m WHERE m.key = t.key)) WHERE n > 0");
    tell_all(
        "SELECT printf('suite %s: a run finished with %d trials (invocation), and %d are there (point_trial)', name, "
        "planned, there) FROM (SELECT u.name, max(i.trials_planned) AS planned, (SELECT count(*) FROM main.point_trial "
        "AS m JOIN main.point AS p ON p.id = m.point_id WHERE p.suite_id = u.id) AS there FROM main.suite AS u JOIN "
        "main.invocation AS i ON i.suite_id = u.id WHERE i.status = 'finished' GROUP BY u.id) WHERE there < planned");
    for (const char* table : {"invocation", "tune_search"})  // a killed one has no end
      tell_all(
          fmt::format("SELECT printf('{0} %d: its status and its end contradict each other', id) FROM main.{0} "
                      "WHERE iif(ended IS NULL, status = 'finished', status = 'running')",
                      table));
    tell_all(
        "SELECT printf('point %d: %d trials have no value of metric %s as its suite has it: %!.200s', p.id, count(*), "
        "j.key, j.value) FROM main.point AS p JOIN main.resolved_suite AS r ON r.id = p.resolved_suite_id AND "
        "json_valid(r.resolved), json_each(r.resolved, '$.metrics') AS j JOIN main.point_trial AS m ON m.point_id = "
        "p.id WHERE NOT EXISTS (SELECT 1 FROM main.metric_value AS v JOIN main.metric AS d ON d.id = v.metric_id WHERE "
        "v.key = m.key AND d.file_name = j.key AND d.expression = j.value) GROUP BY p.id, j.key");
  }

  void hash_tables() {
    counts.table_hash = to_hex(chain_rows(
        db, {},
        fmt::format("SELECT u.file_name, lower(hex(u.setting_hash)), r.name, p.controller_name, p.label, "
                    "p.params, lower(hex(p.content_hash)), p.simulation_version, m.world_index, "
                    "lower(hex(m.key)), m.family, m.outcome, m.time_to_goal_s, {} FROM main.point_trial AS m "
                    "JOIN main.point AS p ON p.id = m.point_id JOIN main.suite AS u ON u.id = p.suite_id "
                    "JOIN main.robot AS r ON r.id = p.robot_id ORDER BY 1, 2, 4, 5, 7, 9",
                    summary_list("m."))));
  }

  void check_samples() {
    for_rows<std::string, EncodedSamples, std::optional<std::int64_t>>(
        db,
        fmt::format("SELECT lower(substr(hex(a.key), 1, 16)), {}, t.steps FROM main.samples AS a "
                    "LEFT JOIN main.trial AS t ON t.key = a.key ORDER BY a.key",
                    column_names<EncodedSamples>("a.")),
        [&](const std::string& key, const EncodedSamples& encoded, std::optional<std::int64_t> steps) {
          const std::string name = "samples of trial " + key;
          try {
            const std::size_t n = decode_samples(encoded).size();
            ++counts.samples;
            if (steps && *steps != static_cast<std::int64_t>(n))
              tell(fmt::format("{}: {} of them, but the trial has {} steps", name, n, *steps));
          } catch (const std::runtime_error& error) {
            tell(fmt::format("{}: {}", name, error.what()));
          }
        });
  }
};

}  // namespace

std::size_t check_hashes(SQLite::Database& db, const std::string& schema, const Found& finding) {
  std::size_t n = 0;
  for (const auto& [table, text] :
       {std::pair{"robot", "resolved"}, std::pair{"controller", "resolved"}, std::pair{"resolved_suite", "resolved"},
        std::pair{"world", "json"}, std::pair{"tune_search", "identity"}}) {
    for_rows<std::int64_t, Blob, std::string>(
        db, fmt::format("SELECT id, hash, {} FROM {}.{}", text, schema, table),
        [&](std::int64_t id, const Blob& kept, const std::string& content) {
          ++n;
          const Hash hash = hash_text(content);
          if (!std::equal(hash.begin(), hash.end(), kept.begin(), kept.end()))
            finding(fmt::format("{} {}: its text has another hash than the one that it is kept under; it was changed",
                                table, id));
        });
  }
  return n;
}

ContentCounts check_contents(const fs::path& file, const Found& finding) {
  ReadConnection connection(file);
  try {
    if (lacks_columns(connection.db())) throw of_older(file);
    return Checker{connection.db(), finding}.execute();
  } catch (const SQLite::Exception& error) {
    throw explain(error, file, StoreError::Kind::kUnusable);
  }
}

}  // namespace moma::store
