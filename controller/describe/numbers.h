#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>

#include "controller/describe/describe.h"
#include "controller/describe/kinds.h"

namespace moma {

/// A described value as 64-bit floating-point numbers one after the other: what crosses to other processes, to shared
/// libraries and to Python (docs/reference/process-protocol.md).
///
/// First stand the members of fixed length, then the lists with a number for each joint or velocity, then lists of
/// described items, each in the order of the description. So the place of the first does not depend on the robot, nor
/// that of the lists on how many items there are. A truth is 1 or 0, a word its place in the list of words; a pose is
/// its position and its rotation by rows, a 3 x 3 matrix stands by rows; what is optional is a truth and then its
/// members, which mean nothing where it is 0. Texts are no numbers: nothing described here has any.

/// Number of a type's numbers, without lists.
template <class T>
constexpr std::size_t fixed_numbers();

/// Number of a type's lists with a number for each joint or velocity.
template <class T>
constexpr int number_lists();

/// Writes `value` to `to`. No allocation. Returns the end of what was written.
template <class T>
double* pack(const T& value, double* to) noexcept;
/// The same as far as `value` is no list of items.
template <class T>
double* pack_without_items(const T& value, double* to) noexcept;
/// Reads what pack() writes of a value whose lists are as long as those of `value`. No allocation. A number that is no
/// whole one becomes -1 where one is due: which is no word, and no count (describe/check.h).
template <class T>
const double* unpack(const double* from, T& value) noexcept;
/// Number of numbers that pack() writes.
template <class T>
std::size_t count_numbers(const T& value) noexcept;

namespace numbers {

template <class V>
inline constexpr bool is_scalar = std::is_arithmetic_v<V> || std::is_enum_v<V>;
template <class V>
inline constexpr bool is_pose = std::is_same_v<V, Eigen::Isometry3d>;
template <class V>
inline constexpr bool is_matrix = std::is_same_v<V, Eigen::Matrix3d>;

enum class Part { kFixed, kLists, kItems };
template <class V>
inline constexpr Part part_of = NumberList<V>      ? Part::kLists
                                : is_std_vector<V> ? Part::kItems
                                                   : Part::kFixed;

struct Count {
  template <class V, class C>
  constexpr void member(std::string_view, V C::*, const About&) {
    count += fixed_numbers<V>();
  }
  template <class V, class C>
  constexpr void inlined(V C::*) {
    count += fixed_numbers<V>();
  }
  std::size_t count = 0;
};

template <class V>
V from_number(double x) noexcept {
  if constexpr (std::is_floating_point_v<V>) {
    return x;
  } else if constexpr (std::is_same_v<V, bool>) {
    return x != 0.0;
  } else {
    constexpr double kMost = std::numeric_limits<std::int32_t>::max();
    return static_cast<V>(std::abs(x) <= kMost && x == std::floor(x) ? static_cast<std::int32_t>(x) : -1);
  }
}

template <class Number, class V>
void cross(Number*& at, V& value) noexcept;

/// Takes the members of one part from or to `at`: Number is double to write, const double to read.
template <class Number, class T>
class Crossing {
 public:
  Crossing(Number*& at, T& value, Part part) : at_(at), value_(value), part_(part) {}
  template <class P>
  void member(std::string_view, P pointer, const About&) {
    auto& member = value_.*pointer;
    if (part_of<std::remove_cvref_t<decltype(member)>> == part_) cross(at_, member);
  }
  template <class P>
  void inlined(P pointer) {
    if (part_ == Part::kFixed) cross(at_, value_.*pointer);
  }

