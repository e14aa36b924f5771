// The controller with detours: the same bits after reset, no memory taken, and whatever comes in,
// a command that is finite and inside its bounds. MOMA_MANY_STEPS=1000000 runs as many random steps.

#include <gtest/gtest.h>

#include <cstdlib>

#include "controller/controller_core.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

ControllerParams everything() {
  ControllerParams p;
  p.servo = {3.0, 3.9, 1.0, 1.5};
  p.base_weight = {false, 0.1};
  p.slack.weight = {false, 100.0};
  p.escape.enabled = true;
  p.escape.patience = 0.2;  // so that something happens in a short test
  p.escape.duration = 0.2;
  return p;
}

// A robot that is driven by its own commands among obstacles, for so many steps.
struct Drive {
  std::shared_ptr<const RobotModel> model;
  ControllerCore controller;
  std::vector<ObjectShape> shapes;
  Observation now;
  StepResult result;
  int detours = 0;

  Drive(std::shared_ptr<const RobotModel> m, const ControllerParams& p, std::uint64_t seed)
      : model(std::move(m)), controller(model, p, 0.02) {
    Rng rng(seed);
    shapes = random_objects(rng, 8);
    now = random_observation(*model, shapes.size(), rng, 0.9);
    now.goal.V_WG_W.setZero();
    for (ObjectState& s : now.objects) s.V_WO_W.setZero();
    controller.reset(shapes);
    controller.prepare(result);
  }
  void step() {
    const int before = controller.escape_state().stagnations;
    controller.step(now, result);
    detours += controller.escape_state().stagnations - before;
    integrate(*model, now.base, now.q, result.command, 0.02);
    now.qdot = result.command;
    now.time += 0.02;
  }
};

TEST(ControllerEscape, ResetGivesTheSameBits) {
  for (const auto& model : built_robots()) {
    Drive first(model, everything(), 5);
    const Observation start = first.now;
    std::vector<VectorX> commands;
    for (int i = 0; i < 400; ++i) {
      first.step();
      commands.push_back(first.result.command);
    }
    EXPECT_GT(first.detours, 1) << model->name;
    first.controller.reset(first.shapes);
    first.now = start;
    for (int i = 0; i < 400; ++i) {
      first.step();
      ASSERT_EQ(first.result.command, commands[static_cast<std::size_t>(i)]) << model->name << " step " << i;
    }
  }
}

// What a result says the controller remembered is enough to repeat its step: what `moma solve` does with a case.
TEST(ControllerEscape, AStepCanBeRepeatedFromItsState) {
  for (const auto& model : built_robots()) {
    Drive drive(model, everything(), 6);
    ControllerCore other(model, everything(), 0.02);
    StepResult result;
    other.prepare(result);
    int on_detour = 0;
    for (int i = 0; i < 300; ++i) {
      const Observation seen = drive.now;
      drive.step();
      if (i % 5 != 0) continue;
      other.reset(drive.shapes);
      other.set_escape_state(drive.result.escape);
      other.step(seen, result);
      ASSERT_EQ(result.command, drive.result.command) << model->name << " step " << i;
      on_detour += other.escape_state().detour ? 1 : 0;
    }
    EXPECT_GT(on_detour, 3) << model->name;
  }
}

TEST(ControllerEscape, OffIsOff) {
  ControllerParams off = everything();
  off.escape.enabled = false;
  ControllerParams plain = off;
  plain.escape = EscapeParams{};
  Drive a(frankie(), off, 7), b(frankie(), plain, 7);
  for (int i = 0; i < 200; ++i) {
    a.step();
    b.step();
    ASSERT_EQ(a.result.command, b.result.command);
    ASSERT_EQ(a.controller.escape_state().stagnations, 0);
  }
}

TEST(ControllerEscape, NoMemoryIsTaken) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  int detours = 0;
  for (const auto& model : built_robots()) {
    Drive drive(model, everything(), 8);
    NoAlloc guard;
    for (int i = 0; i < 500; ++i) {
      drive.step();
      ASSERT_EQ(guard.count(), 0) << "step " << i << " of " << model->name;
    }
    detours += drive.detours;
  }
  EXPECT_GT(detours, 3);
}

TEST(ControllerEscape, RandomStepsStayFiniteAndInsideTheirBounds) {
  const char* many = std::getenv("MOMA_MANY_STEPS");
  const long total = many != nullptr ? std::atol(many) : 20000;
  Rng rng(9);
  long done = 0, detours = 0;
  while (done < total) {
    const auto model = built_robots()[rng() % 3];
    ControllerParams p = everything();
    p.acceleration_limit = VectorX::Constant(model->num_velocities(), uniform(rng, 2.0, 20.0));
    p.collision.max_pairs = static_cast<int>(rng() % 40);
    const std::vector<ObjectShape> shapes = random_objects(rng, rng() % 12);
    ControllerCore c(model, p, 0.02);
    c.reset(shapes);
    StepResult result;
    c.prepare(result);
    const VectorX limit = model->velocity_limits();
    for (int scene = 0; scene < 10; ++scene) {
      Observation o = random_observation(*model, shapes.size(), rng, uniform(rng, 0.3, 2.0));
      if (rng() % 2 == 0)
        for (ObjectState& s : o.objects) s.V_WO_W.setZero();
      if (rng() % 4 == 0) o.goal.V_WG_W.setZero();
      if (rng() % 20 == 0) o.goal.X_WG.translation() *= 1e6;
      const bool held = rng() % 2 == 0;
      for (int i = 0; i < 50 && done < total; ++i, ++done) {
        c.step(o, result);
        ASSERT_TRUE(result.command.allFinite()) << done;
        ASSERT_TRUE(((result.command.cwiseAbs() - limit).array() <= 1e-9).all()) << done << " " << model->name;
        ASSERT_NE(result.status, StepStatus::kInvalidInput) << done;
        ASSERT_TRUE(std::isfinite(c.escape_state().best) && c.escape_state().target_W.allFinite()) << done;
        detours += c.escape_state().detour ? 1 : 0;
        if (held) continue;
        integrate(*model, o.base, o.q, result.command, 0.02);
        o.qdot = result.command;
        o.goal.X_WG.translation() += 0.02 * o.goal.V_WG_W.tail<3>();
        for (ObjectState& s : o.objects) s.X_WO.translation() += 0.02 * s.V_WO_W.tail<3>();
      }
    }
  }
  EXPECT_GT(detours, total / 20);
}

TEST(ControllerEscape, BadInputLeavesTheStateAsItWas) {
  Drive drive(frankie(), everything(), 10);
  while (drive.detours < 1) drive.step();
  const EscapeState before = drive.controller.escape_state();
  Observation bad = drive.now;
  bad.q[2] = NAN;
  drive.controller.step(bad, drive.result);
  EXPECT_EQ(drive.result.status, StepStatus::kInvalidInput);
  EXPECT_EQ(drive.controller.escape_state().remaining, before.remaining);
  EXPECT_EQ(drive.controller.escape_state().target_W, before.target_W);
  drive.step();
  EXPECT_TRUE(drive.result.command.allFinite());
}

}  // namespace
}  // namespace moma
