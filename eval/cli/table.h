#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "controller/config/json.h"
#include "controller/model/shape.h"
#include "controller/types.h"
#include "eval/store/query.h"

namespace moma::cli {

enum class Format { kTable, kCsv, kJson, kMarkdown, kLatex };
/// True for formats that a person reads.
constexpr bool for_person(Format format) { return format != Format::kCsv && format != Format::kJson; }

/// Writes a result. Table, Markdown and LaTeX (booktabs) are for a person: numbers with up to six digits, safe text.
/// CSV (RFC 4180, NULL empty) and JSON (a list of objects) keep every bit of a number.
void write(std::ostream& out, const store::QueryResult& result, Format format);

/// Leaves out the columns first .. last - 1.
void drop_columns(store::QueryResult& result, std::ptrdiff_t first, std::ptrdiff_t last);

/// The multiple of `unit` that is nearest to a value, for a table.
double rounded(double value, double unit);

/// The rows as a JSON list of objects.
Json rows_as_json(const store::QueryResult& result);

/// Control characters, invalid UTF-8 and text direction marks become visible escapes: nothing that was stored can act
/// on the terminal.
std::string terminal_safe(std::string_view text);
/// Does so in each line of a text, and keeps the line breaks.
std::string terminal_safe_lines(std::string_view text);

/// "sphere, radius 0.1", "box 0.1 x 0.2 x 0.3", ..., in metres.
std::string shape_text(const Shape& shape);
/// "(0.1, 0.2, 0.3)", four digits behind the point.
std::string vector_text(const Eigen::Ref<const VectorX>& v);

}  // namespace moma::cli
