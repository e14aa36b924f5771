#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/config/reader.h"
#include "controller/describe/accepted.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "controller/describe/kinds.h"

namespace moma::config {

/// Reads the described members of `value` among the keys of a map. Members whose key is absent stay as they are.
///
///   MapReader in(node, key);
///   read_members(in, suite.success);       // what is described,
///   in.read("seed", suite.seed);           // what stands beside it,
///   in.finish();                           // and nothing else
///
/// Errors name file, line, key, what was found and what would be accepted. Beside a type that is neither a plain value
/// nor described there has to stand (found by argument-dependent lookup, in moma or in the type's namespace)
///   void read_value(const Node& node, const std::string& key, T& value, const About& about)
/// which wins over everything else; write_described.h has its counterpart.
template <Described T>
void read_members(MapReader& in, T& value, const Lengths& lengths = {});

/// Reads a map that has no other keys than those of `value`: read_members() and finish().
template <Described T>
void read_described(const Node& node, const std::string& key, T& value, const Lengths& lengths = {});

namespace description {

bool is_word(const Node& node, std::string_view word);
/// A list, of `count` numbers where that is not negative; with `one_for_all` also one number for as many.
std::vector<double> read_list(const Node& node, const std::string& key, int count, const About& about);
/// Throws where a text stands that is no number: the message says that `word` would have been one.
void refuse_other_words(const Node& node, const std::string& key, std::string_view word, const std::string& accepted);

template <class V>
void read_any(const Node& node, const std::string& key, V& value, const About& about, const Lengths& lengths) {
  if constexpr (requires { read_value(node, key, value, about); }) {
    read_value(node, key, value, about);
  } else if constexpr (Described<V>) {
    if constexpr (HasFromWord<V>) {
      if (node.kind == Node::Kind::kScalar && from_word(node.scalar, value)) return;
    }
    read_described(node, key, value, lengths);
  } else if constexpr (std::same_as<V, double>) {
    value = read_number(node, key, about.range);
  } else if constexpr (std::same_as<V, bool>) {
    value = read_bool(node, key);
  } else if constexpr (WholeNumber<V>) {
    const auto [low, high] = whole_range<V>(about.range);
    value = static_cast<V>(read_integer(node, key, low, high));
  } else if constexpr (std::same_as<V, std::string>) {
    value = read_string(node, key);
  } else if constexpr (Worded<V>) {
    value = read_word<V>(node, key);
  } else if constexpr (Numbers<V>) {
    const int count = fixed_length<V> > 0 ? fixed_length<V> : lengths.of(about.per);
    const std::vector<double> list = read_list(node, key, count, about);
    if constexpr (requires { value.resize(list.size()); })
      value.resize(static_cast<decltype(value.size())>(list.size()));
    std::copy(list.begin(), list.end(), value.data());
  } else if constexpr (HasAlternative<V>) {
    constexpr auto either = alternative(Of<V>{});
    auto& plain = value.*(either.value);
    value.*(either.flag) = is_word(node, either.word);
    if (value.*(either.flag)) return;
    refuse_other_words(node, key, either.word, accepted_as<std::remove_cvref_t<decltype(plain)>>(about, lengths));
    read_any(node, key, plain, about, lengths);
  } else if constexpr (is_std_optional<V>) {
    typename V::value_type inner = value.value_or(typename V::value_type{});
    read_any(node, key, inner, about, lengths);
    value = std::move(inner);
  } else {
    static_assert(is_std_vector<V>, "a type that is not described needs a read_value() beside it");
    V list;
    for_items(node, key, "a list", [&](const Node& item, const std::string& at) {
      typename V::value_type inner{};
      read_any(item, at, inner, about, lengths);
      list.push_back(std::move(inner));
    });
    value = std::move(list);
  }
}

template <class T>
class Reading {
 public:
  Reading(MapReader& in, T& value, const Lengths& lengths) : in_(in), value_(value), lengths_(lengths) {}

  template <class P>
  void member(std::string_view name, P pointer, const About& about) {
    using V = std::remove_cvref_t<decltype(value_.*pointer)>;
    if (about.required) in_.require(name, accepted_as<V>(about, lengths_));
    if (const Node* node = in_.get(name)) read_any(*node, in_.key_of(name), value_.*pointer, about, lengths_);
  }
  template <class P, class E>
  void optional(std::string_view name, P pointer, E enabled, Off, std::string_view) {
    auto& part = value_.*pointer;
    const Node* node = in_.get(name);
    if (node == nullptr) return;
    if (is_word(*node, "none")) {
      part.*enabled = false;
      return;
    }
    MapReader map(*node, in_.key_of(name));
    part.*enabled = true;
    map.read("enabled", part.*enabled);
    read_members(map, part, lengths_);
    map.finish();
  }
  template <class P>
  void inlined(P pointer) {
    read_members(in_, value_.*pointer, lengths_);
  }
  template <class Body>
  void group(std::string_view name, std::string_view, Body body) {
    const Node* node = in_.get(name);
    if (node == nullptr) return;
    MapReader map(*node, in_.key_of(name));
    Reading inner(map, value_, lengths_);
    body(inner);
    map.finish();
  }
  template <class Holds, class Body>
  void written_where(Holds, Body body) {
    body(*this);
  }

 protected:
  MapReader& in_;
  T& value_;

 private:
  const Lengths lengths_;
};

}  // namespace description

template <Described T>
void read_members(MapReader& in, T& value, const Lengths& lengths) {
  description::Reading<T> reading(in, value, lengths);
  describe(reading, Of<T>{});
}

template <Described T>
void read_described(const Node& node, const std::string& key, T& value, const Lengths& lengths) {
  MapReader in(node, key);
  read_members(in, value, lengths);
  in.finish();
}

}  // namespace moma::config
