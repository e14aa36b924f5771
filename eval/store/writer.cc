#include "eval/store/writer.h"

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <SQLiteCpp/Statement.h>
#include <SQLiteCpp/Transaction.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "eval/search/variables.h"
#include "eval/store/columns.h"
#include "eval/store/database.h"
#include "eval/store/definition.h"
#include "eval/store/machine.h"
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

/// Prepared once.
struct Statements {
  explicit Statements(SQLite::Database& db)
      : worlds(db, "world", {"id"}),
        trials(db, "trial", {"key", "world_id"}),
        executions(db, "execution", {"key", "invocation_id"}),
        samples(db, "samples", {"key"}),
        metric_values(db, "metric_value", {"metric_id", "key"}),
        find_world(db, "SELECT id FROM world WHERE hash = ?"),
        link(db, fmt::format("INSERT INTO point_trial (point_id, world_index, key, world_id, family, outcome, "
                             "time_to_goal_s, {}) SELECT ?1, ?2, t.key, t.world_id, w.family, t.outcome, "
                             "t.time_to_goal_s, {} FROM trial AS t JOIN world AS w ON w.id = t.world_id "
                             "WHERE t.key = ?3 ON CONFLICT (point_id, world_index) DO NOTHING",
                             summary_list(), summary_list("t."))),
        find_trial(db, fmt::format("SELECT i.machine_class, {} FROM trial AS t LEFT JOIN execution AS e USING (key) "
                                   "LEFT JOIN invocation AS i ON i.id = e.invocation_id WHERE t.key = ?",
                                   column_names<TrialRow>("t."))),
        done(db, "UPDATE invocation SET trials_done = ? WHERE id = ?") {}
  Table<WorldRecord> worlds;
  Table<TrialRow> trials;
  Table<TrialRow::Timing> executions;
  Table<EncodedSamples> samples;
  Table<MetricValueRow> metric_values;
  Statement find_world, link, find_trial, done;

  /// The row with this key, and the class of the machine that computed it.
  auto find(const Hash& key) { return store::row<std::optional<std::string>, TrialRow>(find_trial, key); }
};

}  // namespace

struct Writer::Impl {
  fs::path file;
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

  explicit Impl(const fs::path& path) : file(path), db(open_database(path, Access::kCreate)) {}

  std::int64_t world_id(const WorldRecord& world) {
    const auto id = store::row<std::int64_t>(sql->find_world, world.hash);
    return id ? *id : sql->worlds.insert(world);
  }

  void insert(const Pending& p) {
    if (sql->trials.insert_new(p.row, p.key, world_id(p.world))) {
      sql->executions.insert(p.row.timing, p.key, invocation);
    } else {
      check_same(p);
    }
    if (p.samples) sql->samples.insert_new(*p.samples, p.key);
    for (std::size_t i = 0; i < std::min(p.metrics.size(), metrics.size()); ++i)
      sql->metric_values.insert_new({p.metrics[i]}, metrics[i], p.key);
    if (p.trial.point != kNoPoint) link(p.trial, p.key);
  }

  void link(const Wanted& trial, const Hash& key) {
    execute(sql->link, registered.point_ids.at(trial.point), trial.world, key);
  }

  /// The key is there already: the rows must agree, unless the machines are of different classes.
  void check_same(const Pending& p) {
    const auto there = sql->find(p.key);
    if (!there) return;
    const auto& [machine_class, row] = *there;
    const bool same_class = !machine_class || *machine_class == machine.machine_class;
    const std::vector<std::string> found = differences(row, p.row);
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
    static_cast<Machine&>(row) = machine;
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
    row.threads = info.threads;
    row.trials_planned = wanted.size();
    invocation = Table<InvocationRow>(db, "invocation", {"id"}).insert(row);
  }

