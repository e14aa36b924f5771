#pragma once

#include <string>
#include <vector>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "controller/model/robot_model.h"
#include "controller/params.h"

namespace moma::config {

/// Reads controller parameters: a map (spec: configs/controllers/*.yaml), or the path of such a file, relative to
/// the file that names it. Sizes are checked against the robot, margins against the control period.
/// `warnings` collects what is allowed but doubtful. Throws ConfigError naming the place.
ControllerParams read_controller(const Node& node, const std::string& key, const RobotModel& model,
                                 double control_period, std::vector<std::string>& warnings);

/// Every parameter, defaults included, in the order of the file format. What read_controller() makes of it is the same
/// in every described member (describe/equal.h), but for the values of parts that are switched off: slack and output
/// scaling are then written as `none`, others not at all, and read back with their defaults. Those of `escape` and of
/// the dampers, which have an `enabled`, are written and read in full.
Json to_json(const ControllerParams& params);

}  // namespace moma::config
