#pragma once

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "eval/store/field.h"

// Typed SQL: statements take and return C++ values, tables hold described records (eval/store/field.h). All functions
// throw SQLite::Exception, and std::invalid_argument with the column for values that moma never writes.

namespace moma::store {

// One value. NULL is read as NaN or as an empty text.
void bind_cell(SQLite::Statement& s, int index, std::int64_t value);
void bind_cell(SQLite::Statement& s, int index, double value);
void bind_cell(SQLite::Statement& s, int index, std::string_view value);
void bind_cell(SQLite::Statement& s, int index, const Hash& value);
void bind_cell(SQLite::Statement& s, int index, const Blob& value);
void bind_cell(SQLite::Statement& s, int index, const std::vector<double>& value, bool bits);
void read_cell(const SQLite::Column& cell, double& value);
void read_cell(const SQLite::Column& cell, std::string& value);
void read_cell(const SQLite::Column& cell, Hash& value);
void read_cell(const SQLite::Column& cell, Blob& value);
void read_cell(const SQLite::Column& cell, std::vector<double>& value, bool bits);
[[noreturn]] void refuse_word(const SQLite::Column& cell);

// A metric: infinities, NaN and an empty text become NULL, -0 becomes 0.
void bind_metric(SQLite::Statement& s, int index, double value);
void bind_metric(SQLite::Statement& s, int index, const std::string& value);
/// True if `said` is stored as `kept`.
bool same_metric(double kept, double said);

namespace field {

template <class M>
void bind(SQLite::Statement& s, int index, const M& value, [[maybe_unused]] const Field& about = {}) {
  if constexpr (Optional<M>::value) {
    if (value) return bind(s, index, *value, about);
    s.bind(index);
  } else if constexpr (Worded<M>) {
    bind_cell(s, index, to_string(value));
  } else if constexpr (std::is_integral_v<M>) {
    bind_cell(s, index, static_cast<std::int64_t>(value));
  } else if constexpr (is_list<M>) {
    bind_cell(s, index, value, about.bits);
  } else {
    bind_cell(s, index, value);
  }
}
template <class M>
void bind(SQLite::Statement& s, int index, const M& value, const Column& /*about*/) {
  if constexpr (std::same_as<M, double> || std::same_as<M, std::string>) {
    bind_metric(s, index, value);
  } else {
    bind(s, index, value, Field{});
  }
}

template <class M>
void read(const SQLite::Column& cell, M& value, [[maybe_unused]] bool bits = false) {
  if constexpr (Optional<M>::value) {
    value.reset();
    if (!cell.isNull()) read(cell, value.emplace(), bits);
  } else if constexpr (Worded<M>) {
    const auto known = from_string<M>(cell.getString());
    if (!known) refuse_word(cell);
    value = *known;
  } else if constexpr (std::is_integral_v<M>) {
    value = static_cast<M>(cell.getInt64());
  } else if constexpr (is_list<M>) {
    read_cell(cell, value, bits);
  } else {
    read_cell(cell, value);
  }
}
inline bool bits(const Field& about) { return about.bits; }
inline bool bits(const Column&) { return false; }

/// True if `said` is stored as `kept`.
template <class About, class M>
bool same(const M& kept, const M& said) {
  if constexpr (std::same_as<M, double> && std::same_as<About, Column>) return same_metric(kept, said);
  if constexpr (std::same_as<M, std::optional<double>>)
    return said && *said != *said ? !kept : kept == said;  // NaN is NULL
  return kept == said;
}

/// Binds a value, or all columns of a described record, from parameter `index` on, and advances it.
template <class T>
void bind_next(SQLite::Statement& s, int& index, const T& value) {
  if constexpr (Described<T>) {
    for_members<T>([&](std::string_view, auto member, const auto& about) { bind(s, index++, value.*member, about); });
  } else {
    bind(s, index++, value);
  }
}

/// Reads a value, or the columns column_names<T>(), from column `index` on, and advances it.
template <class T>
T read_next(SQLite::Statement& s, int& index) {
  T value{};
  if constexpr (Described<T>) {
    for_members<T>([&](std::string_view, auto member, const auto& about) {
      read(s.getColumn(index++), value.*member, bits(about));
    });
  } else {
    read(s.getColumn(index++), value);
  }
  return value;
}

template <class R, class... T>
R read_row(SQLite::Statement& s) {
  int index = 0;
  return R{read_next<T>(s, index)...};  // in their order, as braces promise
}

template <class... T>
struct Row {
  using type = std::tuple<T...>;
};
template <class T>
struct Row<T> {
  using type = T;
};

}  // namespace field

/// Binds values and records to the parameters of a statement, which starts anew.
template <class... A>
void bind_all(SQLite::Statement& s, const A&... values) {
  s.reset();
  [[maybe_unused]] int index = 1;
  (field::bind_next(s, index, values), ...);
}

/// Runs a statement that gives no rows; returns how many it changed.
template <class... A>
int execute(SQLite::Statement& s, const A&... values) {
  bind_all(s, values...);
  return s.exec();
}
template <class... A>
int execute(SQLite::Database& db, const std::string& sql, const A&... values) {
  SQLite::Statement s(db, sql);
  return execute(s, values...);
}

/// Calls `work` with the values of each row, of these types; a described record takes several columns.
template <class... T, class Work, class... A>
void for_rows(SQLite::Database& db, const std::string& sql, const Work& work, const A&... values) {
  SQLite::Statement s(db, sql);
  bind_all(s, values...);
  while (s.executeStep()) std::apply(work, field::read_row<std::tuple<T...>, T...>(s));
}

/// All rows, as R{T...}.
template <class R, class... T, class... A>
std::vector<R> rows_as(SQLite::Database& db, const std::string& sql, const A&... values) {
  SQLite::Statement s(db, sql);
  bind_all(s, values...);
  std::vector<R> all;
  while (s.executeStep()) all.push_back(field::read_row<R, T...>(s));
  return all;
}
/// All rows, as tuples of several T or as one T.
template <class... T, class... A>
std::vector<typename field::Row<T...>::type> rows(SQLite::Database& db, const std::string& sql, const A&... values) {
  return rows_as<typename field::Row<T...>::type, T...>(db, sql, values...);
}

/// The first row, if any, as R{T...}. Resets the statement, since an open one keeps its snapshot past a commit.
template <class R, class... T, class... A>
std::optional<R> row_as(SQLite::Statement& s, const A&... values) {
  bind_all(s, values...);
  std::optional<R> first;
  if (s.executeStep()) first = field::read_row<R, T...>(s);
  s.reset();
  return first;
}
/// The same, as a tuple of several T or as one T.
template <class... T, class... A>
std::optional<typename field::Row<T...>::type> row(SQLite::Statement& s, const A&... values) {
  return row_as<typename field::Row<T...>::type, T...>(s, values...);
}
template <class... T, class... A>
std::optional<typename field::Row<T...>::type> row(SQLite::Database& db, const std::string& sql, const A&... values) {
  SQLite::Statement s(db, sql);
  return row<T...>(s, values...);
}

/// The one whole number that a query of counts gives.
template <class... A>
std::size_t count(SQLite::Database& db, const std::string& sql, const A&... values) {
  return row<std::size_t>(db, sql, values...).value();
}

/// Appends a value as text; a number as its bits.
void add_bits(std::string& text, const SQLite::Column& cell);
/// Returns the hash chain over all rows of a query, which continues `chain`.
Hash chain_rows(SQLite::Database& db, Hash chain, const std::string& sql);

/// Names of the columns in which `kept` differs from `said` as stored; "" if none.
template <class R>
std::string differing_columns(const R& kept, const R& said) {
  std::string names;
  for_members<R>([&]<class About>(std::string_view name, auto member, const About&) {
    if (!field::same<About>(kept.*member, said.*member)) names.append(names.empty() ? "" : ", ").append(name);
  });
  return names;
}

/// "outcome, reason, ...", with NULL for columns that are not in `stored`.
template <class R>
std::string column_names(std::string_view prefix = {}, const std::set<std::string>* stored = nullptr) {
  return joined(definitions<R>(), [&](const ColumnDefinition& column) {
    const bool there = stored == nullptr || stored->count(column.name) > 0;
    return std::string(there ? prefix : "NULL AS ") + column.name;
  });
}

/// "?, ?, ..." for a list of names.
std::string places_sql(const std::string& names);
/// " WHERE a = ? AND b = ?" of the first `n` keys.
std::string where_sql(const std::vector<std::string>& keys, std::size_t n);

/// A table of records. `keys`: columns before the record's own that identify the row. Methods take values of the first
/// keys.
template <class R>
class Table {
 public:
  /// `stored`: the existing columns of a table that may lack some and is only read.
  Table(SQLite::Database& db, std::string name, std::vector<std::string> keys,
        const std::set<std::string>* stored = nullptr)
      : db_(db), name_(std::move(name)), keys_(std::move(keys)), names_(column_names<R>({}, stored)) {}

