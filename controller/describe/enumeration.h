#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "controller/describe/describe.h"

namespace moma {

/// The words of an enumeration, defined beside it, in the order of its values, which count from 0:
///
///   constexpr auto words(Of<Outcome>) { return std::to_array<std::string_view>({"success", "collision", ...}); }
///
/// Files, messages, columns and checks of the store use them.
template <class E>
concept Worded = std::is_enum_v<E> && requires {
  words(Of<E>{});
};

namespace enumeration {

template <auto value>
constexpr bool is_named() {
  // Compilers print a value without an enumerator as a cast: "(moma::Outcome)9".
  constexpr std::string_view text = __PRETTY_FUNCTION__;
  constexpr std::size_t at = text.find("value = ");
  static_assert(at != std::string_view::npos);
  return text[at + 8] != '(';
}

}  // namespace enumeration

/// True if `words` has one word for each enumerator. to_string() and from_string() assert it.
template <Worded E>
constexpr bool all_worded() {
  constexpr std::size_t n = words(Of<E>{}).size();
  return n > 0 && enumeration::is_named<static_cast<E>(n - 1)>() && !enumeration::is_named<static_cast<E>(n)>();
}

template <Worded E>
constexpr std::string_view to_string(E value) noexcept {
  static_assert(all_worded<E>());
  constexpr auto all = words(Of<E>{});
  const auto i = static_cast<std::size_t>(value);
  // A copy of a literal's view stays valid: the words have static storage.
  return i < all.size() ? all[i] : std::string_view("?");
}

template <Worded E>
constexpr std::optional<E> from_string(std::string_view text) noexcept {
  static_assert(all_worded<E>());
  constexpr auto all = words(Of<E>{});
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i] == text) return static_cast<E>(i);
  return {};
}

/// "a, b, c": the items of a range, or what `text` makes of each.
template <class Range, class Text = std::identity>
std::string joined(const Range& items, Text text = {}, std::string_view separator = ", ") {
  std::string list;
  for (const auto& item : items) {
    if (!list.empty()) list += separator;
    list += std::invoke(text, item);
  }
  return list;
}

/// The same of an enumeration's words, for messages and checks of a column.
template <Worded E>
std::string list_of_words(std::string_view separator = ", ", std::string_view quote = "") {
  const std::string mark(quote);
  return joined(
      words(Of<E>{}), [&](std::string_view word) { return mark + std::string(word) + mark; }, separator);
}

}  // namespace moma
