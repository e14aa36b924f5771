#include "eval/cli/summary_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "eval/store/columns.h"
#include "reports/render/own_metrics.h"

namespace moma::cli {
namespace {

using store::Cell;
using store::QueryResult;
using Row = std::vector<Cell>;

// Rates and errors in the form for a person; a missing value stays empty.
constexpr const char* kRatesForPerson = R"(,
  printf('%5.1f  [%5.1f, %5.1f]', 100 * success_rate, 100 * success_low, 100 * success_high)
    AS "success % [95 %]",
  iif(success_without_errors IS NULL, NULL, printf('%5.1f', 100 * success_without_errors)) AS "without errors %",
  printf('%4.1f  [%4.1f, %4.1f]', 100 * collision_rate, 100 * collision_low, 100 * collision_high)
    AS "collision % [95 %]")";

/// Further columns in the form for a person. They replace the columns from kRates on.
std::string for_person_sql() {
  std::string sql = kRatesForPerson;
  for (const store::TrialColumn& column : store::shown_columns()) {
    const Shown& shown = column.about.shown;
    if (shown.summary.empty()) continue;
    sql += fmt::format(", iif({0} IS NULL, NULL, printf('%.{1}f', {0})) AS \"{2}\"",
                       shown.median.empty() ? column.name : shown.median,
                       column.about.decimals < 0 ? column.about.significant : column.about.decimals, shown.summary);
  }
  return sql;
}

constexpr const char* kFirstForPerson = "success % [95 %]";
constexpr const char* kWithoutErrors = "without errors %";

constexpr std::size_t kNames = 6;  // suite, robot, controller, point, family, mode: what v_summary begins with
constexpr std::size_t kRobot = 1, kErrors = 7, kRates = 8;

/// The suites' own metrics, as further columns of the rows.
void add_own(const fs::path& file, QueryResult& table) {
  const std::vector<reports::OwnMetric> own = reports::own_metrics(file, {table.columns.begin(), table.columns.end()});
  if (own.empty()) return;
  std::map<Row, std::map<std::string, Cell>> means;
  for (Row& row : store::query(file,
                               "SELECT suite, robot, controller, point, family, mode, metric, mean FROM "
                               "v_metric_summary")
                      .rows) {
    const std::string metric = std::get<std::string>(row[kNames]);
    Cell mean = std::move(row[kNames + 1]);
    row.resize(kNames);
    means[std::move(row)][metric] = std::move(mean);
  }
  for (const reports::OwnMetric& metric : own) table.columns.push_back(metric.column);
  for (Row& row : table.rows) {
    const auto& of_row = means[Row(row.begin(), row.begin() + kNames)];
    for (const reports::OwnMetric& metric : own) {
      const auto found = of_row.find(metric.name);
      row.push_back(found == of_row.end() ? Cell{} : found->second);
    }
  }
}

void keep_columns(QueryResult& table, const std::vector<std::size_t>& kept) {
  const auto chosen = [&](auto& from) {
    std::remove_reference_t<decltype(from)> to;
    for (const std::size_t column : kept) to.push_back(std::move(from[column]));
    from = std::move(to);
  };
  chosen(table.columns);
  for (Row& row : table.rows) chosen(row);
}

/// Formats an answer for a person, in which the suites' own metrics begin at column `own`.
std::vector<std::size_t> columns_for_person(QueryResult& table, std::size_t own) {
  const auto any = [&](const auto& holds) { return std::ranges::any_of(table.rows, holds); };
  const bool errors = any([&](const Row& row) { return store::number_in(row[kErrors]).value_or(0.0) > 0.0; });
  std::vector<std::size_t> kept;
  for (std::size_t column = 0; column < kRates; ++column) {
    if (column == kRobot && !any([&](const Row& row) { return row[column] != table.rows.front()[column]; })) continue;
    if (column == kErrors && !errors) continue;
    kept.push_back(column);
  }
  const auto first = std::ranges::find(table.columns, kFirstForPerson);
  for (auto column = static_cast<std::size_t>(first - table.columns.begin()); column < own; ++column)
    if (errors || table.columns[column] != kWithoutErrors) kept.push_back(column);
  for (std::size_t column = own; column < table.columns.size(); ++column) {
    if (!any([&](const Row& row) { return store::number_in(row[column]).has_value(); })) continue;  // of another suite
    kept.push_back(column);
    for (Row& row : table.rows)
      if (const auto mean = store::number_in(row[column])) row[column] = fmt::format("{:.4g}", *mean);
  }
  return kept;
}

}  // namespace

QueryResult summary_table(const fs::path& file, const std::string& suite, bool for_person) {
  const std::string where = suite.empty() ? "" : fmt::format(" WHERE suite = {}", store::sql_literal(suite));
  // All at once, since a run may add to the store meanwhile.
  QueryResult table = store::query(
      file, fmt::format("SELECT *{} FROM v_summary{} ORDER BY suite, robot, family, mode, controller, point",
                        for_person ? for_person_sql() : "", where));
  const std::size_t own = table.columns.size();
  add_own(file, table);
  if (for_person) keep_columns(table, columns_for_person(table, own));
  return table;
}

}  // namespace moma::cli
