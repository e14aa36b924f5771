#pragma once

#include <SQLiteCpp/Column.h>
#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "eval/store/field.h"

namespace moma::store {

// One value. Texts that are no value of the member's type throw std::invalid_argument, naming the column.
void bind_cell(SQLite::Statement& s, int index, std::int64_t value);
void bind_cell(SQLite::Statement& s, int index, double value);
void bind_cell(SQLite::Statement& s, int index, const std::string& value);
void bind_cell(SQLite::Statement& s, int index, const Hash& value);
void bind_cell(SQLite::Statement& s, int index, const std::vector<double>& value, bool bits);
void read_cell(const SQLite::Column& cell, double& value);
void read_cell(const SQLite::Column& cell, std::string& value);
void read_cell(const SQLite::Column& cell, Hash& value);
void read_cell(const SQLite::Column& cell, std::vector<double>& value, bool bits);
[[noreturn]] void refuse_word(const SQLite::Column& cell);

// Of a metric: infinities and what is absent are NULL, -0 is 0, and so is an empty text.
void bind_metric(SQLite::Statement& s, int index, double value);
void bind_metric(SQLite::Statement& s, int index, const std::string& value);
void read_metric(const SQLite::Column& cell, double& value);
void read_metric(const SQLite::Column& cell, std::string& value);
/// Whether `said` is stored as `kept`.
bool same_metric(double kept, double said);

namespace field {

template <class M>
void bind(SQLite::Statement& s, int index, const M& value, [[maybe_unused]] const Field& about = {}) {
  if constexpr (Optional<M>::value) {
    if (value) return bind(s, index, *value, about);
    s.bind(index);
  } else if constexpr (Worded<M>) {
    bind_cell(s, index, std::string(to_string(value)));
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
void read(const SQLite::Column& cell, M& value, [[maybe_unused]] const Field& about = {}) {
  if constexpr (Optional<M>::value) {
    value.reset();
    if (!cell.isNull()) read(cell, value.emplace(), about);
  } else if constexpr (Worded<M>) {
    const auto known = from_string<M>(cell.getString());
    if (!known) refuse_word(cell);
    value = *known;
  } else if constexpr (std::is_integral_v<M>) {
    value = static_cast<M>(cell.getInt64());
  } else if constexpr (is_list<M>) {
    read_cell(cell, value, about.bits);
  } else {
    read_cell(cell, value);
  }
}
template <class M>
void read(const SQLite::Column& cell, M& value, const Column& /*about*/) {
  if constexpr (std::same_as<M, double> || std::same_as<M, std::string>) {
    read_metric(cell, value);
  } else {
    read(cell, value, Field{});
  }
}

template <class R>
struct Binder {
  SQLite::Statement& s;
  const R& record;
  int index;
  template <class M, class C, class About>
  void member(std::string_view, M C::*member, const About& about) {
    bind(s, index++, record.*member, about);
  }
  template <class M, class C>
  void inlined(M C::*) {}
};

template <class R>
struct Reader {
  SQLite::Statement& s;
  R& record;
  int index;
  template <class M, class C, class About>
  void member(std::string_view, M C::*member, const About& about) {
    read(s.getColumn(index++), record.*member, about);
  }
  template <class M, class C>
  void inlined(M C::*) {}
};

/// Whether `said` is stored as `kept`.
template <class About, class M>
bool same(const M& kept, const M& said) {
  if constexpr (std::same_as<M, double> && std::same_as<About, Column>) return same_metric(kept, said);
  if constexpr (std::same_as<M, std::optional<double>>)
    return said && *said != *said ? !kept : kept == said;  // NaN is NULL
  return kept == said;
}

template <class R>
struct Differ {
  const R& kept;
  const R& said;
  std::string names;
  template <class M, class C, class About>
  void member(std::string_view name, M C::*member, const About&) {
    if (!same<About>(kept.*member, said.*member)) names.append(names.empty() ? "" : ", ").append(name);
  }
  template <class M, class C>
  void inlined(M C::*) {}
};

}  // namespace field

/// Binds all columns from parameter `first` on; returns the next free parameter.
template <class R>
int bind_record(SQLite::Statement& s, int first, const R& record) {
  field::Binder<R> binder{s, record, first};
  describe(binder, Of<R>{});
  return binder.index;
}

/// Reads what column_names<R>() selects, from column `first` on.
template <class R>
R read_record(SQLite::Statement& s, int first) {
  R record;
  field::Reader<R> reader{s, record, first};
  describe(reader, Of<R>{});
  return record;
}

/// Names of the columns that do not hold what `said` would be stored as; "" where all do.
template <class R>
std::string differing_columns(const R& kept, const R& said) {
  field::Differ<R> differ{kept, said, {}};
  describe(differ, Of<R>{});
  return differ.names;
}
/// Of those from `first` on.
template <class R>
std::string differing_columns(SQLite::Statement& s, int first, const R& said) {
  return differing_columns(read_record<R>(s, first), said);
}

/// "outcome, reason, ..."; NULL in place of those that a table without them lacks.
template <class R>
std::string column_names(std::string_view prefix = {}, const std::set<std::string>* stored = nullptr) {
  std::string list;
  for (const ColumnDefinition& column : definitions<R>()) {
    if (!list.empty()) list += ", ";
    const bool there = stored == nullptr || stored->count(column.name) > 0;
    list.append(there ? prefix : "NULL AS ").append(column.name);
  }
  return list;
}

/// "INSERT INTO table (names) VALUES (?, ?, ...)".
std::string insert_sql(std::string_view table, const std::string& names);
/// " WHERE a = ? AND b = ?" of the first `n` keys, "a, b" apart by commas.
std::string where_sql(const std::vector<std::string>& keys, std::size_t n);

/// A table of records, with `keys`: columns that come before the record's own and say whose row it is. A method takes
/// values of as many keys as it is to go by. Throws SQLite::Exception, and std::invalid_argument for what no moma
/// writes.
template <class R>
class Table {
 public:
  /// `stored`: the table's columns, where it may lack some, which is then only read.
  Table(SQLite::Database& db, std::string name, std::vector<std::string> keys,
        const std::set<std::string>* stored = nullptr)
      : db_(db), name_(std::move(name)), keys_(std::move(keys)), names_(column_names<R>({}, stored)) {}

  template <class... K>
  void insert(const R& record, const K&... key) {
    std::string names;
    for (std::size_t i = 0; i < sizeof...(K); ++i) names += keys_[i] + ", ";
    if (!insert_) insert_.emplace(db_, insert_sql(name_, names + names_));
    insert_->reset();
    bind_record(*insert_, bind_keys(*insert_, 1, key...), record);
    insert_->exec();
  }
  template <class... K>
  void update(const R& record, const K&... key) {
    std::string places;
    for (std::size_t i = 0; i < definitions<R>().size(); ++i) places += places.empty() ? "?" : ", ?";
    SQLite::Statement s(
        db_, "UPDATE " + name_ + " SET (" + names_ + ") = (" + places + ")" + where_sql(keys_, sizeof...(K)));
    bind_keys(s, bind_record(s, 1, record), key...);
    s.exec();
  }
  /// In the order of the keys.
  template <class... K>
  std::vector<R> all(const K&... key) const {
    std::string order;
    for (const std::string& name : keys_) order += (order.empty() ? " ORDER BY " : ", ") + name;
    SQLite::Statement s(db_, "SELECT " + names_ + " FROM " + name_ + where_sql(keys_, sizeof...(K)) + order);
    bind_keys(s, 1, key...);
    std::vector<R> records;
    while (s.executeStep()) records.push_back(read_record<R>(s, 0));
    return records;
  }
  template <class... K>
  std::optional<R> find(const K&... key) const {
    std::vector<R> records = all(key...);
    return records.empty() ? std::nullopt : std::optional<R>(std::move(records.front()));
  }
  template <class... K>
  void erase(const K&... key) {
    SQLite::Statement s(db_, "DELETE FROM " + name_ + where_sql(keys_, sizeof...(K)));
    bind_keys(s, 1, key...);
    s.exec();
  }

 private:
  template <class... K>
  static int bind_keys(SQLite::Statement& s, int first, const K&... key) {
    (field::bind(s, first++, key), ...);
    return first;
  }

  SQLite::Database& db_;
  std::string name_;
  std::vector<std::string> keys_;
  std::string names_;
  std::optional<SQLite::Statement> insert_;
};

}  // namespace moma::store
