#include "eval/store/writer.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <unordered_map>

#include "eval/search/words.h"
#include "eval/store/build_info.h"
#include "eval/store/columns.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/difficulty.h"
#include "eval/store/late.h"
#include "eval/store/machine.h"
#include "eval/store/registry.h"
#include "eval/store/samples.h"
#include "eval/store/table.h"

namespace moma::store {
namespace {

using Clock = std::chrono::steady_clock;
using SQLite::Statement;

constexpr std::size_t kBatchRows = 64;
constexpr std::chrono::milliseconds kBatchTime{20};

struct Pending {
  Wanted trial;
  Hash key{};
  WorldRecord world;
  TrialRow row;
  std::optional<EncodedSamples> samples;
  std::vector<double> metrics;
};

/// Prepared once; SQLite compiles a statement in tens of microseconds. What is there already is left by ON CONFLICT,
/// not by OR IGNORE, which would leave out rows that break a rule of their table as well, and say nothing: also where
/// memory runs out while a CHECK is computed (json_valid() in SQLite 3.40).
struct Statements {
  explicit Statements(SQLite::Database& db)
      : find_world(db, "SELECT id FROM world WHERE hash = ?"),
        world(db, insert_sql("world", "hash, world_index, seed, family, json, " + column_names<Difficulty>())),
        trial(db, insert_sql("trial", "key, world_id, " + column_names<TrialRow>()) + " ON CONFLICT DO NOTHING"),
        execution(db, insert_sql("execution", "key, invocation_id, " + column_names<TrialRow::Timing>())),
        samples(db,
                "INSERT INTO samples (key, layout, n, columns, data) VALUES (?, ?, ?, ?, ?) ON CONFLICT DO NOTHING"),
        link(db, fmt::format("INSERT INTO point_trial (point_id, world_index, key, world_id, family, outcome, "
                             "time_to_goal_s, {}) SELECT ?1, ?2, t.key, t.world_id, w.family, t.outcome, "
                             "t.time_to_goal_s, {} FROM trial AS t JOIN world AS w ON w.id = t.world_id "
                             "WHERE t.key = ?3 ON CONFLICT (point_id, world_index) DO NOTHING",
                             summary_list(), summary_list("t."))),
        find_trial(db, fmt::format("SELECT i.machine_class, {} FROM trial AS t LEFT JOIN execution AS e USING (key) "
                                   "LEFT JOIN invocation AS i ON i.id = e.invocation_id WHERE t.key = ?",
                                   column_names<TrialRow>("t."))),
        metric(db, "INSERT INTO metric_value (metric_id, key, value) VALUES (?, ?, ?) ON CONFLICT DO NOTHING"),
        done(db, "UPDATE invocation SET trials_done = ? WHERE id = ?") {}
  Statement find_world, world, trial, execution, samples, link, find_trial, metric, done;
};

}  // namespace

struct Writer::Impl {
  std::filesystem::path file;
  SQLite::Database db;
  std::optional<Statements> sql;
  Machine machine = this_machine();
  Registered registered;
  std::vector<Wanted> wanted;
  std::int64_t invocation = 0;
  std::vector<std::int64_t> metrics;  ///< ids of the suite's own
  std::vector<Pending> pending;
  Clock::time_point last_commit = Clock::now();
  std::size_t committed = 0;
  bool fresh = false;  ///< this writer made the file
  std::size_t forgotten = 0;

  explicit Impl(const std::filesystem::path& path) : file(path), db(open_database(path, Access::kCreate)) {}

  std::int64_t world_id(const WorldRecord& world) {
    const Hash hash = hash_text(world.json);
    sql->find_world.reset();
    bind_cell(sql->find_world, 1, hash);
    if (sql->find_world.executeStep()) {
      const std::int64_t id = sql->find_world.getColumn(0).getInt64();
      sql->find_world.reset();  // an open reading statement would keep its snapshot past the commit
      return id;
    }
    Statement& s = sql->world;
    s.reset();
    bind_cell(s, 1, hash);
    s.bind(2, static_cast<std::int64_t>(world.index));
    s.bind(3, std::to_string(world.seed));
    s.bind(4, world.family);
    s.bind(5, world.json);
    bind_record(s, 6, world.difficulty);
    s.exec();
    return db.getLastInsertRowid();
  }

  void insert(const Pending& p) {
    Statement& s = sql->trial;
    s.reset();
    bind_cell(s, 1, p.key);
    s.bind(2, world_id(p.world));
    bind_record(s, 3, p.row);
    if (s.exec() == 0) {
      check_same(p);
    } else {
      insert_execution(p);
    }
    if (p.samples) insert_samples(p);
    for (std::size_t i = 0; i < std::min(p.metrics.size(), metrics.size()); ++i) {
      Statement& m = sql->metric;
      m.reset();
      m.bind(1, metrics[i]);
      bind_cell(m, 2, p.key);
      bind_metric(m, 3, p.metrics[i]);
      m.exec();
    }
    if (p.trial.point != kNoPoint) link(p.trial, p.key);
  }

