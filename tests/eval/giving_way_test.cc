// Objects that give way to the robot (world/yielding.h): in the loop of a trial, in its samples and in world files.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "controller/config/node.h"
#include "eval/store/samples.h"
#include "tests/eval/trial_fixture.h"
#include "world/world_json.h"
#include "world/yielding.h"

namespace moma::test {
namespace {

constexpr double kPeriod = 0.02;

/// A sphere of 10 cm that moves from x = 2 at 0.4 m/s towards the tiny robot at rest, whose last shape ends at x =
/// 0.65.
World meeting(const Yields& yields) {
  World world = tiny_world(0.4);
  WorldObject one = sphere("one", {2.0, 0.0, 0.5}, 0.1);
  one.motion = PathMotion{.times = {0.0, 10.0}, .positions = {{2.0, 0.0, 0.5}, {-2.0, 0.0, 0.5}}, .quaternions = {}};
  one.yields = yields;
  world.objects = {sphere("rest", {0.0, 3.0, 0.5}, 0.1), one};
  return world;
}

TrialOutput stand(const TrialSpec& spec, const World& world) {
  TrialParts parts;
  parts.controller = [](const TrialSpec& p) {
    return std::make_unique<ScriptedController>(p.robot->model->num_velocities(), ScriptedController::Script{});
  };
  return run_trial(spec, world, parts);
}

TEST(GivingWay, WaitsThenGoesBackAndComesAgain) {
  TrialSpec spec = tiny_spec();
  spec.simulation.time_limit = 9.0;
  EXPECT_EQ(stand(spec, meeting({})).row.outcome, Outcome::kCollision);

  const TrialOutput out = stand(spec, meeting({.distance = 0.3, .patience = 1.0}));
  ASSERT_EQ(out.row.outcome, Outcome::kTimeout) << out.row.reason;
  // 0.3 m are left after 2.375 s; it waits from the next period on for 1 s, and is back at its start as long after.
  constexpr double kWaits = 2.38, kTurns = kWaits + 1.0, kBack = kTurns + kWaits;
  EXPECT_NEAR(out.row.clearance_min_m, 2.0 - 0.4 * kWaits - 0.1 - 0.65, 1e-9);
  for (const Sample& sample : out.trace) {
    ASSERT_EQ(sample.object_time.size(), 1);
    const double t = sample.t;
    double own = t;
    if (t > kWaits) own = kWaits;
    if (t > kTurns) own = kWaits - (t - kTurns);
    if (t > kBack) own = std::min(t - kBack, kWaits);
    EXPECT_NEAR(sample.object_time[0], own, 1e-9) << t;
  }
}

TEST(GivingWay, WaitsForWhatIsAheadAlone) {
  World world = meeting({.distance = 5.0, .patience = 1.0});
  world.objects[1].X_WO.translation().x() = 1.0;
  world.objects[1].motion =
      PathMotion{.times = {0.0, 10.0}, .positions = {{1.0, 0.0, 0.5}, {5.0, 0.0, 0.5}}, .quaternions = {}};
  TrialSpec spec = tiny_spec();
  spec.simulation.time_limit = 2.0;
  const TrialOutput out = stand(spec, world);
  EXPECT_NEAR(out.trace.back().object_time[0], out.trace.back().t, 1e-12);
}

// The sphere passes the robot's shapes, spheres of 5 cm, with 45 cm between their surfaces: it waits only where that
// counts as ahead.
TEST(GivingWay, PassesWhatIsBesideItsCourse) {
  TrialSpec spec = tiny_spec();
  spec.simulation.time_limit = 9.0;
  for (const auto& [side, waits] : {std::pair{0.4, false}, std::pair{0.6, true}}) {
    World world = meeting({.distance = 0.8, .patience = 60.0, .side = side});
    world.objects[1].X_WO.translation().y() = 0.6;
    world.objects[1].motion =
        PathMotion{.times = {0.0, 10.0}, .positions = {{2.0, 0.6, 0.5}, {-2.0, 0.6, 0.5}}, .quaternions = {}};
    const TrialOutput out = stand(spec, world);
    ASSERT_EQ(out.row.outcome, Outcome::kTimeout) << out.row.reason;
    EXPECT_EQ(out.trace.back().object_time[0] < out.trace.back().t - 1.0, waits) << side;
  }
}

TEST(GivingWay, StatesAreThoseOfItsOwnTime) {
  const World world = meeting({.distance = 0.3, .patience = 1.0});
  const Pace waits{.since = 3.0, .at = 2.0, .rate = 0.0}, returns{.since = 3.0, .at = 2.0, .rate = -1.0};
  EXPECT_EQ(place(world.objects[1], waits, 3.5).V_W.norm(), 0.0);
  EXPECT_NEAR(place(world.objects[1], waits, 3.5).X.translation().x(), 1.2, 1e-12);
  EXPECT_NEAR(place(world.objects[1], returns, 3.5).V_W[3], 0.4, 1e-12);
  EXPECT_NEAR(place(world.objects[1], returns, 3.5).X.translation().x(), 1.4, 1e-12);
}

TEST(GivingWay, HoldsInBothPlants) {
  for (const SimulationMode mode : {SimulationMode::kKinematic, SimulationMode::kDynamic}) {
    SCOPED_TRACE(std::string(to_string(mode)));
    TrialSpec spec = tiny_spec();
    spec.robot = std::make_shared<const config::LoadedRobot>(
        config::load_robot(std::string(MOMA_SOURCE_DIR) + "/configs/robots/frankie.yaml"));
    spec.simulation.mode = mode;
    World world;
    world.robot = "frankie";
    world.start.q = spec.robot->model->ready;
    world.goal.X_WG.translation() = Vector3(3.0, 2.0, 1.0);
    WorldObject person = sphere("person", {3.0, 0.0, 0.85}, 0.25);
    person.shape.kind = ShapeKind::kCapsule;
    person.shape.size = {0.25, 1.2, 0.0};
    person.motion =
        PathMotion{.times = {0.0, 5.0}, .positions = {{3.0, 0.0, 0.85}, {-1.0, 0.0, 0.85}}, .quaternions = {}};
    world.objects = {person};
    EXPECT_EQ(stand(spec, world).row.outcome, Outcome::kCollision);
    world.objects[0].yields = {.distance = 0.5, .patience = 60.0};
    const TrialOutput out = stand(spec, world);
    EXPECT_NE(out.row.outcome, Outcome::kCollision) << out.row.reason;
    EXPECT_NEAR(out.row.clearance_min_m, 0.5, 0.03);
  }
}

TEST(GivingWay, SamplesKeepTheTimesAndOthersAreAsBefore) {
  TrialSpec spec = tiny_spec();
  spec.simulation.time_limit = 3.0;
  const Trace trace = stand(spec, meeting({.distance = 0.3, .patience = 1.0})).trace;
  const store::EncodedSamples encoded = store::encode_samples(trace);
  EXPECT_NE(encoded.columns.find("object_time0"), std::string::npos);
  const Trace back = store::decode_samples(encoded);
  ASSERT_EQ(back.size(), trace.size());
  for (std::size_t k = 0; k < trace.size(); ++k) EXPECT_EQ(back[k].object_time, trace[k].object_time);
  const Trace without = stand(spec, tiny_world(0.4)).trace;
  EXPECT_EQ(store::encode_samples(without).columns.find("object_time"), std::string::npos);
}

TEST(GivingWay, WorldFilesHoldIt) {
  World world = meeting({.distance = 0.3, .patience = 1.5});
  world.witness = world.start;
  Json json = to_json(world);
  EXPECT_FALSE(json["objects"][0].contains("yields"));
  const World again = world_from_json(json, "test");
  EXPECT_EQ(again.objects[1].yields.distance, 0.3);
  EXPECT_EQ(again.objects[1].yields.patience, 1.5);
  EXPECT_EQ(to_json(again).dump(), json.dump());
  for (const char* bad : {R"({"distance": -1})", R"({"distance": 1, "patience": -1})", R"({"temper": 1})", "3"}) {
    json["objects"][1]["yields"] = Json::parse(bad);
    EXPECT_THROW(world_from_json(json, "test"), config::ConfigError) << bad;
  }
}

}  // namespace
}  // namespace moma::test
