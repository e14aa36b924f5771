// A trial that is stepped from outside is the trial that the loop runs.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "controller/controller.h"
#include "eval/trial/stepped_trial.h"
#include "eval/trial/trial_detail.h"
#include "tests/eval/trial_fixture.h"

namespace moma::test {
namespace {

TrialSpec disturbed_spec() {
  TrialSpec spec = tiny_spec();
  spec.disturbances.joints.noise = 0.01;
  spec.disturbances.base.delay = 0.06;
  return spec;
}

World world_with_a_ball() {
  World world = tiny_world(0.6);
  world.objects = {sphere("ball", {1.2, 0.4, 0.5}, 0.1)};
  return world;
}

std::string text_of(const TrialSpec& spec, const World& world, const TrialOutput& output) {
  return trace_json(spec, world, output, "").at("samples").dump();
}

TrialOutput step_by_step(const TrialSpec& spec, const World& world, StepController& controller) {
  SteppedTrial trial(std::make_shared<TrialSpec>(spec), world);
  controller.reset(trial.objects());
  StepResult result;
  controller.prepare(result);
  while (!trial.ended()) {
    controller.step(trial.seen(), result);
    trial.step(result);
  }
  return trial.output();
}

TEST(SteppedTrial, HasTheBitsOfTheClock) {
  for (const TrialSpec& spec : {tiny_spec(), disturbed_spec()}) {
    const World world = world_with_a_ball();
    const TrialOutput whole = run_trial(spec, world);
    Controller controller(spec.robot->model, spec.controller_params, spec.simulation.control_period);
    const TrialOutput stepped = step_by_step(spec, world, controller);
    ASSERT_GT(whole.trace.size(), 20u) << whole.row.reason;
    EXPECT_EQ(text_of(spec, world, whole), text_of(spec, world, stepped));
    EXPECT_EQ(whole.row.outcome, stepped.row.outcome);
    EXPECT_EQ(whole.row.reason, stepped.row.reason);
    EXPECT_EQ(whole.row.time_end_s, stepped.row.time_end_s);
    EXPECT_EQ(whole.row.path_ee_m, stepped.row.path_ee_m);
    EXPECT_EQ(whole.row.clearance_min_m, stepped.row.clearance_min_m);
    EXPECT_EQ(whole.row.manip_mean, stepped.row.manip_mean);
    EXPECT_EQ(whole.row.command_change_mean, stepped.row.command_change_mean);
    EXPECT_TRUE(std::isnan(stepped.row.slack_mean)) << "slack is of moma's own controllers";
  }
}

TEST(SteppedTrial, IsSeenWithErrorsAndInTruth) {
  SteppedTrial trial(std::make_shared<TrialSpec>(disturbed_spec()), world_with_a_ball());
  Observation truth;
  trial.truth(truth);
  EXPECT_EQ(truth.q, VectorX::Zero(3));
  EXPECT_NE(trial.seen().q, truth.q);
  StepResult answer;
  answer.command = VectorX::Zero(trial.spec().robot->model->num_velocities());
  answer.command[0] = 0.2;
  trial.step(answer);
  trial.truth(truth);
  EXPECT_DOUBLE_EQ(truth.base.x(), 0.004);
  EXPECT_EQ(trial.seen().base.x(), 0.0) << "it comes three periods later";
  EXPECT_THROW(trial.output(), std::logic_error);
}

TEST(SteppedTrial, EndsWhereItCannotGoOn) {
  StepResult answer;
  answer.command = VectorX::Constant(tiny_spec().robot->model->num_velocities(), 0.0);
  answer.command[0] = std::numeric_limits<double>::quiet_NaN();
  SteppedTrial trial(std::make_shared<TrialSpec>(tiny_spec()), tiny_world(1.0));
  trial.step(answer);
  ASSERT_TRUE(trial.ended());
  EXPECT_EQ(trial.output().row.outcome, Outcome::kError);
  EXPECT_NE(trial.output().row.reason.find("finite numbers"), std::string::npos) << trial.output().row.reason;
  answer.command.setZero();
  trial.step(answer);
  EXPECT_EQ(trial.output().row.steps, 0) << "nothing goes on after the end";

  SteppedTrial short_of(std::make_shared<TrialSpec>(tiny_spec()), tiny_world(1.0));
  answer.command = VectorX::Zero(1);
  short_of.step(answer);
  EXPECT_EQ(short_of.output().row.outcome, Outcome::kError);
}

TEST(SteppedTrial, CommandsAreScaledIntoTheRobotsSpeeds) {
  const VectorX limits = tiny_spec().robot->model->velocity_limits();
  StepResult answer;
  answer.command = 3.0 * limits;
  SteppedTrial trial(std::make_shared<TrialSpec>(tiny_spec()), tiny_world(1.0));
  trial.step(answer);
  Observation truth;
  trial.truth(truth);
  EXPECT_LE((truth.qdot.cwiseAbs() - limits).maxCoeff(), 1e-12);
  EXPECT_GT(truth.qdot.norm(), 0.0);
}

}  // namespace
}  // namespace moma::test