  void insert_execution(const Pending& p) {
    Statement& s = sql->execution;
    s.reset();
    bind_cell(s, 1, p.key);
    s.bind(2, invocation);
    bind_record(s, 3, p.row.timing);
    s.exec();
  }

  void insert_samples(const Pending& p) {
    Statement& s = sql->samples;
    s.reset();
    bind_cell(s, 1, p.key);
    s.bind(2, p.samples->layout);
    s.bind(3, p.samples->n);
    s.bind(4, p.samples->columns);
    s.bind(5, p.samples->data.data(), static_cast<int>(p.samples->data.size()));
    s.exec();
  }

  void link(const Wanted& trial, const Hash& key) {
    Statement& s = sql->link;
    s.reset();
    s.bind(1, registered.point_ids.at(trial.point));
    s.bind(2, static_cast<std::int64_t>(trial.world));
    bind_cell(s, 3, key);
    s.exec();
  }

  /// The key is there already: the rows must agree, unless the machines are of different classes.
  void check_same(const Pending& p) {
    Statement& s = sql->find_trial;
    s.reset();
    bind_cell(s, 1, p.key);
    if (!s.executeStep()) return;
    const bool same_class = s.getColumn(0).isNull() || s.getColumn(0).getString() == machine.machine_class;
    const std::vector<std::string> found = differences(read_record<TrialRow>(s, 1), p.row);
    s.reset();
    if (same_class && !found.empty()) {
      throw StoreError(
          StoreError::Kind::kContradiction,
          fmt::format("{}: trial {} was computed twice with different results ({}); the stored row is kept",
                      file.string(), p.trial.key.substr(0, 16), fmt::join(found, "; ")));
    }
  }

  void begin_invocation(const SuiteRecord& suite, const InvocationInfo& info) {
    registered = register_suite(db, suite);
    for (const auto& [name, expression] : suite.metrics) metrics.push_back(metric_id(db, name, expression));
    InvocationRow row;
    row.suite_id = registered.suite_id;
    row.resolved_suite_id = registered.resolved_suite_id;
    row.started = utc_now();
    row.arguments = nlohmann::json(info.arguments).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    row.moma_version = kVersion;
    if (*kGitCommit != '\0') {
      row.git_commit = kGitCommit;
      row.git_dirty = kGitDirty;
    }
    row.build_type = kBuildType;
    row.compiler = kCompiler;
    row.compiler_flags = kCompilerFlags;
    row.libraries = machine.libraries;
    row.host = machine.host;
    row.os = machine.os;
    row.cpu = machine.cpu;
    row.cpu_count = machine.cpu_count;
    row.threads = info.threads;
    row.machine_class = machine.machine_class;
    row.trials_planned = wanted.size();
    Table<InvocationRow>(db, "invocation", {"id"}).insert(row);
    invocation = db.getLastInsertRowid();
  }

  /// Links every wanted trial that is stored; returns their keys.
  std::unordered_set<std::string> link_present(std::span<const Wanted> trials) {
    std::unordered_set<std::string> present;
    std::string ids;
    for (const std::int64_t id : metrics) ids += fmt::format("{}{}", ids.empty() ? "" : ", ", id);
    Statement find(db, fmt::format("SELECT (SELECT count(*) FROM metric_value AS v WHERE v.key = t.key AND "
                                   "v.metric_id IN ({})) FROM trial AS t WHERE t.key = ?",
                                   ids));
    for (const Wanted& trial : trials) {
      const Hash key = hash_from_hex(trial.key);
      find.reset();
      bind_cell(find, 1, key);
      if (!find.executeStep()) continue;
      const bool complete = find.getColumn(0).getInt64() == static_cast<std::int64_t>(metrics.size());
      if (complete) present.insert(trial.key);
      link(trial, key);
    }
    return present;
  }

  void flush() {
    if (pending.empty()) return;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    for (const Pending& p : pending) insert(p);
    sql->done.reset();
    sql->done.bind(1, static_cast<std::int64_t>(committed + pending.size()));
    sql->done.bind(2, invocation);
    sql->done.exec();
    transaction.commit();
    committed += pending.size();
    pending.clear();
    last_commit = Clock::now();
  }

