// Steers a simulated Frankie to a goal around a sphere that crosses its way, with nothing but moma's controller
// library.
//   steer_frankie configs/robots/frankie.yaml configs/controllers/moma.yaml
#include <algorithm>
#include <cstdio>
#include <memory>

#include "controller/config/controller_file.h"
#include "controller/config/robot_file.h"
#include "controller/controller.h"

int main(int argc, char** argv) try {
  if (argc != 3) return std::fputs("usage: steer_frankie ROBOT.yaml CONTROLLER.yaml\n", stderr), 2;
  constexpr double kPeriod = 0.02, kTimeLimit = 30.0;  // [s]
  const std::shared_ptr<const moma::RobotModel> robot = moma::config::load_robot(argv[1]).model;
  std::vector<std::string> warnings;
  const moma::ControllerParams params =
      moma::config::read_controller(moma::config::load_yaml(argv[2]), "controller", *robot, kPeriod, warnings);
  moma::Controller controller(robot, params, kPeriod);

  moma::ObjectShape ball{"ball", {}};
  ball.shape.kind = moma::ShapeKind::kSphere;
  ball.shape.size.x() = 0.15;
  controller.reset(std::vector<moma::ObjectShape>{ball});

  moma::Observation seen;  // here the simulation's state itself; on a robot, what its sensors say
  seen.q = robot->ready;
  seen.qdot = moma::VectorX::Zero(robot->num_velocities());
  seen.goal.X_WG.translation() = moma::Vector3(2.5, 0.6, 0.8);
  seen.goal.X_WG.linear() = Eigen::AngleAxisd(EIGEN_PI, moma::Vector3::UnitX()).toRotationMatrix();  // gripper down
  seen.objects.resize(1);
  seen.objects[0].X_WO.translation() = moma::Vector3(1.6, 0.8, 0.8);
  seen.objects[0].V_WO_W << 0, 0, 0, 0, -0.4, 0;  // [angular; linear], across the robot's way

  moma::StepResult result;
  controller.prepare(result);
  double least = moma::kInfinity;  // to the ball, measured apart from the controller's own query
  for (; seen.time < kTimeLimit; seen.time += kPeriod) {
    controller.step(seen, result);
    for (const moma::CollisionShape& part : robot->shapes)
      least = std::min(
          least,
          moma::shape_distance(part.shape, controller.kinematics().X_WS(part), ball.shape, seen.objects[0].X_WO).d);
    if (result.error.tail<3>().norm() < 0.01 && result.error.head<3>().norm() < 0.02) break;
    moma::integrate(*robot, seen.base, seen.q, result.command, kPeriod);
    seen.qdot = result.command;
    seen.objects[0].X_WO.translation() += kPeriod * seen.objects[0].V_WO_W.tail<3>();
  }
  const bool arrived = seen.time < kTimeLimit;
  std::printf("%s after %.2f s, %.1f mm and %.4f rad from the goal; never nearer to the ball than %.3f m\n",
              arrived ? "arrived" : "gave up", seen.time, 1e3 * result.error.tail<3>().norm(),
              result.error.head<3>().norm(), least);
  return arrived && least > 0.0 ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 2;
}
