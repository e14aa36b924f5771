#pragma once

#include <SQLiteCpp/Statement.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/config/paths.h"
#include "eval/store/database.h"
#include "eval/store/samples.h"
#include "eval/trial/row.h"

namespace moma::store {

/// A row of table point, with the data to build it again: it is number `position` of
/// suite_from_resolved(resolved_suite).points.
struct StoredPoint {
  std::int64_t id = 0;
  std::string suite;  ///< as shown
  std::string controller;
  std::string label;
  std::string resolved_suite;  ///< JSON
  std::size_t position = 0;
  int simulation_version = 0;
};

constexpr void describe(auto& v, Of<StoredPoint>) {
  using T = StoredPoint;
  v.member("id", &T::id, Field{});
  v.member("suite", &T::suite, Field{});
  v.member("controller", &T::controller, Field{});
  v.member("label", &T::label, Field{});
  v.member("resolved_suite", &T::resolved_suite, Field{});
  v.member("position", &T::position, Field{});
  v.member("simulation_version", &T::simulation_version, Field{});
}

/// A trial with the data for a replay.
struct StoredTrial : StoredPoint {
  std::string key;  ///< 32 hex digits
  std::uint64_t world_index = 0;
  std::string world;          ///< JSON
  std::string machine_class;  ///< of the computer that computed it
  TrialRow row;               ///< without timings
  std::optional<EncodedSamples> samples = {};
};

/// A value of a metric that a suite defined itself.
struct StoredMetric {
  std::string name;
  std::string expression;
  double value = 0.0;  ///< NaN: NULL
};

/// A trial of a point.
struct PointTrial {
  std::uint64_t world_index = 0;
  std::string key;  ///< 32 hex digits
};

struct PointRecord;
struct StoredSearch;  // eval/store/search_tables.h

/// A trial without its point, or of a search.
struct LoneTrial {
  TrialRow row;               ///< without timings
  std::string world;          ///< JSON
  std::string machine_class;  ///< of the invocation that computed it
};

/// Reads a store; any number of readers beside the writer. Throws StoreError.
class Reader {
 public:
  explicit Reader(const fs::path& file) : file_(file), connection_(file) {}

  /// The trial whose key begins with `prefix` (hex digits, any case). Throws kNotFound if none or several do.
  StoredTrial trial(const std::string& prefix) const;
  /// Samples of the trial with this key (32 hex digits), if they are there.
  std::optional<EncodedSamples> samples(const std::string& key) const;
  /// Keys of all trials that belong to a point, in order of the key.
  std::vector<std::string> keys() const;
  /// The suite shown as `name`, resolved for its latest invocation, JSON. Throws kNotFound with the names.
  std::string latest_suite(const std::string& name) const;
  /// Names of the suites, as shown, in the order of their addition.
  std::vector<std::string> suite_names() const;
  /// Values of the suites' own metrics of the trial with this key (32 hex digits).
  std::vector<StoredMetric> metrics(const std::string& key) const;
  std::vector<StoredPoint> points() const;
  std::vector<PointTrial> trials_of(std::int64_t point) const;
  /// Names of the columns in which a point differs from `said`; "" if none.
  std::string point_differences(std::int64_t point, const PointRecord& said) const;
  /// Start times of the runs with status `running`.
  std::vector<std::string> running() const;
  /// Keys of the trials that belong to no point, those of searches, in order.
  std::vector<std::string> searched_keys() const;
  /// Keys of the trials of the suite shown under `name`, in order.
  std::vector<std::string> keys_of_suite(const std::string& name) const;
  /// Ids of the searches (moma tune).
  std::vector<std::int64_t> searches() const;
  StoredSearch search(std::int64_t id) const;
  /// The trial with this key (32 hex digits), if it is there.
  std::optional<LoneTrial> lone_trial(const std::string& key) const;
  /// Robots as resolved, JSON.
  std::vector<std::string> robots() const;
  /// Findings of SQLite's integrity and foreign key checks.
  std::vector<std::string> integrity_problems() const;
  /// Hash over all deterministic columns of all trials in order of the key, 32 hex digits.
  std::string result_hash() const;

 private:
  SQLite::Database& db() const { return connection_.db(); }
  /// Does `work`; an exception of SQLite, and a key or a word that no moma writes, becomes a StoreError.
  template <class Work>
  auto guarded(const Work& work) const;
  /// All rows of a query, as R{T...}; or as one T each.
  template <class R, class... T, class... A>
  std::vector<R> all_as(const std::string& sql, const A&... values) const;
  template <class T, class... A>
  std::vector<T> all(const std::string& sql, const A&... values) const;
  std::string full_key(const std::string& prefix) const;

  fs::path file_;
  mutable ReadConnection connection_;
  mutable std::optional<SQLite::Statement> trial_, samples_, lone_;  ///< of what is asked often
};

}  // namespace moma::store
