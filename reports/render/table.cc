#include <fmt/format.h>

#include <cmath>
#include <map>

#include "reports/render/files.h"
#include "reports/render/page_data.h"
#include "reports/render/report.h"

namespace moma::reports {
namespace {

using Json = nlohmann::ordered_json;

/// The written data: rows of the summary and their metrics on the page, moma's and the suites' own.
struct Table {
  std::vector<Json> rows;
  std::vector<Json> metrics;
  bool errors = false;  ///< whether any trial ended by one
};

/// NULL where the row's store does not have the metric.
const Json& own_mean(const Json& row, const std::string& key) {
  static const Json kNone = nullptr;
  return row.contains("own") && row.at("own").contains(key) ? row.at("own").at(key) : kNone;
}

std::string tex_text(const std::string& text) {
  static const std::map<char, std::string> kNamed = {{'~', "asciitilde"}, {'^', "asciicircum"}, {'\\', "backslash"},
                                                     {'<', "less"},       {'>', "greater"},     {'|', "bar"}};
  std::string out;
  for (const char c : text) {
    const auto named = kNamed.find(c);
    if (named != kNamed.end()) {
      out += "\\text" + named->second + "{}";
      continue;
    }
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) out += '\\';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out;
}

constexpr const char* kNone = "--";

/// Half a unit of the last decimal is rounded up, as in the page and in SQL's printf().
std::string percent(const Json& share) {
  return share.is_null() ? kNone : fmt::format("{:.1f}", std::round(1000.0 * share.get<double>()) / 10.0);
}

/// "57.3 (52.9--61.6)".
std::string rate(const Json& row, const std::string& stem) {
  return fmt::format("{} ({}--{})", percent(row.at(stem + "_rate")), percent(row.at(stem + "_low")),
                     percent(row.at(stem + "_high")));
}

/// The value of a metric: with its decimals, or so many significant digits.
std::string value(const Json& row, const Json& metric) {
  const bool own = metric.contains("own");
  const Json& cell = own ? own_mean(row, metric.at("key")) : row.at(metric.at("summary").at("column"));
  if (!cell.is_number()) return kNone;
  if (own) return fmt::format("{:.4g}", cell.get<double>());
  if (metric.contains("decimals")) return fmt::format("{:.{}f}", cell.get<double>(), metric.at("decimals").get<int>());
  return fmt::format("{:#.{}g}", cell.get<double>(), metric.at("significant").get<int>());
}

/// Cells of one row as a person reads them.
std::vector<std::string> cells(const Table& table, const Json& row) {
  const std::string point = row.at("point");
  const std::string who = row.at("controller").get<std::string>() + (point.empty() ? "" : ", " + point);
  std::vector<std::string> all = {tex_text(row.at("family").is_null() ? "all" : row.at("family").get<std::string>()),
                                  tex_text(who), row.at("n").dump()};
  if (table.errors) all.push_back(row.at("errors").dump());
  all.push_back(rate(row, "success"));
  if (table.errors) all.push_back(percent(row.at("success_without_errors")));
  all.push_back(rate(row, "collision"));
  for (const Json& metric : table.metrics) all.push_back(value(row, metric));
  return all;
}

/// Heads of the cells.
std::vector<std::string> heads(const Table& table) {
  std::vector<std::string> all = {"worlds", "controller", "$n$", "success [\\%]", "collision [\\%]"};
  if (table.errors) {
    all.insert(all.begin() + 3, "errors");
    all.insert(all.begin() + 5, "without errors [\\%]");
  }
  for (const Json& metric : table.metrics) {
    const Json& name = metric.contains("own") ? metric.at("name") : metric.at("summary").at("name");
    const std::string unit = tex_text(metric.at("unit"));
    all.push_back(tex_text(name) + (unit.empty() ? "" : " [" + unit + "]"));
  }
  return all;
}

constexpr const char* kMeans = "means are over all trials that have the value";  // known by it in earlier versions too

/// One table per suite, robot and mode, all under one another.
std::string tex(const Table& table) {
  const std::vector<std::string> head = heads(table);
  const auto group = [](const Json& row) {
    return row.at("suite").dump() + row.at("robot").dump() + row.at("mode").dump();
  };
  std::map<std::string, std::vector<const Json*>> groups;
  std::vector<std::string> order;
  for (const Json& row : table.rows) {
    if (groups.count(group(row)) == 0) order.push_back(group(row));
    groups[group(row)].push_back(&row);
  }
  std::string out;
  for (const std::string& name : order) {
    const Json& first = *groups[name].front();
    out += fmt::format(
        "{}% {}, {}, {}. Rates in per cent with 95 % Wilson intervals; the median time is over successes, {}.\n"
        "% Needs \\usepackage{{booktabs}}.\n\\begin{{tabular}}{{ll{}}}\n\\toprule\n{} \\\\\n\\midrule\n",
        out.empty() ? "" : "\n", tex_text(first.at("suite")), tex_text(first.at("robot")), tex_text(first.at("mode")),
        kMeans, std::string(head.size() - 2, 'r'), fmt::join(head, " & "));
    std::string family = first.at("family").dump();
    for (const Json* row : groups[name]) {
      if (row->at("family").dump() != family) out += "\\midrule\n";
      family = row->at("family").dump();
      out += fmt::format("{} \\\\\n", fmt::join(cells(table, *row), " & "));
    }
    out += "\\bottomrule\n\\end{tabular}\n";
  }
  return out;
}

}  // namespace

void write_table(const Stores& stores, const std::filesystem::path& file, files::Replace replace) {
  if (file.extension() != ".tex") {
    throw ReportError(
        fmt::format("{}: is a LaTeX table; wanted: a name that ends in .tex (moma query DB @summary "
                    "prints CSV, JSON and Markdown)",
                    file.string()));
  }
  ReportOptions options;
  options.replays = 0;
  const Json page = read_stores(stores, options);
  // A single family is its own total.
  std::map<std::string, std::size_t> families;
  const auto group = [](const Json& row) {
    return row.at("suite").dump() + row.at("robot").dump() + row.at("mode").dump() + row.at("controller").dump() +
           row.at("point").dump();
  };
  Table table;
  for (const Json& row : page.at("summary")) {
    ++families[group(row)];
    table.rows.push_back(row);
    table.errors = table.errors || row.at("errors").get<std::int64_t>() > 0;
  }
  for (const Json& row : page.at("overall")) {
    if (families[group(row)] > 1) table.rows.push_back(row);
  }
  for (const Json& metric : page.at("metrics"))
    if (metric.contains("own") || metric.contains("summary")) table.metrics.push_back(metric);
  write_text(file, {"table of results by moma report", kMeans}, replace, tex(table));
}

}  // namespace moma::reports
