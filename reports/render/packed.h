#pragma once

#include <cstring>
#include <string>
#include <vector>

namespace moma::reports {

/// Returns the values as byte planes: all first bytes, then all second bytes, and so on, which compresses better.
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

/// Returns bytes deflated (zlib) and in base64, as in the page's data block. Throws std::runtime_error without memory.
std::string packed(const std::vector<unsigned char>& bytes);

}  // namespace moma::reports
