#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// One input. Whatever is no error of the kind that the reader documents ends the process: exceptions of other kinds,
/// broken promises (std::abort), and what sanitizers find.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace moma::fuzz {

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace moma::fuzz
