#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "eval/store/error.h"
#include "eval/store/writer.h"

namespace moma::store {

// Tables tune_* of the store, in plain values: eval/tune knows what they mean.

struct TuneVariableRecord {
  std::string key;
  double lower = 0.0;
  double upper = 0.0;
  std::string scale;
  double start = 0.0;
  std::optional<double> found;
  std::optional<double> importance;
};

struct TuneSearchRecord {
  std::string suite;
  std::string controller;
  std::string identity;  ///< JSON
  std::string objective;
  std::string unit;
  std::uint64_t budget_trials = 0;
  std::vector<TuneVariableRecord> variables;
};

struct TuneEvaluationRecord {
  std::uint64_t evaluation = 0;
  std::string phase;
  int run = 0;
  std::vector<double> candidate;
  std::uint64_t first_world = 0;
  std::uint64_t worlds = 0;
  bool cut = false;
  bool valid = true;
  double cost = 0.0;
  double merit = 0.0;
  std::vector<double> constraints;
  std::vector<double> measured;  ///< bits are kept
};

struct TuneFinalistRecord {
  std::vector<double> candidate;
  double search_merit = 0.0, merit = 0.0, neighbours = 0.0, robust = 0.0;
  std::uint64_t worlds = 0;
};

struct TuneSensitivityRecord {
  int variable = 0;
  std::optional<int> other;
  std::optional<double> value;
  double change = 0.0, error = 0.0;
  bool valid = true;
};

struct TuneComparisonRecord {
  std::string family, other, metric;
  std::int64_t n = 0;
  double found = 0.0, found_low = 0.0, found_high = 0.0;  ///< NaN: NULL
  double theirs = 0.0, theirs_low = 0.0, theirs_high = 0.0;
  double difference = 0.0, difference_low = 0.0, difference_high = 0.0;
  double p = 0.0;
  std::string verdict;
};

struct TuneResultRecord {
  std::vector<double> found;
  std::vector<double> importance;
  std::uint64_t trials = 0, trials_saved = 0, evaluations_cut = 0;
  std::string runs, notes;  ///< JSON
  std::vector<TuneFinalistRecord> finalists;
  std::vector<TuneSensitivityRecord> sensitivity;
};

/// One search in a store, through the writer that owns the store. Every call is one transaction; results of trials
/// that an evaluation is made of are committed before it. Throws StoreError{kInterrupted}.
class TuneRecords {
 public:
  /// Finds the search with this identity, or adds it.
  TuneRecords(Writer& writer, const TuneSearchRecord& search);

  std::int64_t id() const { return id_; }
  /// Evaluations stored before this object was made.
  std::uint64_t present() const { return present_; }
  std::optional<TuneEvaluationRecord> find(std::uint64_t evaluation);
  void append(const TuneEvaluationRecord& record);
  void stopped();
  /// Replaces what an earlier end of the same search stored.
  void finish(const TuneResultRecord& result);
  void verdict(const std::string& held_out_suite, const std::vector<TuneComparisonRecord>& rows,
               const std::string& overall);

 private:
  Writer& writer_;
  std::int64_t id_ = 0;
  std::uint64_t present_ = 0;
};

}  // namespace moma::store
