#pragma once

#include <array>
#include <string_view>

#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"

namespace moma {

/// The better end of a metric's range, if it has one by itself.
enum class Better { kNeither, kHigh, kLow };
constexpr auto words(Of<Better>) { return std::to_array<std::string_view>({"", "high", "low"}); }

/// Value of rows that were stored before the column existed.
enum class Earlier {
  kNone,     ///< no such rows: the column is as old as the store
  kZero,     ///< 0 for a count, else NULL: the simulation's version was raised with the column
  kUnknown,  ///< NULL: such a row agrees with any newer one, and the store's hash does not change
};

/// The faces that show a metric beside the outcome, in the order of `place`.
struct Shown {
  int place = 0;                  ///< distinct, from 1; 0: nowhere
  std::string_view summary = "";  ///< head in the summary of a run; "": not there
  std::string_view median = "";   ///< column of v_summary with its median, which the summary shows; "": its mean.
                                  ///< One metric has it, since views.sql names it.
  bool compared = false;          ///< by `moma compare`
  bool judged = false;            ///< by the verdict of a search
};

/// Description of a record's column in the store. Numbers of a row are metrics, and everything that shows them uses
/// this description: tables and views of the store, its checks, the wire between processes, the report page, store.md.
struct Column {
  std::string_view label = "";  ///< for axes and table heads: "time to goal"; "": no metric of the report page
  std::string_view unit = "";   ///< SI or `1`; "" without a unit
  Better better = Better::kNeither;
  int decimals = -1;                ///< that the page writes; -1: `significant` digits
  int significant = 3;              ///< digits, where it does not say decimals
  std::string_view null_when = "";  ///< where healthy trials have no value: "unless the trial succeeds"
  bool always = false;              ///< of a number (not a count): never NULL
  std::string_view head = "";       ///< over its column in the page's table of trials; "" has none there
  Shown shown = {};
  bool in_view = true;  ///< a column of v_trials
  Earlier earlier = Earlier::kNone;
  Range range = {};            ///< where files have the number, too
  std::string_view text = "";  ///< one line for the reference, without a full stop

  constexpr Column with_decimals(int digits) const { return set(&Column::decimals, digits); }
  constexpr Column absent(std::string_view when) const { return set(&Column::null_when, when); }
  constexpr Column in_table(std::string_view title) const { return set(&Column::head, title); }
  constexpr Column shown_as(Shown where) const { return set(&Column::shown, where); }
  /// True if point_trial has a copy of it, so that v_summary, which shows its mean, stays quick.
  constexpr bool averaged() const { return !shown.summary.empty() && shown.median.empty(); }
  constexpr Column since(Earlier value) const { return set(&Column::earlier, value); }

  /// For visitors that know no store.
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr operator About() const { return {.unit = unit, .range = range, .text = text}; }

  template <class M>
  constexpr Column set(M Column::*member, M value) const {
    Column changed = *this;
    changed.*member = value;
    return changed;
  }
};

/// A metric of the report page.
constexpr Column metric(std::string_view label, std::string_view unit, Better better, std::string_view text) {
  return {.label = label, .unit = unit, .better = better, .text = text};
}
/// One that is a count.
constexpr Column count_metric(std::string_view label, Better better, std::string_view text) {
  return metric(label, "", better, text).with_decimals(0);
}
/// A duration on the wall clock.
constexpr Column microseconds(std::string_view label, std::string_view text) {
  return metric(label, "µs", Better::kLow, text).with_decimals(1);
}

}  // namespace moma
