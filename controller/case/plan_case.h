#pragma once

#include <string>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "controller/lookahead/plan_state.h"
#include "controller/model/robot_model.h"

namespace moma {

/// Reads the look-ahead's memory, `state.plan` of a case file: the members of PlanBrief and PlanState, `start` as in
/// `state.escape`, `goal` {position, quaternion} of the step before and, if there is one, `path` {origin, motions:
/// [{start, time, ramp, change}], duration, clearance, goal}. `origin` and `change` have a value for x, y, phi of the
/// base and for each joint. Throws config::ConfigError.
PlanState read_plan_state(const config::Node& node, const std::string& key, const RobotModel& model);

Json to_json(const PlanState& state);

}  // namespace moma
