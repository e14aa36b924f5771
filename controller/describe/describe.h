#pragma once

#include <string_view>

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
/// What a visitor has to offer (one that a description does not use may be missing):
///   member(name, pointer, About)                        a value: number, whole number, truth, text, enumeration,
///   vector, or described optional(name, pointer, &T::enabled, Off, text)     a described struct that is there only
///   where it is enabled inlined(pointer)                                    a described struct whose members stand
///   among these group(name, text, [](auto& g) { g.member(...); })   members of this struct under a key of their own
template <class T>
struct Of {
  using type = T;
};

/// When a writer leaves a member out. Trial keys are hashes of what is written: what came later is written only where
/// it differs from its default, so that the keys of trials without it stay what they were.
enum class Written { kAlways, kUnlessDefault };

/// How an `optional` that is switched off is written.
enum class Off {
  kNone,     ///< as the word none
  kOmitted,  ///< not at all
  kKept,     ///< in full, with `enabled: false`
};

/// What is said of a member.
struct About {
  std::string_view unit = "";  ///< of SI and `1`: "m", "rad/s"; of joints "rad or m"; "" where it has none
  Range range = {};            ///< of a number, or of each number of a list
  Written written = Written::kAlways;
  std::string_view text = "";  ///< one line for the reference, without a full stop
};

}  // namespace moma
