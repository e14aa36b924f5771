#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace moma::store {

/// 128 bits, as stored in BLOB columns (XXH3-128, big-endian: hex in reading order).
using Hash = std::array<unsigned char, 16>;

/// digest_hex() (eval/trial/key.h) as a Hash.
Hash hash_text(std::string_view text);

/// 32 hex digits.
std::string to_hex(const Hash& hash);
/// Throws std::invalid_argument unless `hex` is 32 hex digits.
Hash hash_from_hex(std::string_view hex);
/// Least and greatest key whose hex digits begin with these, of any case; none unless they are 1 to 32 hex digits.
std::optional<std::pair<Hash, Hash>> key_range(std::string prefix);

}  // namespace moma::store
