#pragma once

#include <concepts>
#include <limits>
#include <string_view>

namespace moma {

/// Range of accepted numbers. Closed by default; infinities are inside only if a bound is infinite.
struct Range {
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
  bool open_low = false;
  bool open_high = false;

  static constexpr Range any() { return {}; }
  static constexpr Range positive() { return {0.0, std::numeric_limits<double>::max(), true, false}; }
  static constexpr Range positive_or_inf() { return {0.0, std::numeric_limits<double>::infinity(), true, false}; }
  static constexpr Range non_negative() { return {0.0, std::numeric_limits<double>::max(), false, false}; }
  static constexpr Range non_negative_or_inf() { return {0.0, std::numeric_limits<double>::infinity(), false, false}; }

  /// False for NaN.
  constexpr bool contains(double value) const {
    return value >= low && value <= high && !(open_low && value == low) && !(open_high && value == high);
  }
};

/// One description for each struct: a function beside it that names its members, in the order of writing, with unit,
/// range and one line for the reference.
///
///   constexpr void describe(auto& v, Of<ServoParams>) {
///     v.member("position", &ServoParams::position, non_negative("1/s", "k_p"));
///     v.optional("slack", &ControllerParams::slack, &SlackParams::enabled, Off::kNone, "delta of the tracking rows");
///   }
///
/// Members are pointers to members, so that a visitor may hold one object (to read, write or check it), two (to compare
/// them, or a value with its default), or none (to list columns and keys). Readers, writers, range checks, columns,
/// wires and tables of keys follow from it: a new member needs its line here, and its use. The default is that of the
/// default-constructed struct.
///
/// Visitors: config/read_described.h (strict YAML), config/write_described.h (JSON), describe/check.h (ranges, for
/// structs that code has filled), describe/keys.h (tables of keys), describe/equal.h.
///
/// Functions of a visitor (functions that a description does not use may be missing):
///   member(name, pointer, About)                          a value: number, whole number, boolean, text, enumeration,
///                                                         vector, list, std::optional, or described
///   optional(name, pointer, &T::enabled, Off, text)       a described struct that may be switched off
///   inlined(pointer)                                      a described struct whose members are listed among these
///   group(name, text, [](auto& g) { g.member(...); })     members of this struct under a key of their own
///   written_where([](const T&) -> bool, [](auto& v) {})   members that are always read, and written only if the first
///                                                         function returns true for the object
///
/// Optional functions beside a type (found by argument-dependent lookup):
///   constexpr auto alternative(Of<T>) { return WordOr{"word", &T::flag, &T::value}; }
///     if T as a whole is a value that a word may replace: the word stands for a set flag;
///   bool from_word(std::string_view word, T& value)
///     if a word may replace all of a described struct; false for an unknown word.
template <class T>
struct Of {
  using type = T;
};

/// When a writer omits a member. Trial keys are digests of the written text: later members are written only if they
/// differ from their defaults, so that the keys of trials without them do not change.
enum class Written { kAlways, kUnlessDefault };

/// Form of an `optional` that is switched off. All forms are readable: none, or a map, which switches it on unless it
/// has `enabled: false`. Only kKept preserves the values of a part that is off.
enum class Off {
  kNone,     ///< as the word none
  kOmitted,  ///< omitted
  kKept,     ///< in full, with `enabled: false`; if on, with `enabled: true`
};

/// Owners of a list's values, if the robot determines its length.
enum class Per { kNothing, kJoint, kVelocity };

/// The robot's numbers; negative without a robot, and lists may then have any length.
struct Lengths {
  int joints = -1;
  int velocities = -1;

  constexpr int of(Per per) const { return per == Per::kJoint ? joints : per == Per::kVelocity ? velocities : -1; }
};

struct About {
  std::string_view unit = "";  ///< SI or `1`: "m", "rad/s"; for joints "rad or m"; "" without a unit
  Range range = {};            ///< of a number, or of each number of a list
  Per per = Per::kNothing;     ///< of a list
  bool one_for_all = false;    ///< of a list: one number may replace equal ones, and is written so
  bool required = false;       ///< for readers: no default
  Written written = Written::kAlways;
  std::string_view text = "";  ///< one line for the reference, without a full stop
};

/// Forms of About for numbers. `unit` is "" where there is none.
constexpr About in_range(Range range, std::string_view unit, std::string_view text) {
  return {.unit = unit, .range = range, .text = text};
}
constexpr About quantity(std::string_view unit, std::string_view text) { return in_range({}, unit, text); }
constexpr About positive(std::string_view unit, std::string_view text) {
  return in_range(Range::positive(), unit, text);
}
constexpr About non_negative(std::string_view unit, std::string_view text) {
  return in_range(Range::non_negative(), unit, text);
}
/// A share: a number from 0 to 1, and one that is not 0.
constexpr About share(std::string_view text) { return in_range({0.0, 1.0}, "1", text); }
constexpr About positive_share(std::string_view text) { return in_range({0.0, 1.0, true}, "1", text); }
/// A member that is written only if it differs from its default: one added after the first stores (Written).
constexpr About unless_default(About about) {
  about.written = Written::kUnlessDefault;
  return about;
}

/// Result of alternative(): if `flag` is set, `word` is written instead of `value`.
template <class T, class V>
struct WordOr {
  std::string_view word;
  bool T::*flag;
  V T::*value;
};
template <class T, class V>
WordOr(const char*, bool T::*, V T::*) -> WordOr<T, V>;

namespace description {
struct AnyVisitor {};

template <class Use>
struct Members {
  const Use& use;
  template <class M, class C, class A = About>
  constexpr void member(std::string_view name, M C::*pointer, const A& about) {
    use(name, pointer, about);
  }
  constexpr void inlined(auto) {}
};
}  // namespace description

/// Calls use(name, pointer, about) for each member that the description of a record of numbers and texts names itself:
/// the columns of its table. The members of what is inlined belong to a table of their own.
template <class R, class Use>
constexpr void for_members(const Use& use) {
  description::Members<Use> members{use};
  describe(members, Of<R>{});
}

template <class T>
concept Described = requires(description::AnyVisitor& v) {
  describe(v, Of<T>{});
};

template <class T>
concept HasAlternative = requires {
  alternative(Of<T>{});
};

template <class T>
concept HasFromWord = requires(std::string_view word, T& value) {
  { from_word(word, value) } -> std::same_as<bool>;
};

}  // namespace moma
