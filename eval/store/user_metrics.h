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

/// A suite's own metrics: aggregate SQL expressions over the samples of one trial, e.g. "max(abs(command0))". The
/// columns are those of samples('TRIAL'), NULL for values that are not finite.
class UserMetrics {
 public:
  /// `metrics`: name, expression. `q`, `v`: sizes of Sample::q and Sample::qdot. Throws MetricError.
  UserMetrics(std::vector<std::pair<std::string, std::string>> metrics, Eigen::Index q, Eigen::Index v);
  ~UserMetrics();
  UserMetrics(const UserMetrics&) = delete;
  UserMetrics& operator=(const UserMetrics&) = delete;

  /// One value per metric; NaN for NULL, a text, an SQL error, or more than ten million of SQLite's steps. Thread-safe.
  /// About 2 us per sample. Throws std::bad_alloc.
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
