#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "controller/config/paths.h"

namespace moma::store {

/// NULL, integer, real, text; a blob as hex digits.
using Cell = std::variant<std::monostate, std::int64_t, double, std::string>;

/// The number in a cell, if there is one.
std::optional<double> number_in(const Cell& cell);

struct QueryResult {
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;
  std::int64_t steps = 0;  ///< steps of SQLite's virtual machine, a cost that is the same on every computer
};

/// SQL that cannot be run; what() has SQLite's message and the place.
class QueryError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs one reading statement, in which samples('TRIAL') is a table and bit_count(N) the number of ones in N. Refuses
/// ATTACH, VACUUM INTO and PRAGMAs that set something. Stops after `patience`, since a store's views may be endless; 0:
/// no limit. Throws StoreError for the file, QueryError for the SQL.
QueryResult query(const fs::path& file, const std::string& sql,
                  std::chrono::milliseconds patience = std::chrono::minutes(10));

/// Text as a literal of SQL, in its quotes.
std::string sql_literal(std::string_view text);
/// A name of a table or column in SQL, in its quotes.
std::string sql_name(std::string_view name);

/// A query that is called as @name.
struct NamedQuery {
  std::string_view name;
  std::string_view description;
  std::string_view sql;
};

const std::vector<NamedQuery>& named_queries();

}  // namespace moma::store
