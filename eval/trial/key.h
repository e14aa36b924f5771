#pragma once

#include <string>
#include <string_view>

#include "eval/trial/spec.h"

namespace moma {

/// Keys of the trials of one spec: 32 hex digits, XXH3-128 of all resolved inputs that determine the row (see
/// kSimulationVersion). Everything except the world is digested once.
class TrialKeys {
 public:
  explicit TrialKeys(const TrialSpec& spec);
  /// `world_identity`: Worlds::identity(index).
  std::string key(const Json& world_identity) const;

 private:
  std::string spec_digest_;
};

/// XXH3-128 of `text`, 32 hex digits, most significant first.
std::string digest_hex(std::string_view text);

/// Digest of the canonical form of `json`: keys sorted, no spaces, numbers in their shortest exact form.
std::string canonical_digest(const Json& json);

}  // namespace moma
