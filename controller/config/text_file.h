#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "controller/config/paths.h"

namespace moma::config {

/// Returns the content of a regular file. Anything else (a folder, FIFO, device, socket) is never opened: reading it
/// could block or never end. Throws std::runtime_error, without the file's name, if the file is missing, not regular,
/// unreadable, or longer than kMaxTextBytes.
std::string read_text_file(const fs::path& file);

/// Returns at most 200 bytes of a text, for messages.
std::string shortened(const std::string& text);

/// Limits of inputs, since files also come from strangers. Each limit is far above the needs of a robot, suite or case,
/// far below what would exhaust a machine, and named in the message of an input that exceeds it.
inline constexpr std::uintmax_t kMaxTextBytes = 64U << 20U;  ///< of one YAML, JSON or URDF text
inline constexpr std::size_t kMaxValues = 1'000'000;         ///< of a file with all that it includes and repeats
inline constexpr std::size_t kMaxAliases = 10'000;           ///< `*name`, in a file with all that it includes
inline constexpr std::size_t kMaxIncludes = 1'000;           ///< files that a file includes, directly or not
inline constexpr std::size_t kMaxIncludeDepth = 32;          ///< files that include one another in a row
inline constexpr int kMaxNesting = 64;                       ///< levels of lists and maps, and parts of a dotted key
inline constexpr std::size_t kMaxKeyBytes = 1'000;           ///< of one key
inline constexpr std::size_t kMaxListLength = 200'000;       ///< values of one list, entries of one map

}  // namespace moma::config
