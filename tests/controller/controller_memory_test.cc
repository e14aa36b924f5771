// Memory that runs out while a controller is made or starts a motion: an exception, and a controller that can start
// again.

#include <gtest/gtest.h>

#include <memory>
#include <new>
#include <optional>

#include "controller/config/controller_file.h"
#include "controller/controller.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

class ControllerMemory : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
    std::vector<std::string> warnings;
    const std::string file = std::string(MOMA_SOURCE_DIR "/configs/controllers/") + GetParam() + ".yaml";
    params_ = config::read_controller(config::load_yaml(file), "controller", *model_, kPeriod, warnings);
  }

  static constexpr double kPeriod = 0.02;
  std::shared_ptr<const RobotModel> model_ = frankie();
  ControllerParams params_;
};

TEST_P(ControllerMemory, ThatRunsOutInAResetLeavesOneThatCanBeResetAgain) {
  Rng rng(3);
  const std::vector<ObjectShape> few = random_objects(rng, 2), more = random_objects(rng, 7);
  const Observation seen = random_observation(*model_, more.size(), rng, 1.0);
  Controller fresh(model_, params_, kPeriod);
  fresh.reset(more);
  StepResult expected, result;
  fresh.prepare(expected);
  fresh.prepare(result);
  fresh.step(seen, expected);
  int failures = 0;
  for (bool done = false; !done;) {
    Controller controller(model_, params_, kPeriod);
    controller.reset(few);
    {
      const FailingAlloc failing(failures + 1);
      try {
        controller.reset(more);
        done = !failing.failed();
      } catch (const std::bad_alloc&) {
      }
    }
    if (done) break;
    // Each third one goes without: to end is all that it has to be good for then.
    if (++failures % 3 == 0) continue;
    controller.reset(more);
    controller.step(seen, result);
    ASSERT_EQ(result.command, expected.command) << "after allocation " << failures;
  }
  EXPECT_GT(failures, 10);
}

TEST_P(ControllerMemory, ThatRunsOutWhileOneIsMadeIsAnException) {
  int failures = 0;
  for (std::optional<Controller> made; !made;) {
    const FailingAlloc failing(failures + 1);
    try {
      made.emplace(model_, params_, kPeriod);
    } catch (const std::bad_alloc&) {
      ++failures;
    }
    if (made && failing.failed()) made.reset(), ++failures;  // one that it can do without
  }
  EXPECT_GT(failures, 10);
}

INSTANTIATE_TEST_SUITE_P(Presets, ControllerMemory, ::testing::Values("holistic", "neo", "moma-safe", "moma"));

}  // namespace
}  // namespace moma
