#include "eval/cli/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>

#include "controller/config/json_node.h"
#include "controller/model/text_check.h"

namespace moma::cli {
namespace {

using store::Cell;
using store::QueryResult;

/// The code point of one character, whose UTF-8 `text` is.
char32_t code_point(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  char32_t code = text.size() == 1 ? byte(0) : byte(0) & (0xffU >> (text.size() + 1));
  for (std::size_t i = 1; i < text.size(); ++i) code = (code << 6) | (byte(i) & 0x3f);
  return code;
}

bool acts_on_terminal(char32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x061c || (code >= 0x200b && code <= 0x200f) ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2060 && code <= 0x206f) || code == 0xfeff;
}

std::string plain_number(double value) {
  if (std::isnan(value)) return "";
  return fmt::format("{:.6g}", value);
}

/// A cell in words; nothing for NULL.
std::string text_of(const Cell& cell, std::string (*number)(double), std::string (*text)(std::string_view)) {
  if (const auto* integer = std::get_if<std::int64_t>(&cell)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&cell)) return number(*real);
  if (const auto* words = std::get_if<std::string>(&cell)) return text(*words);
  return "";
}

bool is_number(const Cell& cell) {
  return std::holds_alternative<std::int64_t>(cell) || std::holds_alternative<double>(cell);
}

/// Columns that `text` (valid UTF-8) takes on a terminal, one per code point.
std::size_t display_width(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

struct Grid {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> width;
  std::vector<bool> right;  ///< columns of nothing but numbers stand to the right
};

Grid make_grid(const QueryResult& result) {
  Grid grid;
  for (const std::string& column : result.columns) grid.head.push_back(terminal_safe(column));
  const std::size_t columns = result.columns.size();
  grid.right.assign(columns, true);
  for (std::size_t c = 0; c < columns; ++c) grid.width.push_back(display_width(grid.head[c]));
  for (const std::vector<Cell>& row : result.rows) {
    std::vector<std::string>& texts = grid.rows.emplace_back();
    for (std::size_t c = 0; c < columns; ++c) {
      texts.push_back(text_of(row[c], &plain_number, &terminal_safe));
      grid.width[c] = std::max(grid.width[c], display_width(texts.back()));
      if (!is_number(row[c]) && !std::holds_alternative<std::monostate>(row[c])) grid.right[c] = false;
    }
  }
  return grid;
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, display_width(text)), ' ');
  return right ? space + text : text + space;
}

void write_table(std::ostream& out, const QueryResult& result) {
  const Grid grid = make_grid(result);
  const auto line = [&](const std::vector<std::string>& texts) {
    std::string text;
    for (std::size_t c = 0; c < texts.size(); ++c) {
      if (c > 0) text += "  ";
      text += padded(texts[c], grid.width[c], grid.right[c]);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out << text << '\n';
  };
  line(grid.head);
  std::vector<std::string> rule;
  for (const std::size_t width : grid.width) rule.emplace_back(width, '-');
  line(rule);
  for (const auto& row : grid.rows) line(row);
  if (grid.rows.empty()) out << "(no rows)\n";
}

void write_markdown(std::ostream& out, const QueryResult& result) {
  Grid grid = make_grid(result);
  const auto escape = [](std::string& text) {
    for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, 1, '\\');
  };
  for (std::string& text : grid.head) escape(text);
  for (auto& row : grid.rows) std::ranges::for_each(row, escape);
  for (std::size_t c = 0; c < grid.head.size(); ++c) {
    grid.width[c] = std::max<std::size_t>(3, display_width(grid.head[c]));  // a rule has three dashes at least
    for (const auto& row : grid.rows) grid.width[c] = std::max(grid.width[c], display_width(row[c]));
  }
  const auto line = [&](const std::vector<std::string>& texts) {
    out << '|';
    for (std::size_t c = 0; c < texts.size(); ++c) out << ' ' << padded(texts[c], grid.width[c], grid.right[c]) << " |";
    out << '\n';
  };
  line(grid.head);
  out << '|';
  for (std::size_t c = 0; c < grid.head.size(); ++c) {
    out << ' ' << std::string(grid.width[c] - 1, '-') << (grid.right[c] ? ": |" : "- |");
  }
  out << '\n';
  for (const auto& row : grid.rows) line(row);
}

std::string latex_text(const std::string& text) {
  static const std::map<char, std::string> kNamed = {{'~', "asciitilde"}, {'^', "asciicircum"}, {'\\', "backslash"},
                                                     {'<', "less"},       {'>', "greater"},     {'|', "bar"}};
  std::string out;
  for (const char c : text) {
    const auto named = kNamed.find(c);
    if (named != kNamed.end()) {
      out += "\\text" + named->second + "{}";
    } else if (c == '[' || c == ']') {  // behind the end of a line a bracket would be its argument
      out.append("{").append(1, c).append("}");
    } else {
      if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) out += '\\';
      out += c;
    }
  }
  return out;
}

