#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/model/robot_model.h"

namespace moma::run {

/// Joints whose drive is too weak for the arm's own weight, at `ready` or somewhere in their range: a sentence for
/// each. With physics such an arm sags or falls, whatever its controller.
std::vector<std::string> holding_warnings(const std::shared_ptr<const RobotModel>& model);

}  // namespace moma::run
