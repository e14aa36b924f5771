#include "eval/store/definition.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "controller/describe/complete.h"
#include "eval/search/words.h"
#include "eval/store/difficulty.h"
#include "eval/store/words.h"
#include "world/plant/plant.h"

namespace moma::store {

extern const char* const kSchemaSql;
extern const char* const kViewsSql;

namespace {

static_assert(is_complete<Difficulty>(), "a member of Difficulty without its line in describe()");

std::string type_name(double /*value*/, const Column& about) { return about.always ? "REAL NOT NULL" : "REAL"; }
std::string type_name(int /*value*/, const Column& about) {
  switch (about.earlier) {
    case Earlier::kNone:
      return "INTEGER NOT NULL";
    case Earlier::kZero:
      return "INTEGER NOT NULL DEFAULT 0";
    case Earlier::kUnknown:
      return "INTEGER";
  }
  return "";
}
std::string type_name(const std::string& /*value*/, const Column& /*about*/) { return "TEXT"; }

template <class M, class C>
M value_type(M C::*);

template <class TableColumn>
std::string type_of_any(const TableColumn& column) {
  return std::visit([&](auto member) { return type_name(decltype(value_type(member)){}, column.about); },
                    column.member);
}

/// A line of CREATE TABLE for each column, with what is said of it. What came later stands last, as it does where it
/// was added to a table that was there.
template <class TableColumn>
std::string table_lines(const std::vector<TableColumn>& columns) {
  std::vector<TableColumn> ordered = columns;
  std::stable_partition(ordered.begin(), ordered.end(),
                        [](const TableColumn& c) { return c.about.earlier != Earlier::kUnknown; });
  std::string lines;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    const TableColumn& c = ordered[i];
    const std::string code = fmt::format("{} {}{}", c.name, type_of(c), i + 1 < ordered.size() ? "," : "");
    lines += fmt::format("{}{:<57} -- {}{}", i == 0 ? "" : "\n  ", code,
                         c.about.unit.empty() ? "" : fmt::format("[{}] ", c.about.unit), c.about.text);
  }
  return lines;
}

struct DifficultyColumns {
  std::string lines;
  template <class M>
  void member(std::string_view name, M Difficulty::*, const Column& about) {
    lines += fmt::format("{}{} {},", lines.empty() ? "" : "\n  ", name, type_name(M{}, about));
  }
};

std::string difficulty_lines() {
  DifficultyColumns columns;
  describe(columns, Of<Difficulty>{});
  return columns.lines;
}

/// "text(COLUMN)" of each of the summary's columns, apart by commas.
std::string of_summary(const std::function<std::string(std::string_view)>& text) {
  std::string list;
  for (const TrialColumn& column : trial_columns())
    if (column.about.summary) list += (list.empty() ? "" : ", ") + text(column.name);
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

template <Worded E>
std::string quoted() {
  return list_of_words<E>(", ", "'");
}

/// The text with each {{NAME}} replaced.
std::string filled(std::string text) {
  const std::pair<const char*, std::string (*)()> parts[] = {
      {"trial columns", [] { return table_lines(trial_columns()); }},
      {"timing columns", [] { return table_lines(timing_columns()); }},
      {"difficulty columns", &difficulty_lines},
      {"summary columns", [] { return of_summary([](auto name) { return fmt::format("{} REAL", name); }); }},
      {"summary index", &summary_index_sql},
      {"trial view", [] { return view_lines(trial_columns(), "t"); }},
      {"timing view", [] { return view_lines(timing_columns(), "e"); }},
      {"summary means", [] { return of_summary([](auto name) { return fmt::format("avg({0}) AS {0}", name); }); }},
      {"summary view", [] { return of_summary([](auto name) { return fmt::format("c.{0} AS {0}", name); }); }},
      {"modes", &quoted<SimulationMode>},
      {"run states", &quoted<RunStatus>},
      {"outcomes", &quoted<Outcome>},
      {"search states", &quoted<tune::SearchStatus>},
      {"verdicts", &quoted<tune::Verdict>},
      {"scales", &quoted<tune::Scale>},
      {"phases", &quoted<tune::Phase>},
  };
  for (std::size_t at = text.find("{{"); at != std::string::npos; at = text.find("{{", at)) {
    const std::size_t end = text.find("}}", at);
    const std::string name = text.substr(at + 2, end - at - 2);
    const auto part = std::find_if(std::begin(parts), std::end(parts), [&](const auto& p) { return p.first == name; });
    if (end == std::string::npos || part == std::end(parts))
      throw std::logic_error("the definition of the store has an unknown part {{" + name);
    const std::string value = part->second();
    text.replace(at, end + 2 - at, value);
    at += value.size();
  }
  return text;
}

class MetricList {
 public:
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::string_view of;  // whose member it is
  template <class M, class C>
  void member(std::string_view name, M C::*, const Column& about) {
    if (about.label.empty()) return;
    nlohmann::ordered_json metric = {
        {"key", name}, {"of", of}, {"name", about.label}, {"unit", about.unit}, {"better", to_string(about.better)}};
    if (about.decimals >= 0) {
      metric["decimals"] = about.decimals;
    } else {
      metric["significant"] = about.significant;
    }
    metric["text"] = about.text;
    list.push_back(std::move(metric));
  }
  template <class M, class C>
  void inlined(M C::*) {}  // timings come last
};

}  // namespace

std::string type_of(const TrialColumn& column) { return type_of_any(column); }
std::string type_of(const TimingColumn& column) { return type_of_any(column); }

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

std::string summary_index_sql() {
  return fmt::format(
      "DROP INDEX IF EXISTS point_trial_summary;\n"
      "CREATE INDEX point_trial_summary ON point_trial (point_id, family, time_to_goal_s, outcome, {});",
      summary_list());
}

std::string summary_list(const std::string& prefix) {
  return of_summary([&](std::string_view name) { return fmt::format("{}{}", prefix, name); });
}

std::string metrics_json() {
  MetricList metrics;
  metrics.of = "trial";
  describe(metrics, Of<TrialRow>{});
  metrics.of = "world";
  describe(metrics, Of<Difficulty>{});
  metrics.of = "machine";
  describe(metrics, Of<TrialRow::Timing>{});
  return metrics.list.dump();
}

std::string outcomes_json() { return nlohmann::json(words(Of<Outcome>{})).dump(); }

}  // namespace moma::store
