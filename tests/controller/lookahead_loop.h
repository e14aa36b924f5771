#pragma once
// A controller that looks ahead with a plant of its own, and the robots that its tests run on.

#include <gtest/gtest.h>

#include "controller/config/controller_file.h"
#include "controller/config/node.h"
#include "controller/controller_core.h"
#include "controller/lookahead/lookahead.h"
#include "controller/safe/pose_track.h"
#include "tests/controller/plan_scenes.h"
#include "tests/support/control_period.h"

namespace moma::test {

inline ControllerParams read_params(const RobotModel& model, bool plan, const std::string& preset = "moma-reactive") {
  std::vector<std::string> warnings;
  const config::Node file = config::load_yaml(source_path("configs/controllers/" + preset + ".yaml"));
  ControllerParams params = config::read_controller(file, "controller", model, kPeriod, warnings);
  params.plan.enabled = plan;
  return params;
}

// A robot whose base ramps and that otherwise does what it is told.
class Loop {
 public:
  Loop(std::shared_ptr<const RobotModel> model, const ControllerParams& params, const Scene& scene)
      : controller(model, params, kPeriod), model_(std::move(model)), kinematics_(model_), scene_(scene) {
    controller.reset(scene.shapes);
    controller.prepare(result);
    o.base = scene.start.head<3>();
    o.q = scene.start.tail(model_->num_joints());
    o.qdot = VectorX::Zero(model_->num_velocities());
    o.goal.X_WG = scene.X_WG;
    o.objects = scene.states;
  }
  void step() {
    controller.step(o, result);
    move();
  }
  /// Moves the robot by the last command for a control period; alone, one that the controller misses.
  void move() {
    VectorX v = result.command;
    for (int i = 0; i < model_->base_dof(); ++i) {
      const double most = kPeriod * model_->base.max_acceleration[i + 1 == model_->base_dof() ? 1 : 0];
      v[i] = std::clamp(v[i], o.qdot[i] - most, o.qdot[i] + most);
    }
    integrate(*model_, o.base, o.q, v, kPeriod);
    o.qdot = v;
    advance(o.goal.V_WG_W, kPeriod, o.goal.X_WG);
    o.time += kPeriod;
  }
  bool there() {
    kinematics_.update(o.base, o.q);
    const Isometry& X = kinematics_.X_WE();
    return (X.translation() - o.goal.X_WG.translation()).norm() < 0.02 &&
           log_so3(X.linear() * o.goal.X_WG.linear().transpose()).norm() < 0.05;
  }
  double clearance() {
    kinematics_.update(o.base, o.q);
    return object_clearance(*model_, kinematics_, scene_);
  }
  /// Time until it is there, negative where that takes more than `most`; `least` is its least clearance on the way.
  double run(double most, double& least) {
    least = 1e9;
    while (o.time < most) {
      if (there()) return o.time;
      step();
      least = std::min(least, clearance());
    }
    return -1.0;
  }

  ControllerCore controller;
  Observation o;
  StepResult result;

 private:
  std::shared_ptr<const RobotModel> model_;
  Kinematics kinematics_;
  Scene scene_;
};

inline std::vector<std::string> lookahead_robots() {
  return {"configs/robots/frankie.yaml", "configs/robots/frankie_omni.yaml", "configs/robots/panda.yaml"};
}

class Ahead : public testing::TestWithParam<std::string> {
 protected:
  Ahead() : model(load_model(GetParam())) {}
  std::shared_ptr<const RobotModel> model;
};

}  // namespace moma::test
