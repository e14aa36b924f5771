#pragma once

#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "controller/describe/accepted.h"
#include "controller/describe/describe.h"
#include "controller/describe/kinds.h"
#include "controller/describe/look.h"

namespace moma {

/// A key of a file, for tables in the reference, completion, and suggestions for unknown keys.
struct Key {
  std::string name;       ///< dotted: "collision.floor.gain"
  std::string unit;       ///< "" without a unit
  std::string accepted;   ///< "a number above 0", "one of: qp, rrmc", "none or a map"
  std::string otherwise;  ///< the default as written; "" without one, or for a map
  std::string text;       ///< one line for the reference
};

/// Returns all keys of T in the order of the file, including those of parts that are off by default. Defaults are those
/// of `defaults`: pass one resolved for a robot if the robot determines lengths of lists.
template <Described T>
std::vector<Key> keys_of(const T& defaults = {}, const std::string& prefix = "");

namespace description {

std::string list_text(std::span<const double> values, bool one_for_all);

/// Returns the value as written. A type of its own may define std::string text_of(const T&).
template <class T>
std::string default_text(const T& value, const About& about) {
  if constexpr (requires { text_of(value); }) {
    return text_of(value);
  } else if constexpr (std::same_as<T, double>) {
    return number_text(value);
  } else if constexpr (std::same_as<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (WholeNumber<T>) {
    return std::to_string(value);
  } else if constexpr (std::same_as<T, std::string>) {
    return value;
  } else if constexpr (Worded<T>) {
    return std::string(to_string(value));
  } else if constexpr (Numbers<T>) {
    return list_text(numbers_of(value), about.one_for_all);
  } else if constexpr (HasAlternative<T>) {
    constexpr auto either = alternative(Of<T>{});
    return value.*(either.flag) ? std::string(either.word) : default_text(value.*(either.value), about);
  } else if constexpr (is_std_optional<T>) {
    return value.has_value() ? default_text(*value, about) : "";
  } else {
    return "";
  }
}

template <class T>
class Listing : public Look<Listing<T>, T> {
 public:
  Listing(const T& defaults, std::string prefix, std::vector<Key>& keys)
      : Look<Listing, T>(defaults, std::move(prefix)), keys_(keys) {}

  template <class P>
  void member(std::string_view name, P pointer, const About& about) {
    using V = std::remove_cvref_t<decltype(value_.*pointer)>;
    if constexpr (Described<V>) {
      descend(key_of(name), value_.*pointer);
    } else {
      add(name, about, accepted_as<V>(about), about.required ? "" : default_text(value_.*pointer, about));
    }
  }
  template <class P, class E>
  void optional(std::string_view name, P pointer, E enabled, Off off, std::string_view text) {
    const auto& part = value_.*pointer;
    add(name, {.text = text}, "none or a map", part.*enabled ? "" : "none");
    if (off == Off::kKept) {
      keys_.push_back({key_of(name) + ".enabled", "", "true or false", part.*enabled ? "true" : "false",
                       "false keeps the other values and switches this off"});
    }
    descend(key_of(name), part);
  }

 private:
  friend class Look<Listing, T>;
  using Look<Listing, T>::key_of;
  using Look<Listing, T>::value_;

  Listing below(std::string key) const { return {value_, std::move(key), keys_}; }
  void add(std::string_view name, const About& about, std::string accepted, std::string otherwise) {
    keys_.push_back(
        {key_of(name), std::string(about.unit), std::move(accepted), std::move(otherwise), std::string(about.text)});
  }
  template <class V>
  void descend(const std::string& key, const V& defaults) {
    Listing<V> inner(defaults, key, keys_);
    describe(inner, Of<V>{});
  }

  std::vector<Key>& keys_;
};

}  // namespace description

template <Described T>
std::vector<Key> keys_of(const T& defaults, const std::string& prefix) {
  std::vector<Key> keys;
  description::Listing<T> listing(defaults, prefix, keys);
  describe(listing, Of<T>{});
  return keys;
}

}  // namespace moma
