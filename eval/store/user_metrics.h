#pragma once

#include <Eigen/Core>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "eval/trial/row.h"

namespace moma::store {

/// A metric's SQL that cannot be used: what() has the complaint.
struct MetricError : std::runtime_error {
  MetricError(std::size_t i, const std::string& complaint) : std::runtime_error(complaint), metric(i) {}
  std::size_t metric;  ///< which of them
};

/// A suite's own metrics: each an aggregate SQL expression over the table `samples` of one trial, for instance
/// "max(abs(command0))" or "min(iif(least_distance < 0.05, t, NULL))". Columns as samples('TRIAL')
/// has them, NULL where a value is not finite.
class UserMetrics {
 public:
  /// `metrics`: name, expression. `q`, `v`: sizes of Sample::q and Sample::qdot. Throws MetricError where an expression
  /// is no such SQL.
  UserMetrics(std::vector<std::pair<std::string, std::string>> metrics, Eigen::Index q, Eigen::Index v);
  ~UserMetrics();
  UserMetrics(const UserMetrics&) = delete;
  UserMetrics& operator=(const UserMetrics&) = delete;

  /// One value per metric; NaN for NULL, for what is no number, and where the SQL fails on these samples or takes more
  /// than ten million of SQLite's steps. Throws std::bad_alloc. May be called from many threads. About 2 us per sample.
  std::vector<double> evaluate(const Trace& trace) const;

 private:
  struct Evaluator;
  std::vector<std::pair<std::string, std::string>> metrics_;
  Eigen::Index q_;
  Eigen::Index v_;
  struct Pool;
  std::unique_ptr<Pool> pool_;
};

}  // namespace moma::store
