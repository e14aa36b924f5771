#include "eval/store/contents.h"

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <new>
#include <set>
#include <utility>

#include "controller/config/json_text.h"
#include "eval/store/build_info.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/difficulty.h"
#include "eval/store/hash.h"
#include "eval/store/migrations.h"
#include "eval/store/records.h"
#include "eval/store/samples.h"
#include "eval/store/table.h"
#include "world/world_json.h"

namespace moma::store {
namespace {

using SQLite::Statement;
using Found = std::function<void(const std::string&)>;

class Checker {
 public:
  Checker(SQLite::Database& db, Found finding) : db_(db), finding_(std::move(finding)) {}

  ContentCounts execute() {
    check_definitions();
    counts_.hashes = check_hashes(db_, "main", finding_);
    check_worlds();
    check_names();
    check_suites();
    check_keys();
    check_copies();
    check_missing();
    check_samples();
    hash_tables();
    return counts_;
  }

 private:
  void tell(const std::string& text) const { finding_(text); }

  /// Whether anything but this build says that it wrote to the store.
  bool other_builds() const {
    Statement s(
        db_,
        "SELECT count(*) FROM main.invocation WHERE moma_version IS NOT ?1 OR coalesce(git_commit, '') <> ?2 OR "
        "coalesce(git_dirty, 0) <> ?3");
    s.bind(1, std::string(kVersion));
    s.bind(2, std::string(kGitCommit));
    s.bind(3, kGitDirty ? 1 : 0);
    s.executeStep();
    return s.getColumn(0).getInt64() > 0;
  }

  /// Views are what every table and page is read from; triggers could change what is written. The views of another
  /// build are rightly other ones, and only that build could say whether they are its own.
  void check_definitions() {
    for (const auto& [name, statement] : views()) {
      Statement ours(db_, "SELECT sql FROM main.sqlite_schema WHERE type = 'view' AND name = ?");
      ours.bind(1, name);
      const bool there = ours.executeStep();
      if (there && ours.getColumn(0).getString() == statement) continue;
      if (there && other_builds()) {
        counts_.foreign_views.push_back(name);
      } else {
        tell(fmt::format("view {} is {}; no other build of moma wrote to this store", name,
                         there ? "not the one that this moma makes" : "missing"));
      }
    }
    Statement triggers(db_, "SELECT name, tbl_name FROM sqlite_schema WHERE type = 'trigger'");
    while (triggers.executeStep())
      tell(fmt::format("trigger {} on {}: moma makes none, and none runs while moma writes",
                       triggers.getColumn(0).getString(), triggers.getColumn(1).getString()));
  }

  /// What is shown is the name of the file, or NAME@2, NAME@3 ... where that was taken (free_name()): a suite,
  /// controller or metric that goes by another's name would be taken for it.
  void check_names() {
    Statement s(db_,
                "SELECT 'suite ' || id, name, file_name FROM main.suite UNION ALL SELECT 'point ' || id, controller, "
                "controller_name FROM main.point UNION ALL SELECT 'metric ' || id, name, file_name FROM main.metric");
    while (s.executeStep()) {
      const std::string shown = s.getColumn(1).getString();
      const std::string name = s.getColumn(2).getString();
      const bool numbered = shown.size() > name.size() + 1 && shown.starts_with(name + "@") &&
                            shown.find_first_not_of("0123456789", name.size() + 1) == std::string::npos;
      if (shown != name && !numbered)
        tell(fmt::format("{} is shown as {:.80}, but its name is {:.80}", s.getColumn(0).getString(), shown, name));
    }
  }

  /// A suite must be the one that its points and invocations were resolved from.
  void check_suites() {
    for (const char* table : {"point", "invocation"}) {
      Statement s(db_, fmt::format("SELECT min(x.id), u.id, u.file_name, u.setting_hash, r.resolved FROM main.{} AS x "
                                   "JOIN main.suite AS u ON u.id = x.suite_id JOIN main.resolved_suite AS r "
                                   "ON r.id = x.resolved_suite_id GROUP BY u.id, r.id",
                                   table));
      while (s.executeStep()) {
        const std::string name = fmt::format("{} {}", table, s.getColumn(0).getInt64());
        try {
          const auto resolved = config::parse_json(s.getColumn(4).getString(), name);
          Hash setting{};
          read_cell(s.getColumn(3), setting);
          const char* differs = resolved.value("name", "") != s.getColumn(2).getString() ? "file_name"
                                : !has_setting(resolved, setting)                        ? "setting_hash"
                                                                                         : nullptr;
          if (differs != nullptr)
            tell(fmt::format("{}: suite {}: {} not as its resolved suite says", name, s.getColumn(1).getInt64(),
                             differs));
        } catch (const std::bad_alloc&) {
          throw;
        } catch (const std::exception& error) {
          tell(fmt::format("{}: its resolved_suite cannot be read: {}", name, error.what()));
        }
      }
    }
  }

