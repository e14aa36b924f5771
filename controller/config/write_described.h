#pragma once

#include <string>
#include <string_view>

#include "controller/config/json_node.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "controller/describe/equal.h"
#include "controller/describe/kinds.h"

namespace moma::config {

/// The described members in their order, as read_described() takes them back: what is written is read to the same bits,
/// and what is left out was at its default, or belongs to a part that is off (Off, Written).
///
/// Beside a type that is neither a plain value nor described there has to stand
///   Json write_value(const T& value, const About& about)
/// in moma or in the type's namespace; it wins over everything else.
template <Described T>
Json write_described(const T& value);

/// Adds the described members to an object that may have keys already.
template <Described T>
void write_members(const T& value, Json& json);

namespace description {

Json list_to_json(std::span<const double> values, bool one_for_all = false);

template <class V>
Json any_to_json(const V& value, const V& otherwise, const About& about);

template <class T>
class Writing {
 public:
  Writing(const T& value, const T& otherwise, Json& json) : value_(value), json_(json), otherwise_(otherwise) {}

  template <class P>
  void member(std::string_view name, P pointer, const About& about) {
    const auto& value = value_.*pointer;
    if constexpr (is_std_optional<std::remove_cvref_t<decltype(value)>>) {
      if (!value.has_value()) return;
    }
    if (about.written == Written::kUnlessDefault && same(value, otherwise_.*pointer)) return;
    put(name, any_to_json(value, otherwise_.*pointer, about));
  }
  template <class P, class E>
  void optional(std::string_view name, P pointer, E enabled, Off off, std::string_view) {
    const auto& part = value_.*pointer;
    if (!(part.*enabled) && off != Off::kKept) {
      if (off == Off::kNone) put(name, "none");
      return;
    }
    Json map = Json::object();
    if (off == Off::kKept) map["enabled"] = part.*enabled;
    nested(part, otherwise_.*pointer, map);
    put(name, std::move(map));
  }
  template <class P>
  void inlined(P pointer) {
    nested(value_.*pointer, otherwise_.*pointer, json_);
  }
  template <class Body>
  void group(std::string_view name, std::string_view, Body body) {
    Json map = Json::object();
    Writing inner(value_, otherwise_, map);
    body(inner);
    if (!map.empty()) put(name, std::move(map));
  }
  template <class Holds, class Body>
  void written_where(Holds holds, Body body) {
    if (holds(value_)) body(*this);
  }

 protected:
  const T& value_;
  Json& json_;

 private:
  void put(std::string_view name, Json value) { json_[std::string(name)] = std::move(value); }
  template <class V>
  static void nested(const V& value, const V& otherwise, Json& json) {
    Writing<V> inner(value, otherwise, json);
    describe(inner, Of<V>{});
  }

  const T& otherwise_;
};

template <class V>
Json any_to_json(const V& value, const V& otherwise, const About& about) {
  if constexpr (requires { write_value(value, about); }) {
    return write_value(value, about);
  } else if constexpr (Described<V>) {
    Json map = Json::object();
    Writing<V> inner(value, otherwise, map);
    describe(inner, Of<V>{});
    return map;
  } else if constexpr (std::same_as<V, double>) {
    return number_to_json(value);
  } else if constexpr (std::same_as<V, bool> || WholeNumber<V> || std::same_as<V, std::string>) {
    return value;
  } else if constexpr (Worded<V>) {
    return to_string(value);
  } else if constexpr (Numbers<V>) {
    return list_to_json(numbers_of(value), about.one_for_all);
  } else if constexpr (HasAlternative<V>) {
    constexpr auto either = alternative(Of<V>{});
    if (value.*(either.flag)) return either.word;
    return any_to_json(value.*(either.value), otherwise.*(either.value), about);
  } else if constexpr (is_std_optional<V>) {
    using W = typename V::value_type;
    return value.has_value() ? any_to_json(*value, otherwise.value_or(W{}), about) : Json(nullptr);
  } else {
    static_assert(is_std_vector<V>, "a type that is not described needs a write_value() beside it");
    Json list = Json::array();
    const typename V::value_type plain{};
    for (const auto& item : value) list.push_back(any_to_json<typename V::value_type>(item, plain, about));
    return list;
  }
}

}  // namespace description

template <Described T>
void write_members(const T& value, Json& json) {
  const T otherwise{};
  description::Writing<T> writing(value, otherwise, json);
  describe(writing, Of<T>{});
}

template <Described T>
Json write_described(const T& value) {
  Json json = Json::object();
  write_members(value, json);
  return json;
}

}  // namespace moma::config
