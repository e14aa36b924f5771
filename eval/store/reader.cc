#include "eval/store/reader.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <limits>
#include <stdexcept>
#include <utility>

#include "eval/store/columns.h"
#include "eval/store/database.h"
#include "eval/store/hash.h"
#include "eval/store/migrations.h"
#include "eval/store/records.h"
#include "eval/store/search_tables.h"
#include "eval/store/table.h"
#include "eval/store/words.h"

namespace moma::store {
namespace {

using SQLite::Statement;

StoreError not_found(const std::filesystem::path& file, const std::string& message) {
  return {StoreError::Kind::kNotFound, fmt::format("{}: {}", file.string(), message)};
}

/// Least and greatest key with these first hex digits.
std::pair<Hash, Hash> key_range(std::string prefix) {
  std::string low = prefix;
  low.resize(32, '0');
  prefix.resize(32, 'f');
  return {hash_from_hex(low), hash_from_hex(prefix)};
}

std::vector<std::string> findings_of_sqlite(const SQLite::Database& db) {
  std::vector<std::string> findings;
  Statement integrity(db, "PRAGMA integrity_check");
  while (integrity.executeStep()) {
    std::string line = integrity.getColumn(0).getString();
    if (line != "ok") findings.push_back(std::move(line));
  }
  return findings;
}

}  // namespace

struct Reader::Impl {
  std::filesystem::path file;
  ReadConnection connection;
  SQLite::Database& db;
  std::optional<Statement> lone;  ///< of lone_trial(), which is asked often
  explicit Impl(const std::filesystem::path& path) : file(path), connection(path), db(connection.db()) {}

  template <typename Work>
  auto guarded(const Work& work) {
    try {
      return work();
    } catch (const SQLite::Exception& error) {
      throw explain(error, file, StoreError::Kind::kUnusable);
    } catch (const std::invalid_argument& error) {  // a key or a word that no moma writes
      throw StoreError(StoreError::Kind::kUnusable, fmt::format("{}: is damaged: {}", file.string(), error.what()));
    }
  }

  std::vector<std::string> texts(const char* sql) {
    return guarded([&] {
      std::vector<std::string> all;
      for (Statement s(db, sql); s.executeStep();) all.push_back(s.getColumn(0).getString());
      return all;
    });
  }

