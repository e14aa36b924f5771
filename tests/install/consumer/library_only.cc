#include <controller/controller.h>

#include <iostream>

// A turntable with one rotating arm, built in code.
int main() {
  auto robot = std::make_shared<moma::RobotModel>();
  robot->links = {{.name = "@base"}, {.name = "root", .parent = 0}};
  robot->links.push_back(
      {.name = "arm", .parent = 1, .joint = "turn", .joint_type = moma::JointType::kContinuous, .controlled = 0});
  robot->joints = {{.name = "turn", .type = moma::JointType::kContinuous, .link = 2, .velocity = 1.0}};
  robot->tip = 2;
  robot->X_TE.translation().x() = 1.0;
  robot->ready = moma::VectorX::Zero(1);
  moma::Controller controller(robot, moma::ControllerParams{}, 0.02);
  moma::Observation seen{.q = robot->ready, .qdot = moma::VectorX::Zero(1)};
  seen.goal.X_WG.translation() = moma::Vector3(0.8, 0.6, 0.0);
  moma::StepResult result;
  controller.prepare(result);
  controller.step(seen, result);
  std::cout << to_string(result.status) << ": " << result.command.transpose() << "\n";
  return result.status == moma::StepStatus::kSolved && result.command[0] > 0.01 ? 0 : 1;
}
