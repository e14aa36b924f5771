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

constexpr std::array<const char*, 16> kColumns = {"suite",
                                                  "robot",
                                                  "mode",
                                                  "family",
                                                  "controller",
                                                  "point",
                                                  "n",
                                                  "success_rate",
                                                  "success_low",
                                                  "success_high",
                                                  "collision_rate",
                                                  "collision_low",
                                                  "collision_high",
                                                  "time_to_goal_median_s",
                                                  "manip_mean",
                                                  "clearance_min_m"};

std::string csv_cell(const Json& cell) {
  if (cell.is_null()) return "";
  if (!cell.is_string()) return cell.dump();
  std::string text = cell;
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
  return '"' + text + '"';
}

std::string csv(const std::vector<Json>& rows) {
  std::string out = fmt::format("{},command_change_mean\n", fmt::join(kColumns, ","));
  for (const Json& row : rows) {
    for (const char* column : kColumns) out += csv_cell(row.at(column)) + ",";
    out += csv_cell(row.at("command_change_mean")) + "\n";
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
  const auto at = [&](const char* end) { return 100.0 * row.at(stem + end).get<double>(); };
  return fmt::format("{:.1f} ({:.1f}{}{:.1f})", at("_rate"), at("_low"), dash, at("_high"));
}

std::string fixed(const Json& cell, int decimals, const std::string& none) {
  return cell.is_number() ? fmt::format("{:.{}f}", cell.get<double>(), decimals) : none;
}

/// Cells of one row as a person reads them.
std::vector<std::string> cells(const Json& row, const Escape& escape, const std::string& dash) {
  const std::string point = row.at("point");
  const std::string who = row.at("controller").get<std::string>() + (point.empty() ? "" : ", " + point);
  return {escape(row.at("family").is_null() ? "all" : row.at("family").get<std::string>()),
          escape(who),
          row.at("n").dump(),
          rate(row, "success", dash),
          rate(row, "collision", dash),
          fixed(row.at("time_to_goal_median_s"), 2, dash),
          fixed(row.at("manip_mean"), 4, dash),
          fixed(row.at("clearance_min_m"), 3, dash),
          fixed(row.at("command_change_mean"), 4, dash)};
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

std::string tex(const std::vector<Json>& rows) {
  const auto begin = [](const Json& row) {
    return fmt::format(
        "% {}, {}, {}. {}, means are over all trials that have the value.\n% Needs \\usepackage{{booktabs}}.\n"
        "\\begin{{tabular}}{{llrrrrrrr}}\n\\toprule\n"
        "worlds & controller & $n$ & success [\\%] & collision [\\%] & time [s] & manipulability & clearance [m] & "
        "command change \\\\\n\\midrule\n",
        tex_text(row.at("suite")), tex_text(row.at("robot")), tex_text(row.at("mode")), kCaption);
  };
  const auto line = [](const Json& row) {
    return fmt::format("{} \\\\\n", fmt::join(cells(row, tex_text, "--"), " & "));
  };
  return layout(rows, begin, line, "\\bottomrule\n\\end{tabular}\n", "\\midrule\n");
}

std::string markdown(const std::vector<Json>& rows) {
  const auto begin = [](const Json& row) {
    return fmt::format(
        "{}, {}, {}. {}, means are over all trials that have the value.\n\n"
        "| worlds | controller | n | success [%] | collision [%] | time [s] | manipulability | clearance [m] | command "
        "change |\n| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
        md_text(row.at("suite")), md_text(row.at("robot")), md_text(row.at("mode")), kCaption);
  };
  const auto line = [](const Json& row) {
    return fmt::format("| {} |\n", fmt::join(cells(row, md_text, "\xe2\x80\x93"), " | "));
  };
  return layout(rows, begin, line, "", "");
}

}  // namespace

void write_table(const Stores& stores, const std::filesystem::path& file) {
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
  std::vector<Json> rows;
  for (const Json& row : page.at("summary")) {
    ++families[group(row)];
    rows.push_back(row);
  }
  for (const Json& row : page.at("overall")) {
    if (families[group(row)] > 1) rows.push_back(row);
  }
  write_atomically(file, kind == ".csv" ? csv(rows) : kind == ".tex" ? tex(rows) : markdown(rows));
}

}  // namespace moma::reports
