#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/config/node.h"
#include "controller/model/robot_model.h"
#include "controller/params.h"
#include "controller/step.h"

namespace moma::config {

/// Reads controller parameters: a map (spec: configs/controllers/*.yaml), or the path of such a file, relative to
/// the file that names it. Sizes are checked against the robot, margins against the control period.
/// `warnings` collects what is allowed but doubtful. Throws ConfigError naming the place.
ControllerParams read_controller(const Node& node, const std::string& key, const RobotModel& model,
                                 double control_period, std::vector<std::string>& warnings);

/// Every parameter, defaults included, in the order of the file format; read_controller(to_json(p)) == p.
nlohmann::ordered_json to_json(const ControllerParams& params);

}  // namespace moma::config
