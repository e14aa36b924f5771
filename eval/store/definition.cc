#include "eval/store/definition.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "controller/case/plan_words.h"
#include "controller/config/json.h"
#include "controller/describe/complete.h"
#include "eval/store/columns.h"
#include "eval/store/rows.h"
#include "eval/store/samples.h"
#include "eval/store/search_tables.h"

namespace moma::store {

extern const char* const kSchemaSql;
extern const char* const kViewsSql;

namespace {

static_assert(is_complete<Difficulty>(), "a member of Difficulty without its line in describe()");

static_assert(
    [] {
      bool only = true;
      for_members<TrialRow>([&](std::string_view name, auto, const Column& about) {
        only = only && about.shown.median == (name == "time_to_goal_s" ? "time_to_goal_median_s" : "");
      });
      return only;
    }(),
    "views.sql has one median, that of time_to_goal_s");

/// A line of CREATE TABLE for each column, with the column's description as a comment.
std::string column_lines(std::string_view table, bool ends_table) {
  const auto& all = described_tables();
  const auto found = std::ranges::find_if(all, [&](const auto& t) { return t.first == table; });
  if (found == all.end()) return "";
  std::string lines;
  for (const ColumnDefinition& c : found->second) {
    const bool last = ends_table && &c == &found->second.back();
    const std::string code = fmt::format("{} {}{}", c.name, c.type, last ? "" : ",");
    lines += (lines.empty() ? "" : "\n  ") + (c.text.empty() ? code : fmt::format("{:<57} -- {}", code, c.text));
  }
  return lines;
}

/// "text(COLUMN)" of each of the summary's columns, apart by commas.
std::string of_summary(const std::function<std::string(std::string_view)>& text) {
  std::string list;
  for (const TrialColumn& column : trial_columns())
    if (column.about.averaged()) list += (list.empty() ? "" : ", ") + text(column.name);
  return list;
}

template <class TableColumn>
std::string view_lines(const std::vector<TableColumn>& columns, std::string_view table) {
  std::string lines;
  for (const TableColumn& column : columns)
    if (column.about.in_view)
      lines += fmt::format("{}{}.{} AS {}", lines.empty() ? "" : ",\n       ", table, column.name, column.name);
  return lines;
}

/// The text with each {{NAME}} replaced.
std::string filled(std::string text) {
  const std::pair<const char*, std::string (*)()> parts[] = {
      {"summary columns", [] { return of_summary([](auto name) { return fmt::format("{} REAL", name); }); }},
      {"summary index", &summary_index_sql},
      {"trial view", [] { return view_lines(trial_columns(), "t"); }},
      {"timing view", [] { return view_lines(timing_columns(), "e"); }},
      {"summary means", [] { return of_summary([](auto name) { return fmt::format("avg({0}) AS {0}", name); }); }},
      {"summary view", [] { return of_summary([](auto name) { return fmt::format("c.{0} AS {0}", name); }); }},
  };
  for (std::size_t at = text.find("{{"); at != std::string::npos; at = text.find("{{", at)) {
    const std::size_t end = text.find("}}", at);
    const std::string name = text.substr(at + 2, end - at - 2);
    const auto part = std::find_if(std::begin(parts), std::end(parts), [&](const auto& p) { return p.first == name; });
    constexpr std::string_view kColumns = "columns of ";
    std::string value;
    if (part != std::end(parts)) {
      value = part->second();
    } else if (name.starts_with(kColumns)) {
      const std::size_t next = text.find_first_not_of(" \n", end + 2);
      value = column_lines(name.substr(kColumns.size()), next != std::string::npos && text[next] == ')');
    }
    if (end == std::string::npos || value.empty())
      throw std::logic_error("the definition of the store has an unknown part {{" + name);
    text.replace(at, end + 2 - at, value);
    at += value.size();
  }
  return text;
}

/// The columns of R's table. Later columns stand last: a new table then equals an old one to which they were added.
template <class R>
std::vector<ColumnDefinition> in_table() {
  std::vector<ColumnDefinition> columns = definitions<R>();
  std::ranges::stable_partition(columns, [](const ColumnDefinition& c) { return !c.later; });
  return columns;
}

/// "manipulability, mean" -> "mean manipulability".
std::string mean_of(std::string_view label) {
  constexpr std::string_view kMean = ", mean";
  if (label.ends_with(kMean)) label.remove_suffix(kMean.size());
  return fmt::format("mean {}", label);
}

/// Adds the metrics among the members of R. `of`: whose they are.
template <class R>
void add_metrics(Json& list, std::string_view of) {
  for_members<R>([&](std::string_view name, auto, const Column& about) {
    if (about.label.empty()) return;
    Json metric = {
        {"key", name}, {"of", of}, {"name", about.label}, {"unit", about.unit}, {"better", to_string(about.better)}};
    if (about.decimals >= 0) {
      metric["decimals"] = about.decimals;
    } else {
      metric["significant"] = about.significant;
    }
    if (!about.head.empty()) metric["head"] = about.head;
    if (about.averaged()) metric["summary"] = {{"column", name}, {"name", mean_of(about.label)}};
    if (!about.shown.median.empty())
      metric["summary"] = {{"column", about.shown.median}, {"name", fmt::format("median {}", about.label)}};
    metric["text"] = about.text;
    list.push_back(std::move(metric));
  });
}

}  // namespace

const std::vector<std::pair<std::string, std::vector<ColumnDefinition>>>& described_tables() {
  static const std::vector<std::pair<std::string, std::vector<ColumnDefinition>>> kTables{
      {"robot", in_table<RobotRow>()},
      {"controller", in_table<ContentRow>()},
      {"resolved_suite", in_table<ContentRow>()},
      {"suite", in_table<SuiteRow>()},
      {"point", in_table<PointRow>()},
      {"world", in_table<WorldRecord>()},
      {"invocation", in_table<InvocationRow>()},
      {"trial", in_table<TrialRow>()},
      {"execution", in_table<TrialRow::Timing>()},
      {"samples", in_table<EncodedSamples>()},
      {"metric", in_table<MetricRow>()},
      {"metric_value", in_table<MetricValueRow>()},
      {"tune_search", in_table<TuneSearchRecord>()},
      {"tune_variable", in_table<TuneVariableRecord>()},
      {"tune_evaluation", in_table<tune::Evaluation>()},
      {"tune_finalist", in_table<tune::Finalist>()},
      {"tune_sensitivity", in_table<TuneSensitivityRecord>()},
      {"tune_comparison", in_table<TuneComparisonRecord>()},
  };
  return kTables;
}

std::string tables_sql() { return filled(kSchemaSql); }

std::vector<std::pair<std::string, std::string>> views() {
  static const auto kViews = [] {
    std::vector<std::pair<std::string, std::string>> all;
    const std::string text = filled(kViewsSql);
    constexpr std::string_view kCreate = "CREATE VIEW ";
    for (std::size_t at = text.find(kCreate); at != std::string::npos; at = text.find(kCreate, at + 1)) {
      const std::size_t name = at + kCreate.size();
      all.emplace_back(text.substr(name, text.find(' ', name) - name), text.substr(at, text.find(';', at) - at));
    }
    return all;
  }();
  return kViews;
}

std::string views_sql() {
  std::string sql;
  for (const auto& [name, statement] : views()) sql += fmt::format("DROP VIEW IF EXISTS {};\n{};\n", name, statement);
  return sql;
}

std::string temporary_views_sql() {
  std::string sql;
  for (const auto& [name, statement] : views())
    sql += fmt::format("CREATE TEMP{};\n", statement.substr(statement.find(" VIEW")));
  return sql;
}

std::string query_of_overall() {
  const auto& all = views();
  const auto found = std::ranges::find_if(all, [](const auto& view) { return view.first == "v_summary"; });
  constexpr std::string_view kWith = "WITH ", kFrom = "FROM point_trial\n";
  // The same statement over trials whose families are one.
  std::string sql = found->second.substr(found->second.find(kWith) + kWith.size());
  for (std::size_t at = 0; (at = sql.find(kFrom, at)) != std::string::npos;)
    sql.replace(at, kFrom.size(), "FROM whole\n");
  return fmt::format(
      "WITH whole AS (SELECT point_id, '' AS family, outcome, time_to_goal_s, {} FROM point_trial),\n{}\n"
      "ORDER BY s.id, p.id",
      summary_list(), sql);
}

std::string summary_index_sql() {
  return fmt::format(
      "DROP INDEX IF EXISTS point_trial_summary;\n"
      "CREATE INDEX point_trial_summary ON point_trial (point_id, family, time_to_goal_s, outcome, {});",
      summary_list());
}

std::string summary_list(const std::string& prefix) {
  return of_summary([&](std::string_view name) { return fmt::format("{}{}", prefix, name); });
}

std::string json_of_metrics() {
  Json list = Json::array();
  add_metrics<TrialRow>(list, "trial");
  add_metrics<Difficulty>(list, "world");
  add_metrics<TrialRow::Timing>(list, "machine");
  return list.dump();
}

std::string json_of_samples() {
  const auto meanings = []<class Enum>(Of<Enum>) {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < words(Of<Enum>{}).size(); ++i) list.push_back(meaning(static_cast<Enum>(i)));
    return list;
  };
  return nlohmann::json{{"status", words(Of<StepStatus>{})},
                        {"fallback", words(Of<Fallback>{})},
                        {"plan_mode", meanings(Of<PlanMode>{})},
                        {"plan_reason", meanings(Of<PlanReason>{})}}
      .dump();
}

std::string json_of_outcomes() { return nlohmann::json(words(Of<Outcome>{})).dump(); }

}  // namespace moma::store