  /// Returns the row's integer key, where it has one.
  template <class... K>
  std::int64_t insert(const R& record, const K&... key) {
    add(insert_, "", record, key...);
    return db_.getLastInsertRowid();
  }
  /// Returns false if the row exists. Uses ON CONFLICT because OR IGNORE also drops rows that violate a rule, or whose
  /// CHECK ran out of memory (json_valid() in SQLite 3.40).
  template <class... K>
  bool insert_new(const R& record, const K&... key) {
    return add(insert_new_, " ON CONFLICT DO NOTHING", record, key...) > 0;
  }
  template <class... K>
  void update(const R& record, const K&... key) {
    execute(db_,
            "UPDATE " + name_ + " SET (" + names_ + ") = (" + places_sql(names_) + ")" + where_sql(keys_, sizeof...(K)),
            record, key...);
  }
  /// Returns the rows in the order of their keys.
  template <class... K>
  std::vector<R> all(const K&... key) const {
    std::string order;
    for (const std::string& name : keys_) order += (order.empty() ? " ORDER BY " : ", ") + name;
    return rows<R>(db_, "SELECT " + names_ + " FROM " + name_ + where_sql(keys_, sizeof...(K)) + order, key...);
  }
  template <class... K>
  std::optional<R> find(const K&... key) const {
    return row<R>(db_, "SELECT " + names_ + " FROM " + name_ + where_sql(keys_, sizeof...(K)), key...);
  }
  template <class... K>
  void erase(const K&... key) {
    execute(db_, "DELETE FROM " + name_ + where_sql(keys_, sizeof...(K)), key...);
  }

 private:
  template <class... K>
  int add(std::optional<SQLite::Statement>& statement, const char* conflict, const R& record, const K&... key) {
    if (!statement) {
      std::string names;
      for (std::size_t i = 0; i < sizeof...(K); ++i) names += keys_[i] + ", ";
      names += names_;
      statement.emplace(db_, "INSERT INTO " + name_ + " (" + names + ") VALUES (" + places_sql(names) + ")" + conflict);
    }
    return execute(*statement, key..., record);
  }

  SQLite::Database& db_;
  std::string name_;
  std::vector<std::string> keys_;
  std::string names_;
  std::optional<SQLite::Statement> insert_, insert_new_;  // kept: SQLite compiles one in tens of microseconds
};

}  // namespace moma::store
