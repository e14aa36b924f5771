#include "eval/store/reader.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "eval/store/columns.h"
#include "eval/store/hash.h"
#include "eval/store/migrations.h"
#include "eval/store/records.h"
#include "eval/store/rows.h"
#include "eval/store/search_tables.h"
#include "eval/store/table.h"

namespace moma::store {

template <class Work>
auto Reader::guarded(const Work& work) const {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    throw explain(error, file_, StoreError::Kind::kUnusable);
  } catch (const std::invalid_argument& error) {
    throw unusable(file_, fmt::format("is damaged: {}", error.what()));
  }
}

template <class R, class... T, class... A>
std::vector<R> Reader::all_as(const std::string& sql, const A&... values) const {
  return guarded([&] { return rows_as<R, T...>(db(), sql, values...); });
}
template <class T, class... A>
std::vector<T> Reader::all(const std::string& sql, const A&... values) const {
  return all_as<T, T>(sql, values...);
}

std::string Reader::full_key(const std::string& prefix) const {
  const auto range = key_range(prefix);
  if (!range)
    throw not_found(file_, fmt::format("'{}' is no trial; a trial is named by the first hex digits of its key, as the "
                                       "column trial of v_trials shows them",
                                       prefix));
  std::vector<std::string> found =
      rows<std::string>(db(), "SELECT lower(hex(key)) FROM trial WHERE key BETWEEN ? AND ? ORDER BY key LIMIT 4",
                        range->first, range->second);
  if (found.empty()) throw not_found(file_, fmt::format("has no trial that begins with {}", prefix));
  if (found.size() == 1) return found.front();
  const bool more = found.size() > 3;
  if (more) found.resize(3);
  throw not_found(file_, fmt::format("{} is the beginning of several trials ({}{}); give more digits", prefix,
                                     fmt::join(found, ", "), more ? ", ..." : ""));
}

StoredTrial Reader::trial(const std::string& prefix) const {
  return guarded([&] {
    const std::string key = full_key(prefix);
    std::optional<SQLite::Statement>& s = trial_;
    if (!s) {
      const std::set<std::string> there = stored_columns(db(), "trial");
      s.emplace(db(), fmt::format(
                          "SELECT p.id, s.name, p.controller, p.label, r.resolved, p.resolved_position, "
                          "p.simulation_version, lower(hex(t.key)), w.world_index, w.json, "
                          "coalesce(i.machine_class, ''), {} "
                          "FROM trial AS t JOIN world AS w ON w.id = t.world_id "
                          "JOIN point_trial AS m ON m.key = t.key JOIN point AS p ON p.id = m.point_id "
                          "JOIN suite AS s ON s.id = p.suite_id JOIN resolved_suite AS r ON r.id = p.resolved_suite_id "
                          "LEFT JOIN execution AS e ON e.key = t.key "
                          "LEFT JOIN invocation AS i ON i.id = e.invocation_id WHERE t.key = ? ORDER BY p.id LIMIT 1",
                          column_names<TrialRow>("t.", &there)));
    }
    auto found = row_as<StoredTrial, StoredPoint, std::string, std::uint64_t, std::string, std::string, TrialRow>(
        *s, hash_from_hex(key));
    if (!found) throw not_found(file_, fmt::format("trial {} belongs to no suite", key));
    found->samples = samples(key);
    return *std::move(found);
  });
}

std::optional<EncodedSamples> Reader::samples(const std::string& key) const {
  return guarded([&] {
    if (!samples_) samples_.emplace(db(), "SELECT " + column_names<EncodedSamples>() + " FROM samples WHERE key = ?");
    return row<EncodedSamples>(*samples_, hash_from_hex(key));
  });
}

std::vector<std::string> Reader::keys() const {
  return all<std::string>("SELECT DISTINCT lower(hex(key)) FROM point_trial ORDER BY 1");
}

std::vector<std::string> Reader::suite_names() const { return all<std::string>("SELECT name FROM suite ORDER BY id"); }

std::string Reader::latest_suite(const std::string& name) const {
  return guarded([&] {
    auto found = row<std::string>(db(),
                                  "SELECT r.resolved FROM invocation AS i JOIN suite AS s ON s.id = i.suite_id "
                                  "JOIN resolved_suite AS r ON r.id = i.resolved_suite_id "
                                  "WHERE s.name = ? ORDER BY i.id DESC LIMIT 1",
                                  name);
    if (!found)
      throw not_found(file_, fmt::format("has no suite '{}'; it has: {}", name, fmt::join(suite_names(), ", ")));
    return std::move(*found);
  });
}

