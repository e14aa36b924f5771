// Least times to a goal: the law of one coordinate against Ruckig, configurations by forward kinematics, the base's
// times against a drive simulated by brute force.
#include "world/scenario/time_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "controller/model/kinematics.h"
#include "tests/world/support.h"

namespace moma {
namespace {

using test::robot;
using test::worlds;

constexpr const char* kOpen = "{seed: 4711, families: {open: {weight: 1}}}";

TEST(TimeBound, RestToRestIsRuckigsTime) {
  std::ifstream file(std::string(MOMA_SOURCE_DIR) + "/tests/data/time_bound/ruckig.txt");
  int cases = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::vector<double> v;
    for (std::string word; words >> word;) v.push_back(std::stod(word));
    ASSERT_EQ(v.size(), 5u) << line;
    EXPECT_NEAR(rest_to_rest(v[0], {v[1], v[2], v[3]}), v[4], 1e-7) << line;
    ++cases;
  }
  EXPECT_EQ(cases, 48);
}

TEST(TimeBound, RestToRestWithoutLimitsOfAcceleration) {
  EXPECT_DOUBLE_EQ(rest_to_rest(3.0, {2.0}), 1.5);
  EXPECT_EQ(rest_to_rest(0.0, {2.0}), 0.0);
}

// The end is at the goal, within the joints' limits, and no joint is quicker than its own law.
TEST(TimeBound, TheEndHoldsTheGoalWithinLimits) {
  for (const char* name : {"panda", "ur5", "frankie", "frankie_omni", "lift_ur5"}) {
    const auto model = robot(name);
    const Worlds source = worlds(kOpen);
    Kinematics kinematics(model);
    for (std::uint64_t index = 0; index < 10; ++index) {
      const World world = source.make(model, index);
      const TimeBound bound = time_bound(model, world);
      ASSERT_TRUE(std::isfinite(bound.time)) << name << " " << index;
      kinematics.update(bound.end.base, bound.end.q);
      EXPECT_LT((kinematics.X_WE().translation() - world.goal.X_WG.translation()).norm(), 1.1e-3) << name << index;
      EXPECT_LT(log_so3(kinematics.X_WE().linear().transpose() * world.goal.X_WG.linear()).norm(), 2.1e-3);
      double slowest = 0.0;
      for (int i = 0; i < model->num_joints(); ++i) {
        const ControlledJoint& joint = model->joint(i);
        EXPECT_GE(bound.end.q[i], joint.lower) << name;
        EXPECT_LE(bound.end.q[i], joint.upper) << name;
        if (joint.type == JointType::kContinuous) continue;
        slowest = std::max(slowest, rest_to_rest(std::abs(bound.end.q[i] - world.start.q[i]),
                                                 {joint.velocity, joint.acceleration, joint.jerk}));
      }
      EXPECT_GE(bound.time, slowest - 1e-12) << name << " " << index;
    }
  }
}

// The witness holds the goal. The search, which is not told of it, finds a configuration that is as quick or quicker in
// nine of ten worlds; 200 tries find little quicker ones.
TEST(TimeBound, FindsWhatIsKnown) {
  const auto model = robot("panda");
  const Worlds source = worlds(kOpen);
  double sum = 0.0, more = 0.0;
  int slower = 0;
  constexpr int kWorlds = 40;
  for (std::uint64_t index = 0; index < kWorlds; ++index) {
    World world = source.make(model, index);
    double known = 0.0;
    for (int i = 0; i < model->num_joints(); ++i)
      known =
          std::max(known, rest_to_rest(std::abs(world.witness.q[i] - world.start.q[i]),
                                       {model->joint(i).velocity, model->joint(i).acceleration, model->joint(i).jerk}));
    world.witness.q.resize(0);  // not told
    const double bound = time_bound(model, world).time;
    slower += bound > known ? 1 : 0;
    sum += bound;
    more += time_bound(model, world, 200).time;
  }
  EXPECT_LE(slower, kWorlds / 10);
  EXPECT_LT(sum, 1.03 * more) << sum / kWorlds << " s in the mean, " << more / kWorlds << " s with 200 tries";
  EXPECT_GE(sum, more);
}

TEST(TimeBound, SameBitsEachTime) {
  const auto model = robot("frankie");
  const World world = worlds(kOpen).make(model, 3);
  EXPECT_EQ(time_bound(model, world).time, time_bound(model, world).time);
}

// The robot is at its goal.
TEST(TimeBound, NothingToDoTakesNoTime) {
  for (const char* name : {"panda", "frankie", "frankie_omni"}) {
    const auto model = robot(name);
    World world;
    world.start.q = model->ready;
    Kinematics kinematics(model);
    kinematics.update(world.start.base, world.start.q);
    world.goal.X_WG = kinematics.X_WE();
    world.witness = world.start;
    EXPECT_LT(time_bound(model, world).time, 1e-9) << name;
  }
}

}  // namespace
}  // namespace moma
