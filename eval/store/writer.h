#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "eval/store/error.h"
#include "eval/store/records.h"
#include "eval/store/rows.h"
#include "eval/trial/row.h"

namespace SQLite {
class Database;
}

namespace moma::store {

struct InvocationInfo {
  std::vector<std::string> arguments;  ///< the command line
  int threads = 1;
};

/// The point of a trial of a search (`moma tune`): the trial is stored and found by its key like any other, but views
/// do not show it.
inline constexpr std::size_t kNoPoint = static_cast<std::size_t>(-1);

/// A trial that the run asks for.
struct Wanted {
  std::size_t point = 0;
  std::uint64_t world = 0;
  std::string key;  ///< 32 hex digits
};

/// The one writer of a store during a run. It commits rows in transactions of up to 64 rows or 20 ms; a kill loses at
/// most those. Not thread-safe. All methods throw StoreError: kUnusable from the constructor and begin(), later
/// kInterrupted (also if the store is locked) and kContradiction.
class Writer {
 public:
  /// Opens or makes the store.
  explicit Writer(const fs::path& file);
  /// Writes pending rows if possible.
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Records suite, points and this invocation, links the wanted trials that are stored, and returns the keys of those
  /// that are complete with the suite's own metrics.
  std::unordered_set<std::string> begin(const SuiteRecord& suite, const InvocationInfo& info,
                                        const std::vector<Wanted>& wanted);

  /// Does the same for further trials, after begin().
  std::unordered_set<std::string> extend(const std::vector<Wanted>& wanted);

  /// Name of the suite as the views show it, with @2 where the setting changed under the same name; likewise the
  /// controller of a point.
  const std::string& suite_name() const;
  const std::string& controller_name(std::size_t point) const;

  /// Adds a result; `trace` null: samples are not kept. A key that is already there is not written again; within
  /// the same machine class a different row is a contradiction.
  /// `metrics`: values of the suite's own, in its order; NaN is NULL.
  void add(const Wanted& trial, const WorldRecord& world, const TrialRow& row, const Trace* trace,
           std::span<const double> metrics = {});

  /// The stored row of this key (without timings), whatever run it came from.
  std::optional<TrialRow> find(const std::string& key);

  /// For other tables of the same store (eval/store/tuning.h); after begin().
  SQLite::Database& database();

  /// Keeps the estimates of `moma risk` with this invocation.
  void keep_risk(const std::string& json);

  /// Commits the rows that wait for a transaction.
  void flush();

  /// Links trials shared by several points, and closes the invocation's record.
  void finish(RunStatus status);

  /// Calls finish(RunStatus::kFailed) during another error, and ignores its own errors.
  void fail() noexcept;

  /// Marks invocations that still have the status `running` as failed, and returns when they began. Call it under the
  /// store's lock and before begin(): nobody else writes then, so that these runs were killed.
  std::vector<std::string> close_killed();

  /// Rows committed by this writer.
  std::size_t committed() const;
  /// Trials that the constructor removed, so that they are tried again (eval/store/database.h).
  std::size_t forgotten() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace moma::store
