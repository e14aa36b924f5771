#include "eval/run/holding.h"

#include <fmt/format.h>

#include "controller/model/statics.h"

namespace moma::run {

std::vector<std::string> holding_warnings(const std::shared_ptr<const RobotModel>& model) {
  std::vector<std::string> out;
  for (const JointLoad& load : joint_loads(model)) {
    const ControlledJoint& joint = model->joints[static_cast<std::size_t>(load.joint)];
    const char* unit = joint.type == JointType::kPrismatic ? "N" : "Nm";
    if (load.ready > load.limit) {
      out.push_back(
          fmt::format("joint {}: holding the arm at `ready` takes {:.4g} {}, its effort limit is {:.4g}: with physics "
                      "the arm falls",
                      joint.name, load.ready, unit, load.limit));
    } else if (load.largest > load.limit) {
      std::string q;
      for (const double value : load.q_largest) q += fmt::format("{}{:.2f}", q.empty() ? "" : ", ", value);
      out.push_back(
          fmt::format("joint {}: in {:.3g} % of the joints' ranges holding the arm takes more than its effort limit of "
                      "{:.4g} {} (up to {:.4g}, at q = [{}]): with physics it sags there, unless "
                      "arm.limits.{}.effort has the share of springs that help it",
                      joint.name, 100.0 * load.beyond, load.limit, unit, load.largest, q, joint.name));
    }
  }
  return out;
}

}  // namespace moma::run
