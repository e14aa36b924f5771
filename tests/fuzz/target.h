#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// One input. Whatever is no error of the kind that the reader documents ends the process: exceptions of other kinds,
/// broken promises (std::abort), and what sanitizers find.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Changes bytes within `most`; libFuzzer's, or the replay's own. Returns the new size.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

/// Of targets whose inputs have a structure that bytes alone would break (structure.cc); others have none.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);

namespace moma::fuzz {

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace moma::fuzz
