#include "eval/store/hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>

#include "eval/trial/key.h"

namespace moma::store {

Hash hash_text(std::string_view text) { return hash_from_hex(digest_hex(text)); }

std::string to_hex(const Hash& hash) { return fmt::format("{:02x}", fmt::join(hash, "")); }

Hash hash_from_hex(std::string_view hex) {
  Hash hash;
  bool ok = hex.size() == 2 * hash.size();
  for (std::size_t i = 0; ok && i < hash.size(); ++i) {
    const char* const begin = hex.data() + 2 * i;
    unsigned value = 0;
    const auto [end, error] = std::from_chars(begin, begin + 2, value, 16);
    ok = error == std::errc() && end == begin + 2;
    hash[i] = static_cast<unsigned char>(value);
  }
  if (!ok) throw std::invalid_argument("not a key of 32 hex digits: " + std::string(hex));
  return hash;
}

std::optional<std::pair<Hash, Hash>> key_range(std::string prefix) {
  const bool hex = !prefix.empty() && prefix.size() <= 32 &&
                   std::ranges::all_of(prefix, [](unsigned char c) { return std::isxdigit(c) != 0; });
  if (!hex) return std::nullopt;
  std::string last = prefix;
  prefix.resize(32, '0');
  last.resize(32, 'f');
  return std::pair(hash_from_hex(prefix), hash_from_hex(last));
}

}  // namespace moma::store
