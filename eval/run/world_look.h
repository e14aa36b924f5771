#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "eval/suite/suite.h"

namespace moma::run {

/// Statistics of worlds: starts in contact, and gaps between tool and objects at the goals.
struct WorldLook {
  /// Gap between the tool and the nearest object at a goal.
  struct Gap {
    double d = 0.0;     ///< infinite if nothing is nearer than 0.5 m [m]
    std::string where;  ///< "world 3, panda_hand and can"
  };
  std::uint64_t in_touch = 0;  ///< number of worlds that start in contact
  std::string first_touch;     ///< as Gap::where
  std::vector<Gap> goals;      ///< of each world
};

/// Examines a world of the robot at t = 0. At the start all pairs that can collide count: objects, floor and the robot
/// itself. At the goal only pairs that no configuration changes count: shapes that are rigid with the tool against
/// objects at rest. Costs about three configurations' distances.
void look_at(const World& world, const std::shared_ptr<const RobotModel>& model, WorldLook& look);

/// Returns a sentence, with counts, if the tool touches objects at goals, which no configuration then reaches.
std::vector<std::string> touching_goals(const WorldLook& look);

/// Returns one sentence, with counts, per controller of `points` whose rows stop the robot farther from objects than
/// the tool is at goals in `look` without contact.
std::vector<std::string> goal_warnings(const std::vector<const SuitePoint*>& points, const WorldLook& look);

}  // namespace moma::run
