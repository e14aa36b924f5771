#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "controller/describe/keys.h"
#include "world/world.h"

namespace moma {

struct MakingLog {
  std::uint64_t worlds = 0;                         ///< that were made
  std::uint64_t tries = 0;                          ///< each makes a world or is rejected for one reason
  std::map<std::string, std::uint64_t> rejections;  ///< number of tries by failed constraint
  std::map<std::string, std::uint64_t> redraws;     ///< objects drawn again within a try, by reason
};

class Worlds {
 public:
  /// Reads `worlds: {seed, clearance, families: {...}}` or `{frozen: PATH}` or `{scenes: PATH}`. Throws
  /// config::ConfigError.
  static Worlds read(const config::Node& node, const std::string& key);
  Json to_json() const;

  /// Returns world `index`: a pure function of (this section, robot, seed, index). Families share the indices by
  /// weight: every prefix 0..n-1 has each family within one of its share, and exactly in full cycles. Throws
  /// GenerationError if no valid world is found in the allowed tries. Adds to `log` in any case. `moves` change the
  /// draws of families and of disturbances; worlds without families accept none.
  World make(const std::shared_ptr<const RobotModel>& model, std::uint64_t index, MakingLog* log = nullptr,
             const std::shared_ptr<const Moves>& moves = nullptr) const;

  std::string family_of(std::uint64_t index) const;
  /// Returns all inputs that determine world `index` besides the robot: seed, index, its family's own parameters (or
  /// the frozen world itself), without other families of the mixture. Part of a trial's key.
  Json identity(std::uint64_t index, const Moves& moves = {}) const;
  /// Returns the families' shares of the worlds, which sum to 1; empty if worlds are not drawn by families.
  std::vector<std::pair<std::string, double>> shares() const;
  double clearance() const;
  /// Distance from the robot's first place in which nothing stands [m]; 0 for worlds from files.
  double start_room() const;
  std::uint64_t seed() const;
  /// Number of worlds of a frozen set; -1 if unlimited.
  long long size() const;

  struct Data;

 private:
  std::shared_ptr<const Data> data_;
};

/// Returns every key of a `worlds` section, including those of all families.
std::vector<Key> worlds_keys(const std::string& prefix = "worlds");

/// Names the constraint that failed most often, with counts.
class GenerationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace moma