  /// Links every wanted trial that is stored; returns their keys.
  std::unordered_set<std::string> link_present(std::span<const Wanted> trials) {
    std::unordered_set<std::string> present;
    Statement find(db, fmt::format("SELECT (SELECT count(*) FROM metric_value AS v WHERE v.key = t.key AND "
                                   "v.metric_id IN ({})) FROM trial AS t WHERE t.key = ?",
                                   fmt::join(metrics, ", ")));
    for (const Wanted& trial : trials) {
      const Hash key = hash_from_hex(trial.key);
      const auto values = store::row<std::size_t>(find, key);
      if (!values) continue;
      if (*values == metrics.size()) present.insert(trial.key);
      link(trial, key);
    }
    return present;
  }

  void flush() {
    if (pending.empty()) return;
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    for (const Pending& p : pending) insert(p);
    execute(sql->done, committed + pending.size(), invocation);
    transaction.commit();
    committed += pending.size();
    pending.clear();
    last_commit = Clock::now();
  }

  /// After a failure the waiting rows cannot be written any more.
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

Writer::Writer(const fs::path& file) : impl_(std::make_unique<Impl>(file)) {
  impl_->guarded(StoreError::Kind::kUnusable, [this] {
    impl_->fresh = count(impl_->db, "SELECT count(*) FROM suite") == 0;
    impl_->forgotten = forget_late(impl_->db);
  });
}

Writer::~Writer() {
  if (impl_ == nullptr) return;
  try {
    impl_->flush();
  } catch (...) {  // stack unwinding after another failure: committed rows stay
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
    execute(self.db, "UPDATE invocation SET trials_present = ? WHERE id = ?", present.size(), self.invocation);
    transaction.commit();
    return present;
  };
  try {
    return impl_->guarded(StoreError::Kind::kUnusable, work);
  } catch (...) {
    if (impl_->fresh) {  // leave no store without content behind
      const fs::path file = impl_->file;
      impl_.reset();
      remove_store(file);
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
    execute(
        self.db,
        "UPDATE invocation SET trials_planned = trials_planned + ?, trials_present = trials_present + ? WHERE id = ?",
        more.size(), present.size(), self.invocation);
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
    p.world.hash = hash_text(world.json);
    if (trace != nullptr) p.samples = encode_samples(*trace);
    impl_->pending.push_back(std::move(p));
    if (impl_->pending.size() >= kBatchRows || Clock::now() - impl_->last_commit >= kBatchTime) impl_->flush();
  });
}

std::optional<TrialRow> Writer::find(const std::string& key) {
  return impl_->guarded(StoreError::Kind::kInterrupted, [&]() -> std::optional<TrialRow> {
    impl_->flush();
    auto found = impl_->sql->find(hash_from_hex(key));
    return found ? std::optional(std::get<TrialRow>(std::move(*found))) : std::nullopt;
  });
}

SQLite::Database& Writer::database() { return impl_->db; }

void Writer::keep_risk(const std::string& json) {
  impl_->guarded(StoreError::Kind::kInterrupted,
                 [&] { execute(impl_->db, "UPDATE invocation SET risk = ? WHERE id = ?", json, impl_->invocation); });
}

void Writer::flush() {
  impl_->guarded(StoreError::Kind::kInterrupted, [&] { impl_->flush(); });
}

void Writer::finish(RunStatus status) {
  impl_->guarded(StoreError::Kind::kInterrupted, [&] {
    impl_->flush();
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    impl_->link_present(impl_->wanted);
    execute(impl_->db, "UPDATE invocation SET status = ?, ended = ? WHERE id = ?", status, utc_now(),
            impl_->invocation);
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
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    std::vector<std::string> started =
        rows<std::string>(db, "SELECT started FROM invocation WHERE status = ? ORDER BY id", RunStatus::kRunning);
    execute(db, "UPDATE invocation SET status = ? WHERE status = ?", RunStatus::kFailed, RunStatus::kRunning);
    execute(db, "UPDATE tune_search SET status = ? WHERE status = ?", tune::SearchStatus::kStopped,
            tune::SearchStatus::kRunning);
    transaction.commit();
    return started;
  });
}

}  // namespace moma::store
