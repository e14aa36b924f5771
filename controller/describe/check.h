#pragma once

#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/describe/accepted.h"
#include "controller/describe/describe.h"
#include "controller/describe/kinds.h"
#include "controller/describe/look.h"

namespace moma {

/// A value that violates its description: "must be a finite number above 0, is -1".
struct Violation {
  std::string key;  ///< dotted, as in the files
  std::string message;
};

/// Checks a struct that code has filled: numbers outside their range, lists of a wrong length, values without an
/// enumerator. Covers parts that are switched off, and values behind a word (alternative()), which have been filled in.
/// Empty if all is well.
template <Described T>
std::vector<Violation> violations(const T& value, const Lengths& lengths = {});

namespace description {

/// Returns a number with six significant digits, for messages.
std::string short_text(double value);
/// "" if the number is in the range.
std::string number_violation(double value, const Range& range);
std::string whole_number_violation(long long value, long long low, long long high);
/// Returns the first violation.
std::string numbers_violation(std::span<const double> values, int count, const About& about);

template <class T>
class Check : public Look<Check<T>, T> {
 public:
  Check(const T& value, const Lengths& lengths, std::string prefix, std::vector<Violation>& found)
      : Look<Check, T>(value, std::move(prefix)), lengths_(lengths), found_(found) {}

  template <class P>
  void member(std::string_view name, P pointer, const About& about) {
    check(key_of(name), value_.*pointer, about);
  }
  template <class P, class E>
  void optional(std::string_view name, P pointer, E, Off, std::string_view) {
    check(key_of(name), value_.*pointer, {});
  }

 private:
  friend class Look<Check, T>;
  using Look<Check, T>::key_of;
  using Look<Check, T>::value_;

  Check below(std::string key) const { return {value_, lengths_, std::move(key), found_}; }
  template <class V>
  void descend(const std::string& key, const V& value) {
    Check<V> inner(value, lengths_, key, found_);
    describe(inner, Of<V>{});
  }
  void note(const std::string& key, std::string message) {
    if (!message.empty()) found_.push_back({key, std::move(message)});
  }
  template <class V>
  void check(const std::string& key, const V& value, const About& about) {
    if constexpr (Described<V>) {
      descend(key, value);
    } else if constexpr (std::same_as<V, double>) {
      note(key, number_violation(value, about.range));
    } else if constexpr (WholeNumber<V>) {
      const auto [low, high] = whole_range<V>(about.range);
      note(key, whole_number_violation(static_cast<long long>(value), low, high));
    } else if constexpr (Worded<V>) {
      if (static_cast<std::size_t>(value) >= words(Of<V>{}).size()) note(key, "must be " + accepted_as<V>(about));
    } else if constexpr (Numbers<V>) {
      const int count = fixed_length<V> > 0 ? -1 : lengths_.of(about.per);
      note(key, numbers_violation(numbers_of(value), count, about));
    } else if constexpr (HasAlternative<V>) {
      check(key, value.*(alternative(Of<V>{}).value), about);
    } else if constexpr (is_std_optional<V>) {
      if (value.has_value()) check(key, *value, about);
    } else if constexpr (is_std_vector<V>) {
      for (std::size_t i = 0; i < value.size(); ++i) check(key + "[" + std::to_string(i) + "]", value[i], about);
    }
  }

  const Lengths& lengths_;
  std::vector<Violation>& found_;
};

}  // namespace description

template <Described T>
std::vector<Violation> violations(const T& value, const Lengths& lengths) {
  std::vector<Violation> found;
  description::Check<T> check(value, lengths, "", found);
  describe(check, Of<T>{});
  return found;
}

}  // namespace moma