 private:
  Number*& at_;
  T& value_;
  Part part_;
};

template <class D, class Number, class T>
void cross_part(Number*& at, T& value, Part part) noexcept {
  Crossing<Number, T> crossing(at, value, part);
  describe(crossing, Of<D>{});
}

template <class Number, class V>
void cross(Number*& at, V& value) noexcept {
  using T = std::remove_const_t<V>;
  constexpr bool writes = !std::is_const_v<Number>;
  const auto number = [&at](auto&& x) {
    if constexpr (writes)
      *at++ = x;
    else
      x = *at++;
  };
  const auto matrix = [&number](auto&& R) {
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) number(R(row, column));
  };
  if constexpr (is_scalar<T>) {
    if constexpr (writes)
      *at++ = static_cast<double>(value);
    else
      value = from_number<T>(*at++);
  } else if constexpr (is_pose<T>) {
    for (int axis = 0; axis < 3; ++axis) number(value.translation()[axis]);
    matrix(value.linear());
  } else if constexpr (is_matrix<T>) {
    matrix(value);
  } else if constexpr (Numbers<T>) {
    for (auto& x : value) number(x);
  } else if constexpr (is_std_optional<T>) {
    typename T::value_type inner{};
    if constexpr (writes) {
      number(value.has_value() ? 1.0 : 0.0);
      if (value.has_value()) inner = *value;
      cross(at, inner);
    } else {
      const bool given = *at++ != 0.0;
      cross(at, inner);
      value.reset();
      if (given) value = inner;
    }
  } else if constexpr (is_std_vector<T>) {
    for (auto& item : value) cross(at, item);
  } else {
    for (const Part part : {Part::kFixed, Part::kLists, Part::kItems}) cross_part<T>(at, value, part);
  }
}

/// Counts the numbers in lists of a value.
template <class T>
struct CountLists {
  const T& value;
  std::size_t count = 0;
  template <class P>
  void member(std::string_view, P pointer, const About&) {
    const auto& list = value.*pointer;
    using V = std::remove_cvref_t<decltype(list)>;
    if constexpr (NumberList<V>) count += static_cast<std::size_t>(list.size());
    if constexpr (is_std_vector<V>) count += list.size() * fixed_numbers<typename V::value_type>();
  }
  template <class P>
  void inlined(P) {}
};

}  // namespace numbers

template <class T>
constexpr std::size_t fixed_numbers() {
  if constexpr (numbers::part_of<T> != numbers::Part::kFixed) {
    return 0;
  } else if constexpr (numbers::is_scalar<T>) {
    return 1;
  } else if constexpr (numbers::is_pose<T>) {
    return 12;
  } else if constexpr (numbers::is_matrix<T>) {
    return 9;
  } else if constexpr (Numbers<T>) {
    return fixed_length<T>;
  } else if constexpr (is_std_optional<T>) {
    return 1 + fixed_numbers<typename T::value_type>();
  } else {
    numbers::Count count;
    describe(count, Of<T>{});
    return count.count;
  }
}

template <class T>
constexpr int number_lists() {
  int count = 0;
  for_members<T>([&count]<class V>(std::string_view, V T::*, const About&) { count += NumberList<V> ? 1 : 0; });
  return count;
}

template <class T>
double* pack(const T& value, double* to) noexcept {
  numbers::cross(to, value);
  return to;
}

template <class T>
double* pack_without_items(const T& value, double* to) noexcept {
  numbers::cross_part<T>(to, value, numbers::Part::kFixed);
  numbers::cross_part<T>(to, value, numbers::Part::kLists);
  return to;
}

/// The fixed members that another description than that of T's own names (Details of StepResult).
template <class D, class T>
void pack_part(const T& value, double* to) noexcept {
  numbers::cross_part<D>(to, value, numbers::Part::kFixed);
}
template <class D, class T>
void unpack_part(const double* from, T& value) noexcept {
  numbers::cross_part<D>(from, value, numbers::Part::kFixed);
}

template <class T>
const double* unpack(const double* from, T& value) noexcept {
  numbers::cross(from, value);
  return from;
}

template <class T>
std::size_t count_numbers(const T& value) noexcept {
  numbers::CountLists<T> lists{value};
  describe(lists, Of<T>{});
  return fixed_numbers<T>() + lists.count;
}

}  // namespace moma
