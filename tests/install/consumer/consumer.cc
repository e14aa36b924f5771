#include <controller/config/robot_file.h>
#include <controller/controller.h>

#include <iostream>

int main() {
  const auto robot = moma::config::load_robot(ROBOT).model;
  moma::Controller controller(robot, moma::ControllerParams{}, 0.02);
  moma::Observation seen{.q = robot->ready, .qdot = moma::VectorX::Zero(robot->num_velocities())};
  seen.goal.X_WG = moma::Kinematics(robot).X_WE() * Eigen::Translation3d(0.3, 0.0, 0.2);
  moma::StepResult result;
  controller.prepare(result);
  controller.step(seen, result);
  std::cout << robot->name << ": " << to_string(result.status) << ", " << result.command.transpose() << "\n";
  return result.status == moma::StepStatus::kSolved && result.command.norm() > 0.01 ? 0 : 1;
}
