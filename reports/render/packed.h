#pragma once

#include <cstring>
#include <string>
#include <vector>

namespace moma::reports {

/// The values' first bytes, then their second ones, and so on: those of like significance compress better together.
template <class Value>
std::vector<unsigned char> planes(const std::vector<Value>& values) {
  std::vector<unsigned char> bytes(values.size() * sizeof(Value));
  for (std::size_t i = 0; i < values.size(); ++i) {
    unsigned char word[sizeof(Value)];
    std::memcpy(word, &values[i], sizeof(Value));
    for (std::size_t k = 0; k < sizeof(Value); ++k) bytes[k * values.size() + i] = word[k];
  }
  return bytes;
}

/// Deflated (zlib), in base64: bytes as the page's data block holds them. Throws std::runtime_error: out of memory.
std::string packed(const std::vector<unsigned char>& bytes);

}  // namespace moma::reports