  void check_worlds() {
    Statement s(
        db_, fmt::format("SELECT id, world_index, seed, family, json, {} FROM main.world", column_names<Difficulty>()));
    while (s.executeStep()) {
      ++counts_.worlds;
      const std::string name = fmt::format("world {}", s.getColumn(0).getInt64());
      try {
        const auto json = config::parse_json(s.getColumn(4).getString(), name);
        if (json.contains("missing")) {
          if (json.value("index", std::int64_t{-1}) != s.getColumn(1).getInt64() ||
              json.value("family", "") != s.getColumn(3).getString())
            tell(name + ": its columns are not those of its text");
          continue;
        }
        const World world = world_from_json(json, name);
        const WorldRecord said = store::describe(world);
        std::string differ;
        const auto compare = [&](const char* column, bool same) {
          if (!same) differ += fmt::format("{}{}", differ.empty() ? "" : ", ", column);
        };
        compare("world_index", s.getColumn(1).getInt64() == static_cast<std::int64_t>(said.index));
        compare("seed", s.getColumn(2).getString() == std::to_string(said.seed));
        compare("family", s.getColumn(3).getString() == said.family);
        const std::string columns = differing_columns(s, 5, said.difficulty);
        if (!columns.empty()) compare(columns.c_str(), false);
        if (!differ.empty()) tell(fmt::format("{}: {} not as the world itself says", name, differ));
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& error) {
        tell(fmt::format("{}: cannot be read: {}", name, error.what()));
      }
    }
  }

  /// Rows without their trial are SQLite's check of foreign keys; here: keys that are none.
  void check_keys() {
    for (const char* table : {"trial", "point_trial", "execution", "samples", "metric_value"}) {
      Statement s(db_,
                  fmt::format("SELECT count(*) FROM main.{} WHERE typeof(key) <> 'blob' OR length(key) <> 16", table));
      s.executeStep();
      if (s.getColumn(0).getInt64() > 0)
        tell(fmt::format("{}: {} keys are not of 16 bytes", table, s.getColumn(0).getInt64()));
    }
  }

  void check_copies() {
    std::string differ;
    std::string names = "outcome, time_to_goal_s, " + summary_list();
    const std::set<std::string> there = stored_columns(db_, "point_trial");
    for (std::size_t begin = 0; begin < names.size();) {
      const std::size_t end = std::min(names.find(", ", begin), names.size());
      const std::string name = names.substr(begin, end - begin);
      begin = end + 2;
      if (there.count(name) == 0) continue;
      differ += fmt::format("{0}iif(m.{1} IS NOT t.{1}, '{1} ', '')", differ.empty() ? "" : " || ", name);
    }
    Statement all(db_,
                  fmt::format("SELECT lower(hex(m.key)), m.point_id, m.world_index, {} || iif(m.world_id IS NOT "
                              "t.world_id, 'world_id ', '') || iif(m.family IS NOT w.family, 'family ', '') AS differ "
                              "FROM main.point_trial AS m JOIN main.trial AS t ON t.key = m.key "
                              "JOIN main.world AS w ON w.id = t.world_id WHERE differ <> ''",
                              differ));
    while (all.executeStep()) {
      std::string columns = all.getColumn(3).getString();
      columns.pop_back();
      tell(fmt::format("trial {}: its copy in point_trial (point {}, world {}) differs in: {}",
                       all.getColumn(0).getString().substr(0, 16), all.getColumn(1).getInt64(),
                       all.getColumn(2).getInt64(), columns));
    }
    counts_.copies = static_cast<std::size_t>(db_.execAndGet("SELECT count(*) FROM main.point_trial").getInt64());
  }

  /// What somebody could have taken away: trials that a run stored and no point has (a search plans none, and links
  /// none), trials that a finished run had, and values of the metrics that a suite has.
  void check_missing() {
    Statement orphans(db_,
                      "SELECT count(*) FROM main.trial AS t LEFT JOIN main.execution AS e USING (key) LEFT JOIN "
                      "main.invocation AS i ON i.id = e.invocation_id WHERE coalesce(i.trials_planned, 1) > 0 AND NOT "
                      "EXISTS (SELECT 1 FROM main.point_trial AS m WHERE m.key = t.key)");
    orphans.executeStep();
    if (const std::int64_t n = orphans.getColumn(0).getInt64(); n > 0)
      tell(
          fmt::format("{} trials belong to no point, although execution and invocation say that a run stored them: "
                      "tables leave them out",
                      n));
    Statement planned(
        db_,
        "SELECT u.name, max(i.trials_planned) AS planned, (SELECT count(*) FROM main.point_trial AS m JOIN "
        "main.point AS p ON p.id = m.point_id WHERE p.suite_id = u.id) AS there FROM main.suite AS u JOIN "
        "main.invocation AS i ON i.suite_id = u.id WHERE i.status = 'finished' GROUP BY u.id HAVING there "
        "< planned");
    while (planned.executeStep())
      tell(fmt::format("suite {}: a run finished with {} trials (invocation), and {} are there (point_trial)",
                       planned.getColumn(0).getString(), planned.getColumn(1).getInt64(),
                       planned.getColumn(2).getInt64()));
    for (const char* table : {"invocation", "tune_search"}) {  // a killed one has no end
      Statement ends(db_, fmt::format("SELECT id FROM main.{} WHERE iif(ended IS NULL, status = 'finished', "
                                      "status = 'running')",
                                      table));
      while (ends.executeStep())
        tell(fmt::format("{} {}: its status and its end contradict each other", table, ends.getColumn(0).getInt64()));
    }
    Statement metrics(
        db_,
        "SELECT p.id, j.key, j.value, count(*) FROM main.point AS p JOIN main.resolved_suite AS r ON r.id = "
        "p.resolved_suite_id AND json_valid(r.resolved), json_each(r.resolved, '$.metrics') AS j JOIN "
        "main.point_trial AS m ON m.point_id = p.id WHERE NOT EXISTS (SELECT 1 FROM main.metric_value AS v "
        "JOIN main.metric AS d ON d.id = v.metric_id WHERE v.key = m.key AND d.file_name = j.key AND "
        "d.expression = j.value) GROUP BY p.id, j.key");
    while (metrics.executeStep())
      tell(fmt::format("point {}: {} trials have no value of metric {} as its suite has it: {:.200}",
                       metrics.getColumn(0).getInt64(), metrics.getColumn(3).getInt64(),
                       metrics.getColumn(1).getString(), metrics.getColumn(2).getString()));
  }

