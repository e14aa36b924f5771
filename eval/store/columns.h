#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "eval/trial/row.h"

namespace moma::store {

/// One column of table `trial` or `execution` and the member that it holds.
struct TrialColumn {
  std::string_view name;
  std::variant<double TrialRow::*, int TrialRow::*, std::string TrialRow::*> member;
  Column about;
};
struct TimingColumn {
  std::string_view name;
  std::variant<double TrialRow::Timing::*, int TrialRow::Timing::*> member;
  Column about;
};

/// All deterministic columns but `outcome`, as the description of TrialRow lists them (eval/trial/row.h).
const std::vector<TrialColumn>& trial_columns();
const std::vector<TimingColumn>& timing_columns();

/// A number as the store keeps it: infinities become absent (NaN), -0 becomes 0.
double stored(double value) noexcept;

/// Whether two values of a column are the same bits after storing. Of a column that came later, a row without the value
/// agrees with any: it was stored before.
bool agree(const Column& about, double a, double b);
bool agree(const Column& about, int a, int b);
bool agree(const Column& about, const std::string& a, const std::string& b);

/// "column: a != b" for every deterministic column that does not agree; empty where the rows agree.
std::vector<std::string> differences(const TrialRow& a, const TrialRow& b);

/// Columns that came later, of which `stored` has no value and `now` has one.
std::vector<std::string_view> missing_columns(const TrialRow& stored, const TrialRow& now);

}  // namespace moma::store
