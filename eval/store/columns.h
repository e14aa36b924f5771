#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "eval/trial/row.h"

namespace moma::store {

/// A column of table `trial` or `execution`, and its member.
template <class Row>
struct ColumnOf {
  std::string_view name;
  std::variant<double Row::*, int Row::*, std::string Row::*> member;
  Column about;
};
using TrialColumn = ColumnOf<TrialRow>;
using TimingColumn = ColumnOf<TrialRow::Timing>;

/// All deterministic columns except `outcome`, in the order of the description of TrialRow (eval/trial/row.h).
const std::vector<TrialColumn>& trial_columns();
const std::vector<TimingColumn>& timing_columns();
/// The columns of `trial` that are shown beside the outcome, by their place (Shown).
const std::vector<TrialColumn>& shown_columns();

/// Returns a number as the store keeps it: NaN for infinities, 0 for -0.
double stored(double value) noexcept;

/// Returns whether two values of a column have the same bits in the store. In a column that was added later, a missing
/// `a` agrees with any `b`.
bool agree(const Column& about, double a, double b);
template <class Value>
bool agree(const Column& about, const Value& a, const Value& b);

/// Returns "column: a != b" for every deterministic column in which the rows disagree.
std::vector<std::string> differences(const TrialRow& a, const TrialRow& b);

/// Returns the columns added later for which `now` has a value and `stored` has none.
std::vector<std::string_view> missing_columns(const TrialRow& stored, const TrialRow& now);

}  // namespace moma::store