  std::string full_key(const std::string& prefix) {
    const bool hex = !prefix.empty() && prefix.size() <= 32 &&
                     std::all_of(prefix.begin(), prefix.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
    if (!hex) {
      throw not_found(file, fmt::format("'{}' is no trial; a trial is named by the first hex digits of its key, as the "
                                        "column trial of v_trials shows them",
                                        prefix));
    }
    std::string lower = prefix;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    const auto [low, high] = key_range(lower);
    Statement s(db, "SELECT lower(hex(key)) FROM trial WHERE key BETWEEN ? AND ? ORDER BY key LIMIT 4");
    bind_cell(s, 1, low);
    bind_cell(s, 2, high);
    std::vector<std::string> found;
    while (s.executeStep()) found.push_back(s.getColumn(0).getString());
    if (found.empty()) throw not_found(file, fmt::format("has no trial that begins with {}", prefix));
    if (found.size() > 1) {
      const bool more = found.size() > 3;
      if (more) found.resize(3);
      throw not_found(file, fmt::format("{} is the beginning of several trials ({}{}); give more digits", prefix,
                                        fmt::join(found, ", "), more ? ", ..." : ""));
    }
    return found.front();
  }
};

Reader::Reader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}
Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

StoredTrial Reader::trial(const std::string& prefix) const {
  return impl_->guarded([&] {
    const std::string key = impl_->full_key(prefix);
    const Hash hash = hash_from_hex(key);
    const std::set<std::string> there = stored_columns(impl_->db, "trial");
    Statement s(
        impl_->db,
        fmt::format("SELECT s.name, p.controller, p.label, r.resolved, p.resolved_position, w.world_index, "
                    "w.json, i.machine_class, p.simulation_version, a.layout, a.n, a.columns, a.data, {} "
                    "FROM trial AS t JOIN world AS w ON w.id = t.world_id "
                    "JOIN point_trial AS m ON m.key = t.key JOIN point AS p ON p.id = m.point_id "
                    "JOIN suite AS s ON s.id = p.suite_id JOIN resolved_suite AS r ON r.id = p.resolved_suite_id "
                    "LEFT JOIN execution AS e ON e.key = t.key "
                    "LEFT JOIN invocation AS i ON i.id = e.invocation_id "
                    "LEFT JOIN samples AS a ON a.key = t.key WHERE t.key = ? ORDER BY p.id LIMIT 1",
                    column_names<TrialRow>("t.", &there)));
    bind_cell(s, 1, hash);
    if (!s.executeStep()) throw not_found(impl_->file, fmt::format("trial {} belongs to no suite", key));
    StoredTrial trial;
    trial.key = key;
    trial.suite = s.getColumn(0).getString();
    trial.controller = s.getColumn(1).getString();
    trial.point = s.getColumn(2).getString();
    trial.resolved_suite = s.getColumn(3).getString();
    trial.position = static_cast<std::size_t>(s.getColumn(4).getInt64());
    trial.world_index = static_cast<std::uint64_t>(s.getColumn(5).getInt64());
    trial.world = s.getColumn(6).getString();
    trial.machine_class = s.getColumn(7).isNull() ? "" : s.getColumn(7).getString();
    trial.simulation_version = s.getColumn(8).getInt();
    if (!s.getColumn(9).isNull()) {
      EncodedSamples samples;
      samples.layout = s.getColumn(9).getInt();
      samples.n = s.getColumn(10).getInt64();
      samples.columns = s.getColumn(11).getString();
      const SQLite::Column data = s.getColumn(12);
      const auto* begin = static_cast<const unsigned char*>(data.getBlob());
      if (begin != nullptr) samples.data.assign(begin, begin + data.getBytes());
      trial.samples = std::move(samples);
    }
    trial.row = read_record<TrialRow>(s, 13);
    return trial;
  });
}

std::vector<std::string> Reader::keys() const {
  return impl_->texts("SELECT DISTINCT lower(hex(key)) FROM point_trial ORDER BY 1");
}

std::vector<std::string> Reader::suite_names() const { return impl_->texts("SELECT name FROM suite ORDER BY id"); }

StoredInvocation Reader::latest_invocation(const std::string& name) const {
  return impl_->guarded([&] {
    Statement s(impl_->db,
                "SELECT i.id, s.name, r.resolved, i.started, i.status FROM invocation AS i "
                "JOIN suite AS s ON s.id = i.suite_id JOIN resolved_suite AS r ON r.id = i.resolved_suite_id "
                "WHERE s.name = ? ORDER BY i.id DESC LIMIT 1");
    s.bind(1, name);
    if (!s.executeStep()) {
      throw not_found(impl_->file, fmt::format("has no suite '{}'; it has: {}", name, fmt::join(suite_names(), ", ")));
    }
    return StoredInvocation{s.getColumn(0).getInt64(), s.getColumn(1).getString(), s.getColumn(2).getString(),
                            s.getColumn(3).getString(), s.getColumn(4).getString()};
  });
}

std::vector<StoredMetric> Reader::metrics(const std::string& key) const {
  return impl_->guarded([&] {
    const Hash hash = hash_from_hex(key);
    Statement s(
        impl_->db,
        "SELECT d.file_name, d.expression, v.value FROM metric_value AS v JOIN metric AS d ON d.id = v.metric_id "
        "WHERE v.key = ? ORDER BY d.id");
    bind_cell(s, 1, hash);
    std::vector<StoredMetric> metrics;
    while (s.executeStep()) {
      const SQLite::Column value = s.getColumn(2);
      metrics.push_back({s.getColumn(0).getString(), s.getColumn(1).getString(),
                         value.isNull() ? std::numeric_limits<double>::quiet_NaN() : value.getDouble()});
    }
    return metrics;
  });
}

std::vector<StoredPoint> Reader::points() const {
  return impl_->guarded([&] {
    Statement s(impl_->db,
                "SELECT p.id, s.name, p.controller, p.label, r.resolved, p.resolved_position, p.simulation_version "
                "FROM point AS p JOIN suite AS s ON s.id = p.suite_id JOIN resolved_suite AS r "
                "ON r.id = p.resolved_suite_id ORDER BY p.id");
    std::vector<StoredPoint> points;
    while (s.executeStep()) {
      points.push_back({s.getColumn(0).getInt64(), s.getColumn(1).getString(), s.getColumn(2).getString(),
                        s.getColumn(3).getString(), s.getColumn(4).getString(),
                        static_cast<std::size_t>(s.getColumn(5).getInt64()), s.getColumn(6).getInt()});
    }
    return points;
  });
}

std::vector<PointTrial> Reader::trials_of(std::int64_t point) const {
  return impl_->guarded([&] {
    Statement s(impl_->db,
                "SELECT world_index, lower(hex(key)) FROM point_trial WHERE point_id = ? ORDER BY world_index");
    s.bind(1, point);
    std::vector<PointTrial> trials;
    while (s.executeStep())
      trials.push_back({static_cast<std::uint64_t>(s.getColumn(0).getInt64()), s.getColumn(1).getString()});
    return trials;
  });
}

std::string Reader::point_differences(std::int64_t point, const PointRecord& said) const {
  return impl_->guarded([&] {
    Statement s(impl_->db, fmt::format("SELECT r.name, r.resolved, c.resolved, {} "
                                       "FROM point AS p JOIN robot AS r ON r.id = p.robot_id JOIN controller AS c "
                                       "ON c.id = p.controller_id WHERE p.id = ?",
                                       column_names<PointRow>("p.")));
    s.bind(1, point);
    if (!s.executeStep()) return std::string("robot or controller");
    std::string differ;
    const auto compare = [&](const char* name, bool same) {
      if (!same) differ += fmt::format("{}{}", differ.empty() ? "" : ", ", name);
    };
    compare("robot",
            s.getColumn(0).getString() == said.robot_name && s.getColumn(1).getString() == said.robot_resolved);
    compare("controller", s.getColumn(2).getString() == said.controller_resolved);
    PointRow row = said;  // names as shown, and where its parts are, are this store's own
    const PointRow own = read_record<PointRow>(s, 3);
    row.controller_name = said.controller;
    row.suite_id = own.suite_id, row.controller = own.controller, row.robot_id = own.robot_id;
    row.controller_id = own.controller_id, row.resolved_suite_id = own.resolved_suite_id;
    row.resolved_position = own.resolved_position;
    const std::string columns = differing_columns(own, row);
    if (!columns.empty()) compare(columns.c_str(), false);
    return differ;
  });
}

std::vector<std::string> Reader::running() const {
  return impl_->guarded([&] {
    std::vector<std::string> started;
    Statement s(impl_->db, "SELECT started FROM invocation WHERE status = ? ORDER BY id");
    s.bind(1, std::string(to_string(RunStatus::kRunning)));
    while (s.executeStep()) started.push_back(s.getColumn(0).getString());
    return started;
  });
}

std::vector<std::string> Reader::searched_keys() const {
  return impl_->texts(
      "SELECT lower(hex(t.key)) FROM trial AS t WHERE NOT EXISTS (SELECT 1 FROM point_trial AS m WHERE m.key = t.key) "
      "ORDER BY t.key");
}

std::set<std::string> Reader::keys_of_suite(const std::string& name) const {
  return impl_->guarded([&] {
    std::set<std::string> keys;
    Statement s(impl_->db,
                "SELECT lower(hex(m.key)) FROM point_trial AS m JOIN point AS p ON p.id = m.point_id JOIN suite AS u "
                "ON u.id = p.suite_id WHERE u.name = ?");
    s.bind(1, name);
    while (s.executeStep()) keys.insert(s.getColumn(0).getString());
    return keys;
  });
}

std::vector<std::string> Reader::robots() const { return impl_->texts("SELECT resolved FROM robot ORDER BY id"); }

std::vector<std::int64_t> Reader::searches() const {
  return impl_->guarded([&] {
    std::vector<std::int64_t> ids;
    Statement s(impl_->db, "SELECT id FROM tune_search ORDER BY id");
    while (s.executeStep()) ids.push_back(s.getColumn(0).getInt64());
    return ids;
  });
}

StoredSearch Reader::search(std::int64_t id) const {
  StoredSearch search;
  const auto rows = [&]<class R>(const char* table, const char* place, std::vector<R>& to) {
    const std::set<std::string> stored = stored_columns(impl_->db, table);
    try {
      to = place == nullptr ? store::Table<R>(impl_->db, table, {"id"}, &stored).all(id)
                            : store::Table<R>(impl_->db, table, {"search_id", place}, &stored).all(id);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(fmt::format("{}: {}", table, error.what()));
    }
    if (place == nullptr || to.empty()) return;
    Statement s(impl_->db, fmt::format("SELECT min({0}), max({0}) FROM {1} WHERE search_id = ?", place, table));
    s.bind(1, id);
    s.executeStep();
    if (s.getColumn(0).getInt64() != 0 || s.getColumn(1).getInt64() + 1 != static_cast<std::int64_t>(to.size()))
      throw std::invalid_argument(fmt::format("{}: its rows are not numbered 0, 1, 2 ...", table));
  };
  impl_->guarded([&] {
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
  return impl_->guarded([&]() -> std::optional<LoneTrial> {
    std::optional<Statement>& s = impl_->lone;
    if (!s) {
      const std::set<std::string> there = stored_columns(impl_->db, "trial");
      s.emplace(impl_->db, fmt::format("SELECT w.json, i.machine_class, {} FROM trial AS t JOIN world AS w ON w.id = "
                                       "t.world_id LEFT JOIN execution AS e ON e.key = t.key LEFT JOIN invocation AS i "
                                       "ON i.id = e.invocation_id WHERE t.key = ?",
                                       column_names<TrialRow>("t.", &there)));
    }
    s->reset();
    bind_cell(*s, 1, hash_from_hex(key));
    if (!s->executeStep()) return std::nullopt;
    return LoneTrial{read_record<TrialRow>(*s, 2), s->getColumn(0).getString(),
                     s->getColumn(1).isNull() ? "" : s->getColumn(1).getString()};
  });
}

std::vector<std::string> Reader::integrity_problems() const {
  return impl_->guarded([&] {
    std::vector<std::string> problems = findings_of_sqlite(impl_->db);
    // A page that it could not get, for want of memory or since the disk failed, is a finding like any other.
    if (!problems.empty() && findings_of_sqlite(impl_->db) != problems) {
      throw StoreError(StoreError::Kind::kUnusable,
                       fmt::format("{}: cannot be read: two looks at its pages found different things (do the disk or "
                                   "the memory fail?)",
                                   impl_->file.string()));
    }
    Statement foreign(impl_->db, "PRAGMA foreign_key_check");
    while (foreign.executeStep()) {
      problems.push_back(fmt::format("a row of {} refers to a missing row of {}", foreign.getColumn(0).getString(),
                                     foreign.getColumn(2).getString()));
    }
    return problems;
  });
}

std::string Reader::result_hash() const {
  return impl_->guarded([&] {
    Hash chain{};
    const std::set<std::string> there = stored_columns(impl_->db, "trial");
    Statement s(impl_->db, fmt::format("SELECT lower(hex(t.key)), w.hash, {} FROM trial AS t "
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
        // The bits of a number, not its decimal form.
        if (value.isFloat()) {
          line += fmt::format("{:016x}", std::bit_cast<std::uint64_t>(value.getDouble()));
        } else if (!value.isNull()) {
          line += value.getString();
        }
      }
      chain = hash_text(line);
    }
    // Without metrics the hash is what it was before there were any.
    Statement m(impl_->db,
                "SELECT d.file_name, d.expression, lower(hex(v.key)), v.value FROM metric_value AS v "
                "JOIN metric AS d ON d.id = v.metric_id ORDER BY 1, 2, 3");
    while (m.executeStep()) {
      const SQLite::Column value = m.getColumn(3);
      chain = hash_text(
          fmt::format("{}|{}|{}|{}|{}", to_hex(chain), m.getColumn(0).getString(), m.getColumn(1).getString(),
                      m.getColumn(2).getString(),
                      value.isNull() ? "" : fmt::format("{:016x}", std::bit_cast<std::uint64_t>(value.getDouble()))));
    }
    return to_hex(chain);
  });
}

}  // namespace moma::store
