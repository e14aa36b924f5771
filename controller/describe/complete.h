#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "controller/describe/describe.h"

namespace moma {

namespace description {

// Converts to a member of any type, but not to the aggregate itself, which would be a copy.
template <class Aggregate>
struct AnyMember {
  template <class M>
  requires(!std::same_as<std::remove_cvref_t<M>, Aggregate>) operator M() const noexcept;
};

template <class T, class Indices>
struct MembersFit;
template <class T, std::size_t... I>
struct MembersFit<T, std::index_sequence<I...>> {
  static constexpr bool value = requires { T{(static_cast<void>(I), AnyMember<T>{})...}; };
};

/// Counts the members of an aggregate without arrays: the largest number of values that its braces accept.
template <class T, std::size_t most = 64>
constexpr std::size_t count_members() {
  static_assert(std::is_aggregate_v<T>);
  if constexpr (most == 0 || MembersFit<T, std::make_index_sequence<most>>::value)
    return most;
  else
    return count_members<T, most - 1>();
}

/// Counts the members that a description names, and compares with all members, of T and of the described structs in it.
template <class T>
class Completeness {
 public:
  template <class V>
  constexpr void member(std::string_view, V T::*, const About&) {
    ++named_;
    below<V>(0);
  }
  template <class V>
  constexpr void optional(std::string_view, V T::*, bool V::*, Off, std::string_view) {
    ++named_;
    below<V>(1);  // its `enabled` has no line of its own
  }
  template <class V>
  constexpr void inlined(V T::*) {
    ++named_;
    below<V>(0);
  }
  template <class Body>
  constexpr void group(std::string_view, std::string_view, Body body) {
    body(*this);
  }
  template <class Holds, class Body>
  constexpr void written_where(Holds, Body body) {
    body(*this);
  }
  constexpr bool complete(std::size_t unnamed) const { return all_below_ && named_ + unnamed == count_members<T>(); }

 private:
  template <class V>
  constexpr void below(std::size_t unnamed) {
    if constexpr (Described<V>) {
      Completeness<V> inner;
      describe(inner, Of<V>{});
      all_below_ = all_below_ && inner.complete(unnamed);
    }
  }
  std::size_t named_ = 0;
  bool all_below_ = true;
};

}  // namespace description

/// True if the description of T, and of each described struct in it, names every member. Assert it below the
/// description, so that a forgotten member does not compile. For aggregates of at most 64 members, none of them an
/// array.
template <Described T>
constexpr bool is_complete() {
  description::Completeness<T> count;
  describe(count, Of<T>{});
  return count.complete(0);
}

}  // namespace moma
