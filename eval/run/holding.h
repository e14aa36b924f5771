#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/model/robot_model.h"

namespace moma::run {

/// Returns a sentence for each joint whose drive is too weak for the arm's own weight, at `ready` or in its range. With
/// physics such an arm sags or falls under any controller.
std::vector<std::string> holding_warnings(const std::shared_ptr<const RobotModel>& model);

}  // namespace moma::run