void write_latex(std::ostream& out, const QueryResult& result) {
  const Grid grid = make_grid(result);
  const auto line = [&](const std::vector<std::string>& texts) {
    for (std::size_t c = 0; c < texts.size(); ++c) out << (c > 0 ? " & " : "") << latex_text(texts[c]);
    out << " \\\\\n";
  };
  out << "% Needs \\usepackage{booktabs}.\n\\begin{tabular}{";
  for (const bool right : grid.right) out << (right ? 'r' : 'l');
  out << "}\n\\toprule\n";
  line(grid.head);
  out << "\\midrule\n";
  for (const auto& row : grid.rows) line(row);
  out << "\\bottomrule\n\\end{tabular}\n";
}

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

void write_csv(std::ostream& out, const QueryResult& result) {
  const auto number = [](double value) { return fmt::format("{}", value); };
  for (std::size_t c = 0; c < result.columns.size(); ++c) out << (c > 0 ? "," : "") << csv_field(result.columns[c]);
  out << '\n';
  for (const auto& row : result.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) out << (c > 0 ? "," : "") << text_of(row[c], number, &csv_field);
    out << '\n';
  }
}

Json row_as_json(const QueryResult& result, const std::vector<Cell>& row) {
  struct Visitor {
    Json operator()(std::monostate) const { return nullptr; }
    Json operator()(std::int64_t value) const { return value; }
    Json operator()(double value) const { return config::number_or_word(value); }
    Json operator()(const std::string& value) const { return value; }
  };
  Json object = Json::object();
  for (std::size_t c = 0; c < row.size(); ++c) object[result.columns[c]] = std::visit(Visitor{}, row[c]);
  return object;
}

/// Row by row, because the JSON of all rows of a large store would not fit into memory.
void write_json(std::ostream& out, const QueryResult& result) {
  out << '[';
  const char* separator = "\n ";
  for (const std::vector<Cell>& row : result.rows) {
    out << separator << row_as_json(result, row).dump(-1, ' ', false, Json::error_handler_t::replace);
    separator = ",\n ";
  }
  out << (result.rows.empty() ? "]\n" : "\n]\n");
}

}  // namespace

void drop_columns(QueryResult& result, std::ptrdiff_t first, std::ptrdiff_t last) {
  result.columns.erase(result.columns.begin() + first, result.columns.begin() + last);
  for (std::vector<Cell>& row : result.rows) row.erase(row.begin() + first, row.begin() + last);
}

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

Json rows_as_json(const QueryResult& result) {
  Json list = Json::array();
  for (const std::vector<Cell>& row : result.rows) list.push_back(row_as_json(result, row));
  return list;
}

std::string terminal_safe(std::string_view text) {
  std::string safe;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text.substr(i));
    if (length == 0) {
      safe += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i]));
      ++i;
      continue;
    }
    const char32_t code = code_point(text.substr(i, length));
    if (code == '\n' || code == '\t') {
      safe += code == '\n' ? "\\n" : "\\t";
    } else if (acts_on_terminal(code)) {
      safe += code < 0x100 ? fmt::format("\\x{:02x}", static_cast<unsigned>(code))
                           : fmt::format("\\u{:04x}", static_cast<unsigned>(code));
    } else {
      safe += text.substr(i, length);
    }
    i += length;
  }
  return safe;
}

std::string terminal_safe_lines(std::string_view text) {
  std::string safe;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    safe += (begin > 0 ? "\n" : "") + terminal_safe(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return safe;
}

void write(std::ostream& out, const QueryResult& result, Format format) {
  constexpr std::pair<Format, void (*)(std::ostream&, const QueryResult&)> kWriters[] = {
      {Format::kTable, &write_table},
      {Format::kCsv, &write_csv},
      {Format::kJson, &write_json},
      {Format::kMarkdown, &write_markdown},
      {Format::kLatex, &write_latex}};
  for (const auto& [of, writer] : kWriters)
    if (of == format) writer(out, result);
}

std::string shape_text(const Shape& shape) {
  const Vector3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return fmt::format("sphere, radius {:.4g}", s.x());
    case ShapeKind::kBox:
      return fmt::format("box {:.4g} x {:.4g} x {:.4g}", s.x(), s.y(), s.z());
    case ShapeKind::kCylinder:
      return fmt::format("cylinder, radius {:.4g}, length {:.4g}", s.x(), s.y());
    case ShapeKind::kCapsule:
      return fmt::format("capsule, radius {:.4g}, length {:.4g}", s.x(), s.y());
    case ShapeKind::kConvex:
      return fmt::format("convex hull of {} points", shape.hull == nullptr ? 0 : shape.hull->vertices.size());
  }
  return "";
}

std::string vector_text(const Eigen::Ref<const VectorX>& v) {
  return fmt::format("({:.4f})", fmt::join(v.data(), v.data() + v.size(), ", "));
}

}  // namespace moma::cli
