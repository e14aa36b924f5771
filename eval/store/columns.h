#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "eval/trial/row.h"

namespace moma::store {

/// One column of table `trial` or `execution` and the member that it holds.
struct TrialColumn {
  const char* name;
  std::variant<double TrialRow::*, int TrialRow::*, std::string TrialRow::*> member;
};
struct TimingColumn {
  const char* name;
  std::variant<double TrialRow::Timing::*, int TrialRow::Timing::*> member;
};

/// All deterministic columns but `outcome`, in the order of schema.sql.
std::span<const TrialColumn> trial_columns() noexcept;
std::span<const TimingColumn> timing_columns() noexcept;

/// Throws std::invalid_argument where `text` is no outcome.
Outcome outcome_from_string(const std::string& text);

/// A number as the store keeps it: infinities become absent (NaN), -0 becomes 0.
double stored(double value) noexcept;

/// "column: a != b" for every deterministic column whose bits differ after storing; empty where the rows agree.
std::vector<std::string> differences(const TrialRow& a, const TrialRow& b);

}  // namespace moma::store
