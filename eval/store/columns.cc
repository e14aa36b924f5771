#include "eval/store/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "controller/describe/equal.h"

namespace moma::store {
namespace {

template <class Record, class Column>
std::vector<Column> collect() {
  std::vector<Column> columns;
  for_members<Record>([&]<class M, class C>(std::string_view name, M C::*member, const moma::Column& about) {
    if constexpr (!std::is_same_v<M, Outcome>) columns.push_back({name, member, about});
  });
  return columns;
}

}  // namespace

const std::vector<TrialColumn>& trial_columns() {
  static const std::vector<TrialColumn> kColumns = collect<TrialRow, TrialColumn>();
  return kColumns;
}

const std::vector<TimingColumn>& timing_columns() {
  static const std::vector<TimingColumn> kColumns = collect<TrialRow::Timing, TimingColumn>();
  return kColumns;
}

const std::vector<TrialColumn>& shown_columns() {
  static const std::vector<TrialColumn> kColumns = [] {
    std::vector<TrialColumn> shown = trial_columns();
    std::erase_if(shown, [](const TrialColumn& column) { return column.about.shown.place == 0; });
    std::ranges::sort(shown, {}, [](const TrialColumn& column) { return column.about.shown.place; });
    return shown;
  }();
  return kColumns;
}

double stored(double value) noexcept { return std::isfinite(value) ? value + 0.0 : kAbsent; }

namespace {

// Value of the column in a row without it.
bool absent(double value) noexcept { return std::isnan(value); }
bool absent(int value) noexcept { return value == 0; }
bool absent(const std::string& value) noexcept { return value.empty(); }

}  // namespace

bool agree(const Column& about, double a, double b) {
  return same(stored(a), stored(b)) || (about.earlier == Earlier::kUnknown && absent(stored(a)));
}
template <class Value>
bool agree(const Column& about, const Value& a, const Value& b) {
  return a == b || (about.earlier == Earlier::kUnknown && absent(a));
}
template bool agree(const Column&, const int&, const int&);

std::vector<std::string_view> missing_columns(const TrialRow& stored, const TrialRow& now) {
  std::vector<std::string_view> names;
  for (const TrialColumn& column : trial_columns()) {
    const auto missing = [&](auto member) { return absent(stored.*member) && !absent(now.*member); };
    if (column.about.earlier == Earlier::kUnknown && std::visit(missing, column.member)) names.push_back(column.name);
  }
  return names;
}

std::vector<std::string> differences(const TrialRow& a, const TrialRow& b) {
  std::vector<std::string> found;
  if (a.outcome != b.outcome) {
    found.push_back(fmt::format("outcome: {} != {}", to_string(a.outcome), to_string(b.outcome)));
  }
  for (const TrialColumn& column : trial_columns()) {
    std::visit(
        [&](auto member) {
          if (!agree(column.about, a.*member, b.*member)) {
            found.push_back(fmt::format("{}: {} != {}", column.name, a.*member, b.*member));
          }
        },
        column.member);
  }
  return found;
}

}  // namespace moma::store
