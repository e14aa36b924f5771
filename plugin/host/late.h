#pragma once

#include <string_view>

namespace moma {

/// The words around which a process is said to have answered too late (plugin/process/session.cc): the reason of a
/// trial that ended because real time ran out. It says how busy a machine was, nothing of a controller, and such a
/// trial is tried again instead of being kept. Stores of earlier versions hold such reasons in the same words.
inline constexpr std::string_view kLateBefore = "its process gave no answer ", kLateAfter = " s and was killed";

inline bool is_late(std::string_view reason) noexcept {
  const std::size_t at = reason.find(kLateBefore);
  return at != std::string_view::npos && reason.find(kLateAfter, at) != std::string_view::npos;
}

}  // namespace moma
