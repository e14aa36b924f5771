#include "eval/trial/digest.h"

#include <fmt/format.h>
#include <xxhash.h>

namespace moma {

std::string digest_hex(std::string_view text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string canonical_digest(const nlohmann::ordered_json& json) {
  // nlohmann::json, unlike ordered_json, sorts an object's keys.
  return digest_hex(nlohmann::json(json).dump());
}

}  // namespace moma
