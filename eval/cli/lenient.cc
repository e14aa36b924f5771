#include "eval/cli/lenient.h"

namespace moma::cli {

config::Node lenient_robot(const std::filesystem::path& robot_file) {
  config::Node robot = config::load_yaml(robot_file);
  config::set_value(robot, "lenient", "true");
  return robot;
}

config::Node case_with_lenient_robot(const std::filesystem::path& case_file) {
  config::Node root = config::load_yaml(case_file);
  config::Node* robot = root.find("robot");
  if (robot == nullptr) return root;  // read_case() says so
  if (robot->kind == config::Node::Kind::kScalar) {
    *robot = lenient_robot(config::directory_of(robot->mark) / robot->scalar);
  } else if (robot->kind == config::Node::Kind::kMap) {
    config::set_value(root, "robot.lenient", "true");
  }
  return root;
}

}  // namespace moma::cli