  /// After a failure nothing of what is kept back can be written any more.
  template <typename Work>
  auto guarded(StoreError::Kind kind, const Work& work) {
    try {
      return work();
    } catch (const SQLite::Exception& error) {
      pending.clear();
      throw explain(error, file, kind);
    } catch (const StoreError&) {
      pending.clear();
      throw;
    }
  }
};

Writer::Writer(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {
  impl_->guarded(StoreError::Kind::kUnusable, [this] {
    impl_->fresh = impl_->db.execAndGet("SELECT count(*) FROM suite").getInt64() == 0;
    impl_->forgotten = forget_late(impl_->db);
  });
}

Writer::~Writer() {
  if (impl_ == nullptr) return;
  try {
    impl_->flush();
  } catch (...) {  // a destructor on the way out of another failure: what is committed stays
  }
}

std::unordered_set<std::string> Writer::begin(const SuiteRecord& suite, const InvocationInfo& info,
                                              const std::vector<Wanted>& wanted) {
  const auto work = [&] {
    Impl& self = *impl_;
    self.wanted = wanted;
    SQLite::Transaction transaction(self.db, SQLite::TransactionBehavior::IMMEDIATE);
    self.sql.emplace(self.db);
    self.begin_invocation(suite, info);
    std::unordered_set<std::string> present = self.link_present(self.wanted);
    Statement update(self.db, "UPDATE invocation SET trials_present = ? WHERE id = ?");
    update.bind(1, static_cast<std::int64_t>(present.size()));
    update.bind(2, self.invocation);
    update.exec();
    transaction.commit();
    return present;
  };
  try {
    return impl_->guarded(StoreError::Kind::kUnusable, work);
  } catch (...) {
    if (impl_->fresh) {  // leave no store without content behind
      const std::filesystem::path file = impl_->file;
      impl_.reset();
      std::error_code ignored;
      for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(file.string() + suffix, ignored);
    }
    throw;
  }
}

std::unordered_set<std::string> Writer::extend(const std::vector<Wanted>& more) {
  return impl_->guarded(StoreError::Kind::kInterrupted, [&] {
    Impl& self = *impl_;
    self.flush();
    SQLite::Transaction transaction(self.db, SQLite::TransactionBehavior::IMMEDIATE);
    std::unordered_set<std::string> present = self.link_present(more);
    Statement update(self.db,
                     "UPDATE invocation SET trials_planned = trials_planned + ?, trials_present = trials_present + ? "
                     "WHERE id = ?");
    update.bind(1, static_cast<std::int64_t>(more.size()));
    update.bind(2, static_cast<std::int64_t>(present.size()));
    update.bind(3, self.invocation);
    update.exec();
    transaction.commit();
    self.wanted.insert(self.wanted.end(), more.begin(), more.end());
    return present;
  });
}

const std::string& Writer::suite_name() const { return impl_->registered.suite_name; }
const std::string& Writer::controller_name(std::size_t point) const {
  return impl_->registered.controller_names.at(point);
}
std::size_t Writer::committed() const { return impl_->committed; }
std::size_t Writer::forgotten() const { return impl_->forgotten; }

void Writer::add(const Wanted& trial, const WorldRecord& world, const TrialRow& row, const Trace* trace,
                 std::span<const double> metrics) {
  impl_->guarded(StoreError::Kind::kInterrupted, [&] {
    Pending p{trial, hash_from_hex(trial.key), world, row, std::nullopt, {metrics.begin(), metrics.end()}};
    if (trace != nullptr) p.samples = encode_samples(*trace);
    impl_->pending.push_back(std::move(p));
    if (impl_->pending.size() >= kBatchRows || Clock::now() - impl_->last_commit >= kBatchTime) impl_->flush();
  });
}

std::optional<TrialRow> Writer::find(const std::string& key) {
  return impl_->guarded(StoreError::Kind::kInterrupted, [&]() -> std::optional<TrialRow> {
    impl_->flush();
    Statement& s = impl_->sql->find_trial;
    s.reset();
    bind_cell(s, 1, hash_from_hex(key));
    if (!s.executeStep()) return std::nullopt;
    TrialRow row = read_record<TrialRow>(s, 1);
    s.reset();
    return row;
  });
}

SQLite::Database& Writer::database() { return impl_->db; }

void Writer::flush() {
  impl_->guarded(StoreError::Kind::kInterrupted, [&] { impl_->flush(); });
}

void Writer::finish(RunStatus status) {
  impl_->guarded(StoreError::Kind::kInterrupted, [&] {
    impl_->flush();
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    impl_->link_present(impl_->wanted);
    Statement s(impl_->db, "UPDATE invocation SET status = ?, ended = ? WHERE id = ?");
    s.bind(1, std::string(to_string(status)));
    s.bind(2, utc_now());
    s.bind(3, impl_->invocation);
    s.exec();
    transaction.commit();
  });
}

void Writer::fail() noexcept {
  try {
    if (impl_ != nullptr && impl_->invocation != 0) finish(RunStatus::kFailed);
  } catch (...) {  // the store cannot be written any more: it says "running", and nobody holds its lock
  }
}

std::vector<std::string> Writer::close_killed() {
  return impl_->guarded(StoreError::Kind::kInterrupted, [&] {
    SQLite::Database& db = impl_->db;
    std::vector<std::string> started;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    Statement killed(db, "SELECT started FROM invocation WHERE status = ? ORDER BY id");
    killed.bind(1, std::string(to_string(RunStatus::kRunning)));
    while (killed.executeStep()) started.push_back(killed.getColumn(0).getString());
    killed.reset();
    Statement invocations(db, "UPDATE invocation SET status = ? WHERE status = ?");
    invocations.bind(1, std::string(to_string(RunStatus::kFailed)));
    invocations.bind(2, std::string(to_string(RunStatus::kRunning)));
    invocations.exec();
    Statement searches(db, "UPDATE tune_search SET status = ? WHERE status = ?");
    searches.bind(1, std::string(to_string(tune::SearchStatus::kStopped)));
    searches.bind(2, std::string(to_string(tune::SearchStatus::kRunning)));
    searches.exec();
    transaction.commit();
    return started;
  });
}

}  // namespace moma::store
