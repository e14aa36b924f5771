#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "eval/trial/spec.h"

namespace moma {

/// Keys of the trials of one spec: 32 hex digits, XXH3-128 of all resolved inputs that determine the row (see
/// kSimulationVersion). Everything except the world is digested once.
class TrialKeys {
 public:
  explicit TrialKeys(const TrialSpec& spec);
  /// `world_identity`: Worlds::identity(index).
  std::string key(const nlohmann::ordered_json& world_identity) const;

 private:
  std::string spec_digest_;
};

}  // namespace moma
