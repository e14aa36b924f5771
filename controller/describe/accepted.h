#pragma once

#include <string>

#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "controller/describe/kinds.h"

namespace moma {

/// Returns a number as the shortest text that reads back the same; ".inf" and "-.inf".
std::string number_text(double value);

/// Describes accepted values, for messages and tables: "a number above 0", "a whole number from 0 to 10".
std::string accepted_number(const Range& range);
/// Omits the type's limits if `range` does not reach them.
std::string accepted_whole_number(long long low, long long high);
/// "a list of 7 numbers"; with `one_for_all`, "a number of at least 0 or a list of 7 numbers".
std::string accepted_numbers(int count, const About& about);

/// The whole numbers of `range` that T can hold.
template <WholeNumber T>
constexpr std::pair<long long, long long> whole_range(const Range& range) {
  constexpr auto type_low = static_cast<long long>(std::numeric_limits<T>::min());
  constexpr long long type_high = std::numeric_limits<T>::digits >= 63
                                      ? std::numeric_limits<long long>::max()
                                      : static_cast<long long>(std::numeric_limits<T>::max());
  long long low = type_low, high = type_high;
  if (range.low > static_cast<double>(type_low)) low = static_cast<long long>(range.low) + (range.open_low ? 1 : 0);
  if (range.high < static_cast<double>(type_high))
    high = static_cast<long long>(range.high) - (range.open_high ? 1 : 0);
  return {low, high};
}

/// Describes the accepted values of a member of type T. A type of its own may define
///   std::string accepted(Of<T>, const About&)
template <class T>
std::string accepted_as(const About& about, const Lengths& lengths = {}) {
  if constexpr (requires { accepted(Of<T>{}, about); }) {
    return accepted(Of<T>{}, about);
  } else if constexpr (std::same_as<T, double>) {
    return accepted_number(about.range);
  } else if constexpr (std::same_as<T, bool>) {
    return "true or false";
  } else if constexpr (WholeNumber<T>) {
    const auto [low, high] = whole_range<T>(about.range);
    return accepted_whole_number(low, high);
  } else if constexpr (std::same_as<T, std::string>) {
    return "text";
  } else if constexpr (Worded<T>) {
    return "one of: " + list_of_words<T>();
  } else if constexpr (Numbers<T>) {
    return accepted_numbers(fixed_length<T> > 0 ? fixed_length<T> : lengths.of(about.per), about);
  } else if constexpr (HasAlternative<T>) {
    constexpr auto either = alternative(Of<T>{});
    using V = std::remove_cvref_t<decltype(std::declval<T>().*(either.value))>;
    return std::string(either.word) + " or " + accepted_as<V>(about, lengths);
  } else if constexpr (is_std_optional<T>) {
    return accepted_as<typename T::value_type>(about, lengths);
  } else if constexpr (is_std_vector<T>) {
    return "a list";
  } else {
    return "a map";
  }
}

}  // namespace moma
