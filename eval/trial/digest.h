#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace moma {

/// XXH3-128 of `text`, 32 hex digits, most significant first.
std::string digest_hex(std::string_view text);

/// Digest of the canonical form of `json`: keys sorted, no spaces, numbers in their shortest exact form.
std::string canonical_digest(const nlohmann::ordered_json& json);

}  // namespace moma
