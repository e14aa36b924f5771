#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "eval/store/error.h"
#include "eval/store/search_tables.h"
#include "eval/store/writer.h"

namespace moma::store {

/// Adds a search's result to its rows.
void add_result(TuneSearchRecord& search, const tune::SearchResult& result);
void add_result(std::vector<TuneVariableRecord>& variables, const tune::SearchResult& result);
std::vector<TuneSensitivityRecord> sensitivity_records(const tune::Sensitivity& sensitivity);

/// One search in a store, through the writer that owns the store; a search that was killed at any moment goes on from
/// here. Every call is one transaction; it follows the transaction with the trials of its evaluation.
/// Throws StoreError: kInterrupted, or kUnusable for records that no version of moma writes.
class TuneRecords : public tune::EvaluationLog {
 public:
  /// Finds the search with this identity, or adds it.
  TuneRecords(Writer& writer, TuneSearchRecord search, const std::vector<tune::Variable>& variables);

  std::int64_t id() const { return id_; }
  /// Evaluations stored before this object was made.
  std::uint64_t present() const { return present_; }
  std::optional<tune::Evaluation> find(std::uint64_t evaluation) override;
  void append(const tune::Evaluation& evaluation) override;
  void stopped();
  /// Stores the result; replaces the one of an earlier end of the same search.
  void finish(const tune::SearchResult& result);
  /// `held_out`: the worlds, JSON.
  void verdict(const std::string& held_out_suite, const std::string& held_out,
               const std::vector<TuneComparisonRecord>& rows, tune::Verdict overall);

 private:
  Writer& writer_;
  std::int64_t id_ = 0;
  std::uint64_t present_ = 0;
};

}  // namespace moma::store
