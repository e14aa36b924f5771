#include "tests/reports/packed_text.h"

#include <zlib.h>

#include <stdexcept>

namespace moma::reports {

std::vector<unsigned char> unpacked(const std::string& text, std::size_t most) {
  static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> small;
  unsigned word = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    word = word << 6 | static_cast<unsigned>(kDigits.find(c));
    if ((bits += 6) >= 8) small.push_back(static_cast<unsigned char>(word >> (bits -= 8)));
  }
  std::vector<unsigned char> bytes(most);
  uLongf size = bytes.size();
  if (uncompress(bytes.data(), &size, small.data(), small.size()) != Z_OK) throw std::runtime_error("not deflated");
  bytes.resize(size);
  return bytes;
}

}  // namespace moma::reports