  void hash_tables() {
    Hash chain{};
    Statement s(db_,
                fmt::format("SELECT u.file_name, lower(hex(u.setting_hash)), r.name, p.controller_name, p.label, "
                            "p.params, lower(hex(p.content_hash)), p.simulation_version, m.world_index, "
                            "lower(hex(m.key)), m.family, m.outcome, m.time_to_goal_s, {} FROM main.point_trial AS m "
                            "JOIN main.point AS p ON p.id = m.point_id JOIN main.suite AS u ON u.id = p.suite_id "
                            "JOIN main.robot AS r ON r.id = p.robot_id ORDER BY 1, 2, 4, 5, 7, 9",
                            summary_list("m.")));
    while (s.executeStep()) {
      std::string line = to_hex(chain);
      for (int c = 0; c < s.getColumnCount(); ++c) {
        const SQLite::Column value = s.getColumn(c);
        line += '|';
        if (value.isFloat()) {
          line += fmt::format("{:016x}", std::bit_cast<std::uint64_t>(value.getDouble()));
        } else if (!value.isNull()) {
          line += value.getString();
        }
      }
      chain = hash_text(line);
    }
    counts_.table_hash = to_hex(chain);
  }

  void check_samples() {
    Statement s(db_,
                "SELECT lower(hex(a.key)), a.layout, a.n, a.columns, a.data, t.steps FROM main.samples AS a "
                "LEFT JOIN main.trial AS t ON t.key = a.key ORDER BY a.key");
    while (s.executeStep()) {
      const std::string name = "samples of trial " + s.getColumn(0).getString().substr(0, 16);
      try {
        EncodedSamples encoded{s.getColumn(1).getInt(), s.getColumn(2).getInt64(), s.getColumn(3).getString(), {}};
        const SQLite::Column data = s.getColumn(4);
        const auto* begin = static_cast<const unsigned char*>(data.getBlob());
        if (begin != nullptr) encoded.data.assign(begin, begin + data.getBytes());
        const Trace trace = decode_samples(encoded);
        ++counts_.samples;
        if (!s.getColumn(5).isNull() && s.getColumn(5).getInt64() != static_cast<std::int64_t>(trace.size()))
          tell(
              fmt::format("{}: {} of them, but the trial has {} steps", name, trace.size(), s.getColumn(5).getInt64()));
      } catch (const std::runtime_error& error) {
        tell(fmt::format("{}: {}", name, error.what()));
      }
    }
  }

  SQLite::Database& db_;
  Found finding_;
  ContentCounts counts_;
};

}  // namespace

std::size_t check_hashes(SQLite::Database& db, const std::string& schema, const Found& finding) {
  std::size_t count = 0;
  for (const auto& [table, text] :
       {std::pair{"robot", "resolved"}, std::pair{"controller", "resolved"}, std::pair{"resolved_suite", "resolved"},
        std::pair{"world", "json"}, std::pair{"tune_search", "identity"}}) {
    Statement s(db, fmt::format("SELECT id, hash, {} FROM {}.{}", text, schema, table));
    for (; s.executeStep(); ++count) {
      const Hash hash = hash_text(s.getColumn(2).getString());
      const SQLite::Column kept = s.getColumn(1);
      const bool same = kept.isBlob() && kept.getBytes() == static_cast<int>(hash.size()) &&
                        std::equal(hash.begin(), hash.end(), static_cast<const unsigned char*>(kept.getBlob()));
      if (!same)
        finding(fmt::format("{} {}: its text has another hash than the one that it is kept under; it was changed",
                            table, s.getColumn(0).getInt64()));
    }
  }
  return count;
}

ContentCounts check_contents(const std::filesystem::path& file, const Found& finding) {
  ReadConnection connection(file);
  try {
    return Checker(connection.db(), finding).execute();
  } catch (const SQLite::Exception& error) {
    throw explain(error, file, StoreError::Kind::kUnusable);
  }
}

}  // namespace moma::store
