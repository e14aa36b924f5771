#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "controller/describe/column.h"
#include "controller/describe/enumeration.h"
#include "eval/store/hash.h"

// Records as rows of the store. A record describes its columns once (controller/describe). The definition of its table
// follows here; eval/store/table.h reads and writes it.

namespace moma::store {

using Blob = std::vector<unsigned char>;

/// A column that is not a metric (metrics have a Column). The member's type decides the type in SQL: optional: may be
/// NULL; Hash: 16 bytes; bool: 0 or 1; enumeration: its word; list of numbers: JSON.
struct Field {
  std::string_view text = "";  ///< one line for the definition, without a full stop
  std::string_view rule = "";  ///< further SQL: "UNIQUE"; "DEFAULT 0" for a column added later
  bool json = false;           ///< the text is JSON
  bool bits = false;           ///< the list of numbers is stored as doubles, little endian
};

/// A column as CREATE TABLE has it.
struct ColumnDefinition {
  std::string name;
  std::string type;  ///< "INTEGER NOT NULL CHECK (cut IN (0, 1))"
  std::string text;
  bool later = false;  ///< placed after the others, as ALTER TABLE does
};

namespace field {

template <class M>
struct Optional : std::false_type {
  using type = M;
};
template <class M>
struct Optional<std::optional<M>> : std::true_type {
  using type = M;
};

template <class M>
inline constexpr bool is_list = std::same_as<M, std::vector<double>>;

template <class M>
constexpr std::string_view storage(bool bits) {
  if (std::is_floating_point_v<M>) return "REAL";
  if (std::is_integral_v<M>) return "INTEGER";
  return std::same_as<M, Hash> || std::same_as<M, Blob> || bits ? "BLOB" : "TEXT";
}

/// A condition on the column `name`; "" where its values need none.
template <class M>
std::string condition(const std::string& name, [[maybe_unused]] const Field& about) {
  if constexpr (std::same_as<M, bool>) return name + " IN (0, 1)";
  if constexpr (Worded<M>) return name + " IN (" + list_of_words<M>(", ", "'") + ")";
  if constexpr (std::same_as<M, Hash>) return "length(" + name + ") = 16";
  if constexpr (is_list<M>) return about.bits ? "" : "json_valid(" + name + ")";
  return about.json ? "json_valid(" + name + ")" : "";
}

template <class Member>
std::string type(const std::string& name, const Field& about) {
  using Kind = Optional<Member>;
  using M = typename Kind::type;
  std::string sql(storage<M>(about.bits));
  if (!Kind::value) sql += " NOT NULL";
  if (!about.rule.empty()) sql.append(" ").append(about.rule);
  std::string check = condition<M>(name, about);
  if (check.empty()) return sql;
  if (Kind::value && about.json) check = name + " IS NULL OR " + check;
  return sql + " CHECK (" + check + ")";
}

template <class M>
std::string type(const std::string& name, [[maybe_unused]] const Column& about) {
  if constexpr (Worded<M>) return type<M>(name, Field{});
  if (std::same_as<M, double>) return about.always ? "REAL NOT NULL" : "REAL";
  if (std::same_as<M, std::string>) return "TEXT";
  switch (about.earlier) {
    case Earlier::kNone:
      return "INTEGER NOT NULL";
    case Earlier::kZero:
      return "INTEGER NOT NULL DEFAULT 0";
    case Earlier::kUnknown:
      return "INTEGER";
  }
  return "";
}

inline std::string text(const Field& about) { return std::string(about.text); }
inline std::string text(const Column& about) {
  return (about.unit.empty() ? "" : "[" + std::string(about.unit) + "] ") + std::string(about.text);
}
inline bool later(const Field&) { return false; }
inline bool later(const Column& about) { return about.earlier == Earlier::kUnknown; }

}  // namespace field

/// The columns of R's table, in the order of its description.
template <class R>
std::vector<ColumnDefinition> definitions() {
  std::vector<ColumnDefinition> columns;
  for_members<R>([&]<class M, class C>(std::string_view name, M C::*, const auto& about) {
    const std::string as(name);
    columns.push_back({as, field::type<M>(as, about), field::text(about), field::later(about)});
  });
  return columns;
}

}  // namespace moma::store