std::vector<StoredMetric> Reader::metrics(const std::string& key) const {
  return all_as<StoredMetric, std::string, std::string, double>(
      "SELECT d.file_name, d.expression, v.value FROM metric_value AS v JOIN metric AS d ON d.id = v.metric_id "
      "WHERE v.key = ? ORDER BY d.id",
      hash_from_hex(key));
}

std::vector<StoredPoint> Reader::points() const {
  return all<StoredPoint>(
      "SELECT p.id, s.name, p.controller, p.label, r.resolved, p.resolved_position, p.simulation_version "
      "FROM point AS p JOIN suite AS s ON s.id = p.suite_id JOIN resolved_suite AS r "
      "ON r.id = p.resolved_suite_id ORDER BY p.id");
}

std::vector<PointTrial> Reader::trials_of(std::int64_t point) const {
  return all_as<PointTrial, std::uint64_t, std::string>(
      "SELECT world_index, lower(hex(key)) FROM point_trial WHERE point_id = ? ORDER BY world_index", point);
}

std::string Reader::point_differences(std::int64_t point, const PointRecord& said) const {
  return guarded([&] {
    const auto found = row<std::string, std::string, std::string, PointRow>(
        db(),
        fmt::format("SELECT r.name, r.resolved, c.resolved, {} FROM point AS p JOIN robot AS r ON r.id = p.robot_id "
                    "JOIN controller AS c ON c.id = p.controller_id WHERE p.id = ?",
                    column_names<PointRow>("p.")),
        point);
    if (!found) return std::string("robot or controller");
    const auto& [robot_name, robot, controller, kept] = *found;
    std::vector<std::string> differ;
    if (robot_name != said.robot_name || robot != said.robot_resolved) differ.emplace_back("robot");
    if (controller != said.controller_resolved) differ.emplace_back("controller");
    PointRow wanted = said;  // names as shown, and where its parts are, are this store's own
    wanted.controller_name = said.controller;
    wanted.suite_id = kept.suite_id, wanted.controller = kept.controller, wanted.robot_id = kept.robot_id;
    wanted.controller_id = kept.controller_id, wanted.resolved_suite_id = kept.resolved_suite_id;
    wanted.resolved_position = kept.resolved_position;
    if (std::string columns = differing_columns(kept, wanted); !columns.empty()) differ.push_back(std::move(columns));
    return fmt::format("{}", fmt::join(differ, ", "));
  });
}

std::vector<std::string> Reader::running() const {
  return all<std::string>("SELECT started FROM invocation WHERE status = ? ORDER BY id", RunStatus::kRunning);
}

std::vector<std::string> Reader::searched_keys() const {
  return all<std::string>(
      "SELECT lower(hex(t.key)) FROM trial AS t WHERE NOT EXISTS (SELECT 1 FROM point_trial AS m WHERE m.key = t.key) "
      "ORDER BY t.key");
}

std::vector<std::string> Reader::keys_of_suite(const std::string& name) const {
  return all<std::string>(
      "SELECT DISTINCT lower(hex(m.key)) FROM point_trial AS m JOIN point AS p ON p.id = m.point_id JOIN suite AS u "
      "ON u.id = p.suite_id WHERE u.name = ? ORDER BY 1",
      name);
}

std::vector<std::string> Reader::robots() const { return all<std::string>("SELECT resolved FROM robot ORDER BY id"); }

std::vector<std::int64_t> Reader::searches() const {
  return all<std::int64_t>("SELECT id FROM tune_search ORDER BY id");
}

StoredSearch Reader::search(std::int64_t id) const {
  StoredSearch search;
  const auto rows = [&]<class R>(const char* table, const char* place, std::vector<R>& to) {
    const std::set<std::string> stored = stored_columns(db(), table);
    try {
      to = place == nullptr ? store::Table<R>(db(), table, {"id"}, &stored).all(id)
                            : store::Table<R>(db(), table, {"search_id", place}, &stored).all(id);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("{}: {}", table, error.what()));
    }
    if (place == nullptr || to.empty()) return;
    const auto [first, last] = *row<std::size_t, std::size_t>(
        db(), fmt::format("SELECT min({0}), max({0}) FROM {1} WHERE search_id = ?", place, table), id);
    if (first != 0 || last + 1 != to.size())
      throw std::invalid_argument(fmt::format("{}: its rows are not numbered 0, 1, 2 ...", table));
  };
  guarded([&] {
    std::vector<TuneSearchRecord> record;
    rows("tune_search", nullptr, record);
    search.record = std::move(record.at(0));
    rows("tune_variable", "variable", search.variables);
    rows("tune_evaluation", "evaluation", search.evaluations);
    rows("tune_finalist", "place", search.finalists);
    rows("tune_sensitivity", "entry", search.sensitivity);
    rows("tune_comparison", "entry", search.comparisons);
  });
  return search;
}

