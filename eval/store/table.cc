#include "eval/store/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "controller/config/json_node.h"
#include "controller/config/text_file.h"
#include "eval/store/columns.h"

namespace moma::store {
namespace {

std::string column_name(const SQLite::Column& cell) { return cell.getName(); }

static_assert(std::endian::native == std::endian::little, "lists of doubles are stored little-endian");

}  // namespace

void bind_cell(SQLite::Statement& s, int index, std::int64_t value) { s.bind(index, value); }
void bind_cell(SQLite::Statement& s, int index, double value) { s.bind(index, value); }
void bind_cell(SQLite::Statement& s, int index, std::string_view value) { s.bind(index, std::string(value)); }
void bind_cell(SQLite::Statement& s, int index, const Hash& value) {
  s.bind(index, value.data(), static_cast<int>(value.size()));
}
void bind_cell(SQLite::Statement& s, int index, const Blob& value) {
  s.bind(index, value.empty() ? static_cast<const void*>("") : value.data(), static_cast<int>(value.size()));
}
void bind_cell(SQLite::Statement& s, int index, const std::vector<double>& value, bool bits) {
  if (!bits) return s.bind(index, nlohmann::json(value).dump());
  const void* const bytes = value.empty() ? "" : static_cast<const void*>(value.data());
  s.bind(index, bytes, static_cast<int>(value.size() * sizeof(double)));
}

void read_cell(const SQLite::Column& cell, double& value) { value = cell.isNull() ? kAbsent : cell.getDouble(); }
void read_cell(const SQLite::Column& cell, std::string& value) { value = cell.getString(); }
void read_cell(const SQLite::Column& cell, Hash& value) {
  if (cell.getBytes() != static_cast<int>(value.size()))
    throw std::invalid_argument(
        fmt::format("{} has {} bytes instead of {}", column_name(cell), cell.getBytes(), value.size()));
  const auto* bytes = static_cast<const unsigned char*>(cell.getBlob());
  std::copy(bytes, bytes + value.size(), value.begin());
}
void read_cell(const SQLite::Column& cell, Blob& value) {
  const auto* bytes = static_cast<const unsigned char*>(cell.getBlob());
  value.assign(bytes, bytes + (bytes == nullptr ? 0 : cell.getBytes()));
}
void read_cell(const SQLite::Column& cell, std::vector<double>& value, bool bits) {
  if (bits) {
    value.resize(static_cast<std::size_t>(cell.getBytes()) / sizeof(double));
    if (!value.empty()) std::memcpy(value.data(), cell.getBlob(), value.size() * sizeof(double));
    return;
  }
  const std::string text = cell.getString();
  try {
    value = config::parse_json(text, column_name(cell)).get<std::vector<double>>();
  } catch (const nlohmann::json::exception&) {
    throw std::invalid_argument(
        fmt::format("{}: '{}' is no list of numbers", column_name(cell), config::shortened(text)));
  }
}
void refuse_word(const SQLite::Column& cell) {
  throw std::invalid_argument(fmt::format("unknown {} {}", column_name(cell), config::shortened(cell.getString())));
}

void bind_metric(SQLite::Statement& s, int index, double value) {
  s.bind(index, stored(value));  // SQLite keeps NaN as NULL
}
void bind_metric(SQLite::Statement& s, int index, const std::string& value) {
  if (value.empty()) return s.bind(index);
  s.bind(index, value);
}
bool same_metric(double kept, double said) {
  const double wanted = stored(said);
  return kept == wanted || (std::isnan(kept) && std::isnan(wanted));
}

void add_bits(std::string& text, const SQLite::Column& cell) {
  if (cell.isFloat()) {
    text += fmt::format("{:016x}", std::bit_cast<std::uint64_t>(cell.getDouble()));
  } else if (!cell.isNull()) {
    text += cell.getString();
  }
}

Hash chain_rows(SQLite::Database& db, Hash chain, const std::string& sql) {
  for (SQLite::Statement s(db, sql); s.executeStep();) {
    std::string line = to_hex(chain);
    for (int c = 0; c < s.getColumnCount(); ++c) {
      line += '|';
      add_bits(line, s.getColumn(c));
    }
    chain = hash_text(line);
  }
  return chain;
}

std::string places_sql(const std::string& names) {
  std::string places = "?";
  for (const char c : names)
    if (c == ',') places += ", ?";
  return places;
}

std::string where_sql(const std::vector<std::string>& keys, std::size_t n) {
  std::string text;
  for (std::size_t i = 0; i < n; ++i) text += fmt::format("{}{} = ?", i == 0 ? " WHERE " : " AND ", keys[i]);
  return text;
}

}  // namespace moma::store
