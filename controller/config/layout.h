#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "controller/config/json.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "controller/describe/numbers.h"

namespace moma::config {

/// Returns the place of each described member among the numbers of pack() (describe/numbers.h), for readers and writers
/// without C++: docs/reference/process-protocol.md, "Layout", has the keys. A pose becomes its "position" and
/// "rotation", a member of an optional record `covariance` "position_covariance". D names the members of T.
template <class T, class D = T>
Json layout_of(const Lengths& lengths);

namespace layout {

template <class V>
Json shape_of(std::size_t count) {
  if constexpr (numbers::is_scalar<V>) return Json::array();
  if constexpr (numbers::is_matrix<V>) return {3, 3};
  return Json::array({count});
}

/// A list of numbers with null for those that are not finite.
inline Json finite_or_null(std::span<const double> values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(std::isfinite(value) ? Json(value) : Json());
  return list;
}

template <class V>
Json otherwise_of(const V& value) {
  std::array<double, fixed_numbers<V>() + 1> all{};
  pack(value, all.data());
  return finite_or_null({all.data(), fixed_numbers<V>()});
}

template <class T>
class Listing {
 public:
  Listing(const Lengths& lengths, std::size_t lists) : lengths_(lengths), lists_(lists) {}

  template <class P>
  void member(std::string_view name, P pointer, const About& about) {
    const T defaults{};
    using V = std::remove_cvref_t<decltype(defaults.*pointer)>;
    const auto& value = defaults.*pointer;
    if constexpr (NumberList<V>) {
      const auto count = static_cast<std::size_t>(lengths_.of(about.per));
      add<V>(name, lists_, count, about);
      lists_ += count;
    } else if constexpr (is_std_vector<V>) {
      add_record<typename V::value_type>(name, lists_, about);
      members.back()["list"] = true;
    } else if constexpr (numbers::is_pose<V>) {
      put("position", Eigen::Vector3d(value.translation()), {.unit = "m"});
      put("rotation", Eigen::Matrix3d(value.linear()), {.text = "3 x 3, by rows"});
      members.back()["rotation"] = true;
    } else if constexpr (is_std_optional<V>) {
      using W = typename V::value_type;
      for (Json part : layout_of<W>(lengths_)) {
        part["name"] = part["name"].template get<std::string>() + "_" + std::string(name);
        part["at"] = part["at"].template get<std::size_t>() + fixed_ + 1;
        part["given"] = fixed_;
        members.push_back(std::move(part));
      }
      fixed_ += fixed_numbers<V>();
    } else if constexpr (Described<V>) {
      add_record<V>(name, fixed_, about);
      fixed_ += fixed_numbers<V>();
    } else {
      put(name, value, about);
    }
  }
  template <class P>
  void inlined(P pointer) {
    using V = std::remove_cvref_t<decltype(std::declval<T>().*pointer)>;
    for (Json part : layout_of<V>(lengths_)) {
      part["at"] = part["at"].template get<std::size_t>() + fixed_;
      members.push_back(std::move(part));
    }
    fixed_ += fixed_numbers<V>();
  }

  Json members = Json::array();

 private:
  template <class V>
  void put(std::string_view name, const V& value, const About& about) {
    add<V>(name, fixed_, fixed_numbers<V>(), about);
    members.back()["otherwise"] = otherwise_of(value);
    fixed_ += fixed_numbers<V>();
  }
  template <class V>
  void add(std::string_view name, std::size_t at, std::size_t count, const About& about) {
    Json member = {{"name", name}, {"at", at}, {"count", count}, {"shape", shape_of<V>(count)}};
    if constexpr (std::is_same_v<V, bool>) member["truth"] = true;
    if constexpr (WholeNumber<V>) member["whole"] = true;
    if constexpr (Worded<V>) member["words"] = words(Of<V>{});
    say(member, about);
    members.push_back(std::move(member));
  }
  template <class V>
  void add_record(std::string_view name, std::size_t at, const About& about) {
    Json member = {{"name", name}, {"at", at}, {"count", fixed_numbers<V>()}, {"members", layout_of<V>(lengths_)}};
    say(member, about);
    members.push_back(std::move(member));
  }
  static void say(Json& member, const About& about) {
    if (!about.unit.empty()) member["unit"] = about.unit;
    if (!about.text.empty()) member["text"] = about.text;
  }

  const Lengths& lengths_;
  std::size_t fixed_ = 0;
  std::size_t lists_;
};

}  // namespace layout

template <class T, class D>
Json layout_of(const Lengths& lengths) {
  layout::Listing<T> listing(lengths, fixed_numbers<D>());
  describe(listing, Of<D>{});
  return std::move(listing.members);
}

}  // namespace moma::config
