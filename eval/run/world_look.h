#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "eval/suite/suite.h"

namespace moma::run {

/// Worlds as a robot finds them: those that it starts in touch in, and how near its tool is to objects at the goals.
struct WorldLook {
  /// Between the tool and what is nearest to it at a goal.
  struct Gap {
    double d = 0.0;     ///< infinite where nothing is nearer than 0.5 m [m]
    std::string where;  ///< "world 3, panda_hand and can"
  };
  std::uint64_t in_touch = 0;  ///< worlds
  std::string first_touch;     ///< as Gap::where
  std::vector<Gap> goals;      ///< of each world
};

/// Looks at a world of the robot's at t = 0. At the start everything that can collide counts: objects, floor and the
/// robot itself. At the goal that is what no configuration changes: shapes that are rigid with the tool against objects
/// at rest. Costs about three configurations' distances.
void look_at(const World& world, const std::shared_ptr<const RobotModel>& model, WorldLook& look);

/// One sentence where the tool is in touch with objects at goals, which no configuration reaches then, with counts.
std::vector<std::string> touching_goals(const WorldLook& look);

/// One sentence per controller of `points` whose rows stop the robot farther from objects than its tool is at goals in
/// `look` that it does not touch, with counts.
std::vector<std::string> goal_warnings(const std::vector<const SuitePoint*>& points, const WorldLook& look);

}  // namespace moma::run
