#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "reports/render/files.h"
#include "reports/render/page_data.h"
#include "reports/render/report.h"

namespace moma::reports {
namespace {

using Json = nlohmann::ordered_json;
using Escape = std::function<std::string(const std::string&)>;

constexpr std::array<const char*, 19> kColumns = {"suite",
                                                  "robot",
                                                  "mode",
                                                  "family",
                                                  "controller",
                                                  "point",
                                                  "n",
                                                  "errors",
                                                  "success_rate",
                                                  "success_low",
                                                  "success_high",
                                                  "success_without_errors",
                                                  "collision_rate",
                                                  "collision_low",
                                                  "collision_high",
                                                  "time_to_goal_median_s",
                                                  "manip_mean",
                                                  "clearance_min_m",
                                                  "command_change_mean"};

std::string csv_cell(const Json& cell) {
  if (cell.is_null()) return "";
  if (!cell.is_string()) return cell.dump();
  std::string text = cell;
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}

/// What is written: rows of the summary, and the suites' own metrics by key and name.
struct Table {
  std::vector<Json> rows;
  std::vector<std::pair<std::string, std::string>> own;
  bool errors = false;  ///< whether any trial ended by one
};

/// NULL where the row's store does not have the metric.
const Json& own_mean(const Json& row, const std::string& key) {
  static const Json kNone = nullptr;
  return row.contains("own") && row.at("own").contains(key) ? row.at("own").at(key) : kNone;
}

std::string csv(const Table& table) {
  std::string out = fmt::format("{}", fmt::join(kColumns, ","));
  for (const auto& [key, name] : table.own) out += "," + csv_cell(key);
  out += '\n';
  for (const Json& row : table.rows) {
    std::string line;
    for (const char* column : kColumns) line += (line.empty() ? "" : ",") + csv_cell(row.at(column));
    for (const auto& [key, name] : table.own) line += "," + csv_cell(own_mean(row, key));
    out += line + '\n';
  }
  return out;
}

std::string tex_text(const std::string& text) {
  static const std::map<char, std::string> kSpecial = {{'&', "\\&"},
                                                       {'%', "\\%"},
                                                       {'$', "\\$"},
                                                       {'#', "\\#"},
                                                       {'_', "\\_"},
                                                       {'{', "\\{"},
                                                       {'}', "\\}"},
                                                       {'~', "\\textasciitilde{}"},
                                                       {'^', "\\textasciicircum{}"},
                                                       {'\\', "\\textbackslash{}"},
                                                       {'\n', " "},
                                                       {'\r', " "},
                                                       {'<', "\\textless{}"},
                                                       {'>', "\\textgreater{}"},
                                                       {'|', "\\textbar{}"}};
  std::string out;
  for (const char c : text) {
    const auto found = kSpecial.find(c);
    if (found == kSpecial.end()) {
      out += c;
    } else {
      out += found->second;
    }
  }
  return out;
}

std::string md_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\n' || c == '\r') {
      out += ' ';
      continue;
    }
    if (std::string_view("|\\`*_[]<>").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// "57.3 (52.9-61.6)" with `dash` between the bounds.
std::string rate(const Json& row, const std::string& stem, const std::string& dash) {
  if (row.at(stem + "_rate").is_null()) return dash;  // all trials ended by an error
  // Half a unit of the last decimal is rounded up, as in the page and in SQL's printf().
  const auto at = [&](const char* end) { return std::round(1000.0 * row.at(stem + end).get<double>()) / 10.0; };
  return fmt::format("{:.1f} ({:.1f}{}{:.1f})", at("_rate"), at("_low"), dash, at("_high"));
}

std::string fixed(const Json& cell, int decimals, const std::string& none) {
  return cell.is_number() ? fmt::format("{:.{}f}", cell.get<double>(), decimals) : none;
}

/// Cells of one row as a person reads them.
std::vector<std::string> cells(const Table& table, const Json& row, const Escape& escape, const std::string& dash) {
  const std::string point = row.at("point");
  const std::string who = row.at("controller").get<std::string>() + (point.empty() ? "" : ", " + point);
  std::vector<std::string> all = {escape(row.at("family").is_null() ? "all" : row.at("family").get<std::string>()),
                                  escape(who), row.at("n").dump()};
  if (table.errors) all.push_back(row.at("errors").dump());
  all.push_back(rate(row, "success", dash));
  if (table.errors)
    all.push_back(row.at("success_without_errors").is_null()
                      ? dash
                      : fmt::format("{:.1f}", 100 * row.at("success_without_errors").get<double>()));
  all.push_back(rate(row, "collision", dash));
  for (const auto& [key, decimals] : {std::pair{"time_to_goal_median_s", 2}, std::pair{"manip_mean", 4},
                                      std::pair{"clearance_min_m", 3}, std::pair{"command_change_mean", 4}})
    all.push_back(fixed(row.at(key), decimals, dash));
  for (const auto& [key, name] : table.own) {
    const Json& mean = own_mean(row, key);
    all.push_back(mean.is_number() ? fmt::format("{:.4g}", mean.get<double>()) : dash);
  }
  return all;
}

/// Heads of the cells, the suites' own metrics last.
std::vector<std::string> heads(const Table& table, const Escape& escape, std::vector<std::string> moma) {
  if (table.errors) {
    moma.insert(moma.begin() + 3, "errors");
    moma.insert(moma.begin() + 5, escape("without errors %"));
  }
  for (const auto& [key, name] : table.own) moma.push_back(escape(name));
  return moma;
}

/// One table per suite, robot and mode, all under one another.
std::string layout(const std::vector<Json>& rows, const std::function<std::string(const Json&)>& begin,
                   const std::function<std::string(const Json&)>& line, const std::string& end,
                   const std::string& between) {
  const auto group = [](const Json& row) {
    return row.at("suite").dump() + row.at("robot").dump() + row.at("mode").dump();
  };
  std::map<std::string, std::vector<const Json*>> groups;
  std::vector<std::string> order;
  for (const Json& row : rows) {
    if (groups.count(group(row)) == 0) order.push_back(group(row));
    groups[group(row)].push_back(&row);
  }
  std::string out;
  for (const std::string& name : order) {
    if (!out.empty()) out += "\n";
    out += begin(*groups[name].front());
    std::string family = groups[name].front()->at("family").dump();
    for (const Json* row : groups[name]) {
      if (row->at("family").dump() != family) out += between;
      family = row->at("family").dump();
      out += line(*row);
    }
    out += end;
  }
  return out;
}

constexpr const char* kCaption = "Rates in per cent with 95 % Wilson intervals; the median time is over successes";
constexpr const char* kMeans = "means are over all trials that have the value";  // known by it in earlier versions too

std::string tex(const Table& table) {
  const auto begin = [&](const Json& row) {
    const std::vector<std::string> head =
        heads(table, tex_text,
              {"worlds", "controller", "$n$", "success [\\%]", "collision [\\%]", "median time to goal [s]",
               "mean manip.", "mean least clearance [m]", "mean command change"});
    return fmt::format(
        "% {}, {}, {}. {}, {}.\n% Needs \\usepackage{{booktabs}}.\n"
        "\\begin{{tabular}}{{ll{}}}\n\\toprule\n{} \\\\\n\\midrule\n",
        tex_text(row.at("suite")), tex_text(row.at("robot")), tex_text(row.at("mode")), kCaption, kMeans,
        std::string(head.size() - 2, 'r'), fmt::join(head, " & "));
  };
  const auto line = [&](const Json& row) {
    return fmt::format("{} \\\\\n", fmt::join(cells(table, row, tex_text, "--"), " & "));
  };
  return layout(table.rows, begin, line, "\\bottomrule\n\\end{tabular}\n", "\\midrule\n");
}

std::string markdown(const Table& table) {
  const auto begin = [&](const Json& row) {
    const std::vector<std::string> head =
        heads(table, md_text,
              {"worlds", "controller", "n", "success [%]", "collision [%]", "median time to goal [s]", "mean manip.",
               "mean least clearance [m]", "mean command change"});
    std::string rule = "| --- | --- |";
    for (std::size_t i = 2; i < head.size(); ++i) rule += " ---: |";
    return fmt::format("{}, {}, {}. {}, {}.\n\n| {} |\n{}\n", md_text(row.at("suite")), md_text(row.at("robot")),
                       md_text(row.at("mode")), kCaption, kMeans, fmt::join(head, " | "), rule);
  };
  const auto line = [&](const Json& row) {
    return fmt::format("| {} |\n", fmt::join(cells(table, row, md_text, "\xe2\x80\x93"), " | "));
  };
  return layout(table.rows, begin, line, "", "");
}

}  // namespace

void write_table(const Stores& stores, const std::filesystem::path& file, files::Replace replace) {
  const std::string kind = file.extension().string();
  if (kind != ".tex" && kind != ".md" && kind != ".csv") {
    throw ReportError(fmt::format("{}: unknown kind of table '{}'; wanted: a name that ends in .tex, .md or .csv",
                                  file.string(), kind));
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
    if (metric.contains("own")) table.own.emplace_back(metric.at("key"), metric.at("name"));
  const files::Kind own{"table of results by moma report",
                        kind == ".csv" ? "suite,robot,mode,family,controller,point,n," : kMeans};
  write_text(file, own, replace, kind == ".csv" ? csv(table) : kind == ".tex" ? tex(table) : markdown(table));
}

}  // namespace moma::reports
