#include "eval/store/row_binding.h"

#include <SQLiteCpp/Column.h>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace moma::store {
namespace {

void bind_value(SQLite::Statement& statement, int index, double value) { bind_number(statement, index, value); }
void bind_value(SQLite::Statement& statement, int index, int value) { statement.bind(index, value); }
void bind_value(SQLite::Statement& statement, int index, const std::string& value) {
  if (value.empty()) {
    statement.bind(index);
  } else {
    statement.bind(index, value);
  }
}

void read_value(const SQLite::Column& column, double& value) { value = column.isNull() ? kAbsent : column.getDouble(); }
void read_value(const SQLite::Column& column, int& value) { value = column.getInt(); }
void read_value(const SQLite::Column& column, std::string& value) {
  value = column.isNull() ? std::string() : column.getString();
}

}  // namespace

void bind_hash(SQLite::Statement& statement, int index, const Hash& hash) {
  statement.bind(index, hash.data(), static_cast<int>(hash.size()));
}

void bind_number(SQLite::Statement& statement, int index, double value) {
  const double kept = stored(value);
  if (std::isnan(kept)) {
    statement.bind(index);
  } else {
    statement.bind(index, kept);
  }
}

std::string trial_column_list(const std::string& prefix) {
  std::string list = prefix + "outcome";
  for (const TrialColumn& column : trial_columns()) list += fmt::format(", {}{}", prefix, column.name);
  return list;
}

std::string trial_column_list(const std::string& prefix, const std::set<std::string>& stored) {
  std::string list = prefix + "outcome";
  for (const TrialColumn& column : trial_columns()) {
    const bool there = stored.count(std::string(column.name)) > 0;
    list += there ? fmt::format(", {}{}", prefix, column.name) : fmt::format(", NULL AS {}", column.name);
  }
  return list;
}

int bind_row(SQLite::Statement& statement, int first, const TrialRow& row) {
  statement.bind(first++, std::string(to_string(row.outcome)));
  for (const TrialColumn& column : trial_columns()) {
    std::visit([&](auto member) { bind_value(statement, first, row.*member); }, column.member);
    ++first;
  }
  return first;
}

TrialRow read_row(SQLite::Statement& statement, int first) {
  TrialRow row;
  const std::string outcome = statement.getColumn(first++).getString();
  const auto known = from_string<Outcome>(outcome);
  if (!known) throw std::invalid_argument("unknown outcome " + outcome);
  row.outcome = *known;
  for (const TrialColumn& column : trial_columns()) {
    const SQLite::Column value = statement.getColumn(first++);
    std::visit([&](auto member) { read_value(value, row.*member); }, column.member);
  }
  return row;
}

}  // namespace moma::store
