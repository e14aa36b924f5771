#pragma once

#include <cstdint>
#include <string>

#include "eval/suite/suite.h"

namespace moma {

/// trial_key() for many worlds of one point: everything but the world is digested once.
class TrialKeys {
 public:
  explicit TrialKeys(const Point& point);
  /// `world_identity`: point.worlds.identity(index).
  std::string key(const nlohmann::ordered_json& world_identity) const;

 private:
  std::string point_digest_;
};

}  // namespace moma