std::optional<LoneTrial> Reader::lone_trial(const std::string& key) const {
  return guarded([&]() -> std::optional<LoneTrial> {
    std::optional<SQLite::Statement>& s = lone_;
    if (!s) {
      const std::set<std::string> there = stored_columns(db(), "trial");
      s.emplace(db(), fmt::format("SELECT {}, w.json, coalesce(i.machine_class, '') FROM trial AS t "
                                  "JOIN world AS w ON w.id = t.world_id LEFT JOIN execution AS e ON e.key = t.key "
                                  "LEFT JOIN invocation AS i ON i.id = e.invocation_id WHERE t.key = ?",
                                  column_names<TrialRow>("t.", &there)));
    }
    auto found = row<TrialRow, std::string, std::string>(*s, hash_from_hex(key));
    if (!found) return std::nullopt;
    auto& [result, world, machine_class] = *found;
    return LoneTrial{std::move(result), std::move(world), std::move(machine_class)};
  });
}

std::vector<std::string> Reader::integrity_problems() const {
  return guarded([&] {
    const auto look = [this] {
      std::vector<std::string> findings;
      try {
        for_rows<std::string>(db(), "PRAGMA integrity_check",
                              [&](const std::string& finding) { findings.push_back(finding); });
      } catch (const SQLite::Exception& error) {  // ends what it found where a page keeps it from going on
        if (error.getErrorCode() != SQLITE_CORRUPT || findings.empty()) throw;
        findings.emplace_back(error.what());
      }
      std::erase(findings, "ok");
      return findings;
    };
    std::vector<std::string> problems = look();
    // A page that it could not get, for want of memory or since the disk failed, is a finding like any other.
    if (!problems.empty() && look() != problems) {
      throw unusable(file_,
                     "cannot be read: two looks at its pages found different things (does the disk or the memory "
                     "fail?)");
    }
    if (!problems.empty()) return problems;  // references through such pages end in SQLite's error, without these
    for_rows<std::string, std::string>(
        db(), "SELECT \"table\", parent FROM pragma_foreign_key_check",
        [&](const std::string& table, const std::string& parent) {
          problems.push_back(fmt::format("a row of {} refers to a missing row of {}", table, parent));
        });
    return problems;
  });
}

std::string Reader::result_hash() const {
  return guarded([&] {
    Hash chain{};
    const std::set<std::string> there = stored_columns(db(), "trial");
    SQLite::Statement s(db(), fmt::format("SELECT lower(hex(t.key)), w.hash, {} FROM trial AS t "
                                          "JOIN world AS w ON w.id = t.world_id ORDER BY t.key",
                                          column_names<TrialRow>("t.", &there)));
    const std::vector<TrialColumn>& columns = trial_columns();
    const int first = s.getColumnCount() - static_cast<int>(columns.size());
    while (s.executeStep()) {
      std::string line = to_hex(chain);
      for (int c = 0; c < s.getColumnCount(); ++c) {
        const SQLite::Column value = s.getColumn(c);
        const TrialColumn* column = c >= first ? &columns[static_cast<std::size_t>(c - first)] : nullptr;
        const bool later = column != nullptr && column->about.earlier == Earlier::kUnknown;
        // A row that does not know the value hashes as it did before the column was there.
        if (later && value.isNull()) continue;
        line += later ? fmt::format("|{}=", column->name) : "|";
        add_bits(line, value);
      }
      chain = hash_text(line);
    }
    // A store without metrics keeps the hash of versions that had no metrics.
    return to_hex(chain_rows(db(), chain,
                             "SELECT d.file_name, d.expression, lower(hex(v.key)), v.value FROM metric_value AS v "
                             "JOIN metric AS d ON d.id = v.metric_id ORDER BY 1, 2, 3"));
  });
}

}  // namespace moma::store
