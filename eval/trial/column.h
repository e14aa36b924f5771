#pragma once

#include <array>
#include <string_view>

#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"

namespace moma {

/// Which end of a metric is better, where one is by itself.
enum class Better { kNeither, kHigh, kLow };
constexpr auto words(Of<Better>) { return std::to_array<std::string_view>({"", "high", "low"}); }
static_assert(all_worded<Better>());

/// What rows hold that were stored before the column was there.
enum class Earlier {
  kNone,     ///< there are none: the column is as old as the store
  kZero,     ///< 0 for a count, else NULL: the simulation's version was raised with the column
  kUnknown,  ///< NULL: such a row agrees with a newer one whatever that has, and the store's hash stays what it was
};

/// What is said of a column of a record that the store keeps. Numbers of a row are metrics: all that shows them follows
/// from here (tables and views of the store, its checks, the wire between processes, the report page, store.md).
struct Column {
  std::string_view label = "";  ///< for axes and heads of tables: "time to goal"; "" is no metric of the report page
  std::string_view unit = "";   ///< of SI and `1`; "" where it has none
  Better better = Better::kNeither;
  int decimals = -1;                ///< that the page writes; -1: `significant` digits
  int significant = 3;              ///< digits, where it does not say decimals
  std::string_view null_when = "";  ///< where healthy trials have no value: "unless the trial succeeds"
  bool always = false;              ///< of a number (not a count): never NULL
  std::string_view head = "";       ///< over its column in the page's table of trials; "" has none there
  bool summary = false;             ///< copied into point_trial, so that v_summary stays quick; its mean is shown there
  bool in_view = true;              ///< a column of v_trials
  Earlier earlier = Earlier::kNone;
  std::string_view text = "";  ///< one line for the reference, without a full stop

  /// For visitors that want no more.
  constexpr operator About() const { return {.unit = unit, .text = text}; }  // NOLINT(google-explicit-constructor)
};

}  // namespace moma
