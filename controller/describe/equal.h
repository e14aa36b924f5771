#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <string_view>

#include "controller/describe/describe.h"
#include "controller/describe/kinds.h"

namespace moma {

/// True if two values are equal in every described member, including switched-off parts. NaN equals NaN.
template <class T>
bool same(const T& a, const T& b);

namespace description {

template <class T>
class Comparison {
 public:
  Comparison(const T& a, const T& b) : a_(a), b_(b) {}

  template <class P>
  void member(std::string_view, P pointer, const About&) {
    compare(pointer);
  }
  template <class P, class E>
  void optional(std::string_view, P pointer, E enabled, Off, std::string_view) {
    compare(pointer);
    equal_ = equal_ && (a_.*pointer).*enabled == (b_.*pointer).*enabled;
  }
  template <class P>
  void inlined(P pointer) {
    compare(pointer);
  }
  template <class Body>
  void group(std::string_view, std::string_view, Body body) {
    body(*this);
  }
  template <class Holds, class Body>
  void written_where(Holds, Body body) {
    body(*this);
  }

  bool equal() const { return equal_; }

 private:
  template <class P>
  void compare(P pointer) {
    equal_ = equal_ && same(a_.*pointer, b_.*pointer);
  }
  const T& a_;
  const T& b_;
  bool equal_ = true;
};

}  // namespace description

template <class T>
bool same(const T& a, const T& b) {
  if constexpr (Described<T>) {
    description::Comparison<T> comparison(a, b);
    describe(comparison, Of<T>{});
    return comparison.equal();
  } else if constexpr (std::same_as<T, double>) {
    return a == b || (a != a && b != b);
  } else if constexpr (HasAlternative<T>) {
    constexpr auto either = alternative(Of<T>{});
    return a.*(either.flag) == b.*(either.flag) && same(a.*(either.value), b.*(either.value));
  } else if constexpr (Numbers<T>) {
    const auto x = numbers_of(a), y = numbers_of(b);
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), same<double>);
  } else if constexpr (std::same_as<T, Eigen::Isometry3d>) {
    return a.matrix() == b.matrix();
  } else if constexpr (is_std_optional<T>) {
    return a.has_value() == b.has_value() && (!a.has_value() || same(*a, *b));
  } else if constexpr (is_std_vector<T>) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same<typename T::value_type>);
  } else {
    return a == b;
  }
}

}  // namespace moma
