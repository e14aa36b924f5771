#pragma once

#include <concepts>
#include <string_view>
#include <utility>

#include "controller/describe/range.h"

namespace moma {

/// One description for each struct: a function beside it that names its members, in the order in which they are
/// written, with unit, range and one line for the reference.
///
///   template <class Visitor>
///   constexpr void describe(Visitor& v, Of<ServoParams>) {
///     v.member("position", &ServoParams::position, {.unit = "1/s", .range = Range::non_negative(), .text = "k_p"});
///     v.optional("vortex", &ServoParams::vortex, &VortexParams::enabled, Off::kNone, "a sideways part of nu");
///   }
///
/// Members are pointers to members, so that a visitor may hold one object (to read, write or check it), two (to compare
/// them, or a value with its default), or none (to list columns and keys). Readers, writers, range checks, columns,
/// wires and tables of keys follow from it: a new member is its line here, and where it acts. The default is that of
/// the default-constructed struct.
///
/// There are: config/read_described.h (strict YAML), config/write_described.h (JSON), describe/check.h (ranges, for
/// structs that code has filled), describe/keys.h (tables of keys), describe/equal.h.
///
/// What a visitor has to offer (one that a description does not use may be missing):
///   member(name, pointer, About)                          a value: number, whole number, truth, text, enumeration,
///                                                         vector, list, std::optional, or described
///   optional(name, pointer, &T::enabled, Off, text)       a described struct that is there only where it is enabled
///   word_or(name, word, flag pointer, pointer, About)     a value in whose place a word may stand, which sets the flag
///   inlined(pointer)                                      a described struct whose members stand among these
///   group(name, text, [](auto& g) { g.member(...); })     members of this struct under a key of their own
///   written_where([](const T&) -> bool, [](auto& v) {})   members that are read always, and written only where the
///                                                         first says so of the object
///
/// Beside a type there may also stand (found by argument-dependent lookup):
///   constexpr auto alternative(Of<T>) { return WordOr{"word", &T::flag, &T::value}; }
///     where T is as a whole a value in whose place a word may stand;
///   bool from_word(std::string_view word, T& value)
///     where a word may be written for all of a described struct; false where it is no such word.
template <class T>
struct Of {
  using type = T;
};

/// When a writer leaves a member out. Trial keys are hashes of what is written: what came later is written only where
/// it differs from its default, so that the keys of trials without it stay what they were.
enum class Written { kAlways, kUnlessDefault };

/// How an `optional` that is switched off is written. All of them are read: none, or a map, which switches it on
/// unless it says `enabled: false`. Only kKept brings the values of a part that is off through a file.
enum class Off {
  kNone,     ///< as the word none
  kOmitted,  ///< not at all
  kKept,     ///< in full, with `enabled: false`; where it is on, with `enabled: true`
};

/// What each value of a list belongs to, where its length is the robot's.
enum class Per { kNothing, kJoint, kVelocity };

/// The robot's numbers; negative where there is no robot, and lists may have any length.
struct Lengths {
  int joints = -1;
  int velocities = -1;

  constexpr int of(Per per) const { return per == Per::kJoint ? joints : per == Per::kVelocity ? velocities : -1; }
};

/// What is said of a member.
struct About {
  std::string_view unit = "";  ///< of SI and `1`: "m", "rad/s"; of joints "rad or m"; "" where it has none
  Range range = {};            ///< of a number, or of each number of a list
  Per per = Per::kNothing;     ///< of a list
  bool one_for_all = false;    ///< of a list: one number stands for as many, and equal ones are written so
  bool required = false;       ///< for readers: no default
  Written written = Written::kAlways;
  std::string_view text = "";  ///< one line for the reference, without a full stop
};

/// What alternative() says: where `flag` holds, `word` is written in place of `value`.
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
}  // namespace description

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
