// The separation's margin against speeds of approach that are differences of distances, and against a motion that is
// worked out by hand.
#include "eval/trial/clearance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/eval/suite_fixture.h"
#include "tests/eval/trial_fixture.h"
#include "world/draws.h"

namespace moma::test {
namespace {

std::vector<double> distances(Proximity& proximity, const Kinematics& kinematics, const ObjectState& object) {
  std::vector<double> out;
  for (const ProximityPair& pair : proximity.query(kinematics, std::vector<ObjectState>{object}, {100.0, -1.0, -1.0}))
    out.push_back(pair.distance.d);
  return out;
}

TEST(Separation, IsTheDistanceLessWhatIsUsedUpUntilTheRobotStands) {
  TrialSpec spec = tiny_spec();
  spec.disturbances.objects.delay = 0.05;           // 3 periods
  spec.disturbances.actuators.base.delay = 0.04;    // 2
  spec.disturbances.actuators.joints.delay = 0.02;  // 1
  const auto model = spec.robot->model;
  EXPECT_NEAR(SeparationWatch(spec).reaction(), 0.02 * (1 + 3 + 2), 1e-12);
  const std::vector<ObjectShape> shapes = {{"ball", {ShapeKind::kSphere, {0.2, 0, 0}, nullptr}}};
  Proximity proximity(model);
  proximity.set_objects(shapes);
  Kinematics kinematics(model), moved(model);
  int approached = 0;
  for (std::uint64_t trial = 0; trial < 50; ++trial) {
    Draws draws(4, trial, Stream::kMotion);
    const auto draw = [&](double size) { return draws.uniform(-size, size); };
    Vector3 base(draw(1), draw(1), draw(3));
    VectorX q = Vector3(draw(1), draw(0.8), draw(0.15)), qdot(5);
    qdot << draw(1), draw(2), draw(1), draw(1), draw(0.4);
    ObjectState ball;
    ball.X_WO.translation() = base + Vector3(draw(1.5), draw(1.5), 0.5 + draw(0.3));
    ball.X_WO.translation().z() -= base.z();
    ball.V_WO_W << 0, 0, 0, draw(1.5), draw(1.5), draw(0.3);
    kinematics.update(base, q);
    SeparationWatch watch(spec);
    watch.look(kinematics, proximity, std::vector<ObjectState>{ball}, qdot);

    const std::vector<double> now = distances(proximity, kinematics, ball);
    constexpr double h = 1e-6;
    ObjectState later = ball;
    later.X_WO.translation() += h * ball.V_WO_W.tail<3>();
    const std::vector<double> by_ball = distances(proximity, kinematics, later);
    integrate(*model, base, q, qdot, h);
    moved.update(base, q);
    const std::vector<double> by_robot = distances(proximity, moved, ball);
    const Vector2 a = model->base.max_acceleration;
    const double stop = std::max(std::abs(qdot[0]) / a.x(), std::abs(qdot[1]) / a.y()), react = 0.12;
    double least = 1e9;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const double v_H = std::max(0.0, (now[i] - by_ball[i]) / h), v_R = std::max(0.0, (now[i] - by_robot[i]) / h);
      approached += v_H > 0.1 && v_R > 0.1 ? 1 : 0;
      least = std::min(least, now[i] - v_H * (react + stop) - v_R * react - 0.5 * v_R * stop);
    }
    EXPECT_NEAR(watch.least(), least, 1e-4) << trial;
  }
  EXPECT_GT(approached, 20);
}

TEST(Separation, CountsWhatMovesAndKeepsTheLeast) {
  const TrialSpec spec = tiny_spec();
  Kinematics kinematics(spec.robot->model);
  kinematics.update(Vector3::Zero(), Vector3::Zero());
  Proximity proximity(spec.robot->model);
  proximity.set_objects(std::vector<ObjectShape>{{"ball", {ShapeKind::kSphere, {0.2, 0, 0}, nullptr}}});
  SeparationWatch watch(spec);
  std::vector<ObjectState> ball(1);
  ball[0].X_WO.translation() = Vector3(2.0, 0, 0.5);
  const VectorX still = VectorX::Zero(5);
  watch.look(kinematics, proximity, ball, still);
  EXPECT_TRUE(std::isnan(watch.least())) << "at rest";
  // The tip's ball of 5 cm is at x = 0.6, and the other comes at 0.5 m/s for the 0.02 s of a period.
  ball[0].V_WO_W[3] = -0.5;
  watch.look(kinematics, proximity, ball, still);
  EXPECT_NEAR(watch.least(), 2.0 - 0.2 - 0.65 - 0.5 * 0.02, 1e-9);
  const double least = watch.least();
  ball[0].V_WO_W[3] = 0.5;
  ball[0].X_WO.translation().x() = 1.9;
  watch.look(kinematics, proximity, ball, still);
  EXPECT_NEAR(watch.least(), 1.9 - 0.2 - 0.65, 1e-9) << "what goes away uses nothing up";
  ball[0].X_WO.translation().x() = 3.0;
  watch.look(kinematics, proximity, ball, still);
  EXPECT_LT(watch.least(), least);
}

// A trial's row has it, and the latencies that moma's controllers find.
TEST(Separation, StandsInTheRowOfATrialAmongMovers) {
  World world = tiny_world(5.0);
  world.objects.push_back(sphere("comer", {4.0, 0.0, 0.5}, 0.2));
  TrialSpec spec = tiny_spec();
  spec.simulation.time_limit = 1.0;
  EXPECT_TRUE(std::isnan(run_scripted(spec, world, drive(0.0, 1.0)).row.separation_margin_min_m)) << "all at rest";
  LinearMotion coming;
  coming.V_W[3] = -0.5;
  world.objects[0].motion = coming;
  const TrialRow row = run_scripted(spec, world, drive(0.0, 1.0)).row;
  EXPECT_NEAR(row.separation_margin_min_m, 4.0 - 0.5 - 0.2 - 0.65 - 0.5 * 0.02, 0.011);
  EXPECT_TRUE(std::isnan(row.latency_base_s)) << "a scripted controller looks for none";
}

TEST(Latencies, StandInTheRowWithHowFarTheyAreOff) {
  SuiteFolder folder;
  const std::string configs = MOMA_SOURCE_DIR "/configs/";
  const Suite suite = load_suite(folder.write("latencies.yaml", "robot: " + configs + "robots/frankie.yaml\n" +
                                                                    "controllers: {safe: {include: " + configs +
                                                                    R"(controllers/moma-safe.yaml,
    prediction: {drives: {base: 0.02, joints: 0.04}, sensing: {base: 0, joints: 0}}}}
disturbances: {actuators: {base: {delay: 0.06}, joints: {delay: 0.04}}, base: {delay: 0.02}}
worlds: {seed: 3, families: {open: {weight: 1}}}
simulation: {mode: kinematic, time_limit: 10}
trials: 1
)"));
  TrialSpec spec = suite.points[0];
  const World world = suite.points[0].worlds.make(spec.robot->model, 0);
  const TrialRow row = run_trial(spec, world).row;
  EXPECT_NEAR(row.latency_base_s, 0.08, 1e-9) << row.reason;
  EXPECT_NEAR(row.latency_base_off_s, 0.06, 1e-9) << "it was told 0.02";
  EXPECT_NEAR(row.latency_joints_s, 0.04, 1e-9);
  EXPECT_NEAR(row.latency_joints_off_s, 0.0, 1e-9);
  spec.controller_params.prediction.identify = false;
  EXPECT_TRUE(std::isnan(run_trial(spec, world).row.latency_base_s)) << "nobody looked";
}

// A base with half of its accelerations is no later than one that has all of them.
TEST(Latencies, ASlowDriveIsNotTakenForALateOne) {
  SuiteFolder folder;
  const std::string configs = MOMA_SOURCE_DIR "/configs/";
  const Suite suite = load_suite(folder.write(
      "slow.yaml", "robot: " + configs + "robots/frankie.yaml\ncontrollers: {moma: " + configs +
                       "controllers/moma.yaml}\ndisturbances: {include: " + configs + R"(disturbances/realistic.yaml,
  actuators: {base: {ramps: {speed_up: 0.5, slow_down: 0.5}}}}
worlds: {seed: 34, families: {open: {weight: 1}}}
simulation: {mode: kinematic, time_limit: 10}
trials: 12
)"));
  int right = 0;
  for (int i = 0; i < 12; ++i) {
    const TrialRow row = run_trial(suite.points[0], suite.points[0].worlds.make(suite.points[0].robot->model, i)).row;
    EXPECT_EQ(row.outcome, Outcome::kSuccess) << i;
    right += std::abs(row.latency_base_off_s) < 1e-9 ? 1 : 0;
  }
  EXPECT_GE(right, 10);
}

}  // namespace
}  // namespace moma::test
