// The controller of docs/tutorials/own-controller.md: the end effector is drawn straight to the goal, and the
// velocities follow from the damped pseudoinverse of the Jacobian. It knows no obstacles.

#include "controller/model/kinematics.h"
#include "plugin/plugin.h"

using namespace moma;

class FirstController {
 public:
  FirstController(std::shared_ptr<const RobotModel> robot, double gain)
      : robot_(std::move(robot)), gain_(gain), kinematics_(robot_) {}

  void reset(std::span<const ObjectShape> /*objects*/) {}
  void prepare(StepResult& result) const { result.command = VectorX::Zero(robot_->num_velocities()); }

  void step(const Observation& seen, StepResult& result) {
    kinematics_.update(seen.base, seen.q);
    const Isometry& X_WE = kinematics_.X_WE();
    const Matrix3 turn = seen.goal.X_WG.linear() * X_WE.linear().transpose();
    Vector6 twist;  // angular first, as everywhere in moma
    twist << gain_ * log_so3(turn), gain_ * (seen.goal.X_WG.translation() - X_WE.translation());
    const Matrix6X& J = kinematics_.J_WE_W();
    const Eigen::Matrix<double, 6, 6> damped = J * J.transpose() + 0.01 * Eigen::Matrix<double, 6, 6>::Identity();
    result.command = J.transpose() * damped.ldlt().solve(twist);
  }

 private:
  std::shared_ptr<const RobotModel> robot_;
  double gain_;
  Kinematics kinematics_;
};

std::unique_ptr<FirstController> make(const plugin::Setup& setup) {
  double gain = 1.0;
  config::MapReader in(setup.parameters, "parameters");
  in.read("gain", gain, config::Range::positive());
  in.finish();
  return std::make_unique<FirstController>(setup.robot, gain);
}

MOMA_PLUGIN(make)
