#pragma once

#include <string>
#include <vector>

namespace moma::reports {

/// Deflated (zlib), in base64: bytes as the page's data block holds them. Throws std::runtime_error: out of memory.
std::string packed(const std::vector<unsigned char>& bytes);

}  // namespace moma::reports
