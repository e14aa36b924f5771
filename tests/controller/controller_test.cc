// Controller, the public face: does what its core does, keeps its parts to itself, and can be moved.

#include "controller/controller.h"

#include <gtest/gtest.h>

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "controller/controller_core.h"
#include "tests/controller/qp_robots.h"

namespace moma {
namespace {

using namespace test;

static_assert(sizeof(Controller) == 2 * sizeof(void*), "nothing of its parts is in the header");
static_assert(std::is_nothrow_move_constructible_v<Controller> && std::is_nothrow_move_assignable_v<Controller>);
static_assert(!std::is_copy_constructible_v<Controller> && !std::is_copy_assignable_v<Controller>);

// Detours are on, so that what a step does depends on those before.
ControllerParams with_memory() {
  ControllerParams params;
  params.escape.enabled = true;
  return params;
}

struct Motion {
  explicit Motion(std::shared_ptr<const RobotModel> m) : model(std::move(m)), core(model, with_memory(), 0.02) {
    Rng rng(7);
    shapes = random_objects(rng, 4);
    core.reset(shapes);
    core.prepare(expected);
    o = random_observation(*model, shapes.size(), rng, 1.0);
  }
  /// A controller at the beginning of the same motion.
  Controller begin() {
    Controller controller(model, with_memory(), 0.02);
    controller.reset(shapes);
    controller.prepare(result);
    return controller;
  }
  /// One step of the core and of `controller`, which have to agree in every bit.
  void step(Controller& controller, int k) {
    o.time = 0.02 * k;
    core.step(o, expected);
    controller.step(o, result);
    ASSERT_EQ(result.command, expected.command) << model->name << ", step " << k;
    ASSERT_EQ(result.status, expected.status) << model->name << ", step " << k;
    ASSERT_EQ(result.escape.idle, expected.escape.idle) << model->name << ", step " << k;
    ASSERT_EQ(controller.kinematics().X_WE().matrix(), core.kinematics().X_WE().matrix());
    ASSERT_EQ(controller.wheels(), core.wheels());
  }

  std::shared_ptr<const RobotModel> model;
  ControllerCore core;
  std::vector<ObjectShape> shapes;
  Observation o;
  StepResult expected, result;
};

TEST(PublicController, DoesWhatItsCoreDoes) {
  for (const auto& model : built_robots()) {
    Motion motion(model);
    Controller controller = motion.begin();
    EXPECT_EQ(controller.model().joints.size(), model->joints.size());
    EXPECT_EQ(controller.model().shapes.size(), model->shapes.size() + 1) << "room for what it carries";
    EXPECT_EQ(controller.control_period(), 0.02);
    EXPECT_EQ(controller.params().lambda_q.size(), model->num_joints()) << "parameters are resolved";
    for (int k = 0; k < 30; ++k) motion.step(controller, k);
  }
}

// The robot stands still: for how long is remembered, and nowhere but in the controller.
TEST(PublicController, GoesOnWhereItIsMoved) {
  Motion motion(frankie());
  Controller first = motion.begin();
  for (int k = 0; k < 4; ++k) motion.step(first, k);
  EXPECT_GT(motion.expected.escape.idle, 0.0) << "there is something to forget";
  Controller second(std::move(first));
  for (int k = 4; k < 8; ++k) motion.step(second, k);
  Controller third(panda(), {}, 0.01);
  third = std::move(second);
  for (int k = 8; k < 30; ++k) motion.step(third, k);
}

TEST(PublicController, TimesStepsOnlyWhereAskedTo) {
  Motion motion(frankie());
  Controller controller = motion.begin();
  motion.step(controller, 0);
  EXPECT_EQ(motion.result.solve_seconds, 0.0);
  controller.enable_timing(true);
  motion.step(controller, 1);
  EXPECT_GT(motion.result.solve_seconds, 0.0);
}

TEST(PublicController, RefusesWhatItsCoreRefuses) {
  EXPECT_THROW(Controller(nullptr, {}, 0.02), std::invalid_argument);
  EXPECT_THROW(Controller(frankie(), {}, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace moma
