#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "plugin/moma_plugin.h"

namespace moma {

// The protocol of controllers in processes of their own; docs/reference/process-protocol.md is the whole of it, for
// those who write one. Its frames have the numbers of plugin/moma_plugin.h: one version is raised with both.
inline constexpr int kProcessProtocol = MOMA_PLUGIN_ABI - 2;

enum class Frame : std::uint32_t {
  kSetup = 1,  ///< from moma: robot and parameters, as JSON
  kReset = 2,  ///< the objects of a motion, as JSON
  kStep = 3,   ///< the numbers of an Observation (describe/numbers.h)
  kReady = 101,
  kStarted = 102,
  kCommand = 103,  ///< the velocities, and the numbers of Details or none
  kError = 104     ///< UTF-8
};

inline constexpr std::size_t kFrameHeader = 8;                       ///< length of what follows, and kind, 32 bits each
inline constexpr std::size_t kLargestAnswer = std::size_t{1} << 20;  ///< [bytes] of one frame from the process

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

inline void put_header(unsigned char* to, Frame kind, std::uint32_t length) noexcept {
  const std::uint32_t words[2] = {length, static_cast<std::uint32_t>(kind)};
  std::memcpy(to, words, sizeof words);
}

struct FrameHeader {
  std::uint32_t length = 0;
  std::uint32_t kind = 0;
};

inline FrameHeader get_header(const unsigned char* from) noexcept {
  FrameHeader header;
  std::memcpy(&header, from, sizeof header);
  return header;
}

}  // namespace moma
