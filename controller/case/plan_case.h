#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "controller/ahead/plan_state.h"
#include "controller/config/node.h"
#include "controller/model/robot_model.h"

namespace moma {

/// What looking ahead remembers, as `state.plan` of a case file has it and `moma solve` writes it: the members of
/// PlanBrief and PlanState, `start` as in `state.escape`, `goal` {position, quaternion} of the step before and `path`
/// {origin, motions: [{start, time, ramp, change}], duration, clearance, goal}, absent where there is none. `origin`
/// and `change` have a value for x, y, phi of the base and for each joint. Throws config::ConfigError naming file,
/// line, key and what would be accepted.
PlanState read_plan_state(const config::Node& node, const std::string& key, const RobotModel& model);

nlohmann::ordered_json to_json(const PlanState& state);

}  // namespace moma
