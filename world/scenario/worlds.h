#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/node.h"
#include "controller/describe/keys.h"
#include "world/world.h"

namespace moma {

/// What it took to make worlds, added up.
struct MakingLog {
  std::uint64_t worlds = 0;                         ///< that were made
  std::uint64_t tries = 0;                          ///< each makes a world or is rejected for one reason
  std::map<std::string, std::uint64_t> rejections;  ///< tries, by the constraint that failed
  std::map<std::string, std::uint64_t> redraws;     ///< single objects that were drawn again within a try, by reason
};

/// The `worlds` section of a suite, resolved.
class Worlds {
 public:
  /// Reads `worlds: {seed, clearance, families: {...}}` or `{frozen: PATH}` or `{scenes: PATH}`. Throws
  /// config::ConfigError.
  static Worlds read(const config::Node& node, const std::string& key);
  nlohmann::ordered_json to_json() const;

  /// World `index`: a pure function of (this section, robot, seed, index). Families share out the indices by
  /// weight: every prefix 0..n-1 holds each family within one of its share, in full cycles exactly.
  /// Throws GenerationError where no valid world is found in the allowed tries. Adds to `log`, also then.
  /// `moves` change what families draw, and what disturbances draw in their worlds; other worlds take none.
  World make(const std::shared_ptr<const RobotModel>& model, std::uint64_t index, MakingLog* log = nullptr,
             const std::shared_ptr<const Moves>& moves = nullptr) const;

  std::string family_of(std::uint64_t index) const;
  /// What decides world `index` besides the robot: seed, index, its family's own parameters (or the frozen world
  /// itself). Other families of the mixture do not enter. Part of a trial's key.
  nlohmann::ordered_json identity(std::uint64_t index, const Moves& moves = {}) const;
  /// Share of the worlds that are of each family, adding up to 1; empty where worlds are not drawn by families.
  std::vector<std::pair<std::string, double>> shares() const;
  double clearance() const;
  std::uint64_t seed() const;
  /// Number of worlds of a frozen set; -1 where there is no end.
  long long size() const;

  struct Data;

 private:
  std::shared_ptr<const Data> data_;
};

/// Every key of a `worlds` section, those of all families included.
std::vector<Key> worlds_keys(const std::string& prefix = "worlds");

/// Names the constraint that failed most often, with counts.
class GenerationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace moma
