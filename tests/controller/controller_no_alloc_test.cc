// A step takes no memory: not while rows come and go, not in any stage of the fallback, not on bad input.

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "controller/controller.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

TEST(NoAlloc, CountsMallocNewAndEigen) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  NoAlloc guard;
  EXPECT_EQ(guard.count(), 0);
  void* volatile memory = std::malloc(10);
  EXPECT_EQ(guard.count(), 1);
  std::free(memory);
  VectorX v(100);
  v.setZero();
  EXPECT_EQ(guard.count(), 2);
  const auto number = std::make_unique<double>(v.sum());
  EXPECT_EQ(guard.count(), 3) << *number;
}

/// Counts the borders of parts.
struct CountingClock final : StepClock {
  void enter(StepPart) noexcept override { ++borders; }
  long borders = 0;
};

/// Numbers of steps.
struct Seen {
  std::map<StepStatus, int> status;
  std::map<Fallback, int> fallback;
};

void run(std::shared_ptr<const RobotModel> model, const ControllerParams& params, std::uint64_t seed, Seen& seen) {
  Rng rng(seed);
  const std::vector<ObjectShape> shapes = random_objects(rng, 30);
  Controller controller(model, params, 0.02);
  controller.reset(shapes);
  controller.enable_timing(true);
  CountingClock clock;
  controller.set_clock(&clock);
  StepResult result;
  controller.prepare(result);
  std::vector<Observation> observations;
  for (int i = 0; i < 200; ++i) {
    // From far to among the objects, so that the number of rows changes from step to step.
    observations.push_back(random_observation(*model, shapes.size(), rng, i % 4 == 0 ? 5.0 : 0.8));
    if (i % 50 == 49) observations.back().q[0] = NAN;
    if (i % 50 == 48) observations.back().objects.pop_back();
  }
  for (std::size_t i = 0; i < observations.size(); ++i) {
    NoAlloc guard;
    controller.step(observations[i], result);
    ASSERT_EQ(guard.count(), 0) << "step " << i << " of " << model->name << ", " << to_string(result.status) << ", "
                                << to_string(result.fallback);
    ++seen.status[result.status];
    ++seen.fallback[result.fallback];
  }
  EXPECT_GT(clock.borders, 200) << "a few in each step, but in those of bad input";
}

TEST(NoAlloc, StepsOfTheQpInEveryStage) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  Seen seen;
  for (const auto& model : built_robots()) {
    ControllerParams p;
    run(model, p, 11, seen);
    p.acceleration_limit = VectorX::Constant(model->num_velocities(), 1.0);
    p.collision.object.stop = 0.02;
    run(model, p, 12, seen);
    p.slack.enabled = false;
    run(model, p, 13, seen);
  }
  EXPECT_GT(seen.status[StepStatus::kSolved], 100);
  EXPECT_GT(seen.fallback[Fallback::kNoAcceleration], 5);
  EXPECT_GT(seen.fallback[Fallback::kRelaxed], 5);
  EXPECT_GT(seen.fallback[Fallback::kBrake], 5);
  EXPECT_GT(seen.status[StepStatus::kInvalidInput], 5);
}

TEST(NoAlloc, StepsWithAFreeSlackAndScaledOutput) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  Seen seen;
  ControllerParams p;
  p.slack.weight = {false, 0.0};
  p.output_scaling.enabled = true;
  p.posture.weight = 0.1;
  p.acceleration_weight = VectorX::Constant(9, 0.1);
  run(frankie(), p, 14, seen);
  EXPECT_GT(seen.status[StepStatus::kSolved], 20);
}

TEST(NoAlloc, StepsOfTheClosedForms) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  Seen seen;
  for (const auto& model : built_robots()) {
    for (const Method method : {Method::kRrmc, Method::kPark, Method::kBaur}) {
      ControllerParams p;
      p.method = method;
      run(model, p, 15, seen);
    }
  }
  EXPECT_GT(seen.status[StepStatus::kSolved], 1000);
}

}  // namespace
}  // namespace moma
