// Worlds of several goals, goals that are passed through, and goals that leave directions free.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "controller/controller.h"
#include "controller/model/kinematics.h"
#include "controller/task/servo.h"
#include "eval/store/query.h"
#include "eval/suite/suite.h"
#include "tests/eval/store_fixture.h"
#include "tests/eval/trial_fixture.h"
#include "tests/support/scratch.h"
#include "world/world_json.h"

namespace moma::test {
namespace {

/// Goals ahead of the tip at rest, each in the tip's own orientation; all but the last are passed through.
World goals_ahead(const std::vector<double>& ahead, bool stop = false) {
  World world = tiny_world(ahead.front());
  for (std::size_t i = 1; i < ahead.size(); ++i) world.further.push_back(tiny_world(ahead[i]).goal);
  world.goal.stop = stop;
  for (std::size_t i = 0; i + 1 < world.further.size(); ++i) world.further[i].stop = stop;
  return world;
}

TEST(TrialGoals, TheLastOfThemIsTheSuccess) {
  // At 0.5 m/s: within 2 cm of 0.4 m at 0.76 s, of 0.6 m at 1.16 s, of 1.0 m from 1.96 s on.
  std::vector<double> seen;
  const auto script = [&](const Observation& observation, StepResult& result) {
    if (observation.time < 2.0 - 1e-9) result.command[0] = 0.5;
    const double x = observation.goal.X_WG.translation().x();
    EXPECT_EQ(observation.goal.stop, x > 1.7) << observation.time;
    ASSERT_EQ(observation.next.has_value(), x < 1.7) << observation.time;
    if (observation.next) {
      EXPECT_EQ(observation.next->X_WG.translation().x(), 0.9 + (x < 1.4 ? 0.6 : 1.0)) << observation.time;
      EXPECT_EQ(observation.next->stop, x > 1.4);
    }
    if (seen.empty() || seen.back() != x) seen.push_back(x);
  };
  World world = goals_ahead({0.4, 0.6, 1.0});
  world.objects = {sphere("ball", {0.0, 0.4, 0.5}, 0.1)};
  const TrialOutput out = run_scripted(tiny_spec(), world, script);
  EXPECT_EQ(to_string(out.row.outcome), "success") << out.row.reason;
  EXPECT_DOUBLE_EQ(out.row.time_to_goal_s, 1.96);
  EXPECT_DOUBLE_EQ(out.row.time_end_s, 2.16);
  EXPECT_EQ(out.row.goals_reached, 3.0);
  EXPECT_EQ(seen, (std::vector<double>{0.9 + 0.4, 0.9 + 0.6, 0.9 + 1.0}));
  const auto goals = nlohmann::json::parse(out.row.goals);
  ASSERT_EQ(goals.size(), 3u);
  EXPECT_DOUBLE_EQ(goals[0]["time_s"], 0.76);
  EXPECT_DOUBLE_EQ(goals[1]["time_s"], 1.16);
  EXPECT_DOUBLE_EQ(goals[2]["time_s"], 1.96);
  // The robot drives away from the ball.
  EXPECT_EQ(goals[0]["clearance_m"], out.row.clearance_min_m);
  EXPECT_LT(goals[0]["clearance_m"], goals[1]["clearance_m"]);
  EXPECT_LT(goals[1]["clearance_m"], goals[2]["clearance_m"]);
}

TEST(TrialGoals, WhoPassesAGoalToStopAtHasNotReachedIt) {
  const TrialOutput out = run_scripted(tiny_spec(), goals_ahead({0.4, 0.8}, true), drive(0.5, 1.6));
  EXPECT_EQ(to_string(out.row.outcome), "stuck") << out.row.reason;
  EXPECT_EQ(out.row.goals_reached, 0.0);
  EXPECT_EQ(out.row.goals, "[]");
  const auto waits = [](const Observation& observation, StepResult& result) {
    const double t = observation.time + 1e-9;
    if (t < 0.8 || (t > 1.0 && t < 1.8)) result.command[0] = 0.5;
  };
  const TrialOutput reached = run_scripted(tiny_spec(), goals_ahead({0.4, 0.8}, true), waits);
  EXPECT_EQ(to_string(reached.row.outcome), "success") << reached.row.reason;
  EXPECT_EQ(reached.row.goals, R"([{"time_s":0.76,"clearance_m":null},{"time_s":1.76,"clearance_m":null}])");
}

/// The tip takes a cup 0.3 m ahead off a plate, in which it stands 1 mm deep, leaves it 0.5 m on, and drives on.
World carries_a_cup(double last = 0.95) {
  World world = goals_ahead({0.3, 0.8, last}, true);
  world.goal.take = world.further[0].leave = "cup";
  world.objects = {sphere("cup", {1.2, 0.0, 0.5}, 0.08), sphere("plate", {1.2, 0.0, 0.401}, 0.0)};
  world.objects[1].shape = {ShapeKind::kBox, {0.1, 0.1, 0.04}, nullptr};
  return world;
}

/// Drives the tip to the goal, in a plant that knows of solids.
TrialOutput drive_to_goals(const World& world, const ScriptedController::Script& look = {}) {
  TrialParts parts;
  parts.controller = [&](const TrialSpec& spec) {
    return std::make_unique<ScriptedController>(
        spec.robot->model->num_velocities(), [&look](const Observation& o, StepResult& result) {
          result.command[0] = std::clamp(3.0 * (o.goal.X_WG.translation().x() - 0.9 - o.base.x()), -0.5, 0.5);
          if (look) look(o, result);
        });
  };
  return run_trial(tiny_spec(), world, parts);
}

TEST(CarriedObjects, MoveWithTheHandAndStandWhereTheyAreLeft) {
  int before = 0, held = 0, after = 0, on_plate = 0;
  const auto look = [&](const Observation& o, StepResult&) {
    const double x = o.goal.X_WG.translation().x() - 0.9;
    ASSERT_EQ(o.carried.has_value(), x > 0.7 && x < 0.9) << o.time;
    EXPECT_EQ(o.objects[0].visible, !o.carried) << "a carried object is known by its pose in E";
    if (o.carried) {
      EXPECT_EQ(o.carried->object, 0);
      EXPECT_NEAR(o.carried->X_EO.translation().norm(), 0.0, 0.02);
      on_plate += o.carried->support == 1 ? 1 : 0;
      EXPECT_TRUE(o.carried->support == 1 || o.carried->support == kNoSupport);
      ++held;
    } else {
      EXPECT_NEAR(o.objects[0].X_WO.translation().x(), x > 0.9 ? 1.7 : 1.2, 0.04);
      ++(x > 0.9 ? after : before);
    }
  };
  const TrialOutput out = drive_to_goals(carries_a_cup(), look);
  EXPECT_EQ(to_string(out.row.outcome), "success") << out.row.reason;
  EXPECT_GT(before, 20);
  EXPECT_GT(after, 5);
  EXPECT_GT(on_plate, 5);
  EXPECT_LT(on_plate, held) << "beyond the plate's edge it is clear";
  const TrialRow row = drive_to_goals(carries_a_cup(1.2)).row;
  EXPECT_EQ(row.link + " " + row.object, "slide cup") << "the hand drives on into what it left";
}

TEST(CarriedObjects, TouchWhatIsInTheirWay) {
  World world = carries_a_cup();
  world.objects.push_back(sphere("wall", {1.6, 0.0, 0.43}, 0.01));
  const TrialOutput out = drive_to_goals(world);
  EXPECT_EQ(to_string(out.row.outcome), "collision");
  EXPECT_EQ(out.row.link, "carried:cup");
  EXPECT_EQ(out.row.object, "wall");
  world.goal.take = world.further[0].leave = "";
  world.objects.erase(world.objects.begin());
  EXPECT_EQ(to_string(drive_to_goals(world).row.outcome), "success") << "the hand alone passes";
  // A second plate at the same height is no support.
  world = carries_a_cup();
  world.objects.push_back(world.objects[1]);
  world.objects.back().name = "other";
  world.objects.back().X_WO.translation().x() = 1.4;
  EXPECT_EQ(drive_to_goals(world).row.object, "other");
}

TEST(CarriedObjects, NeedAPlantThatCarries) {
  World held = carries_a_cup();
  held.held = Held{"cup", {}};
  held.goal.take = "";
  for (const World& world : {carries_a_cup(), held}) {
    const TrialRow row = run_scripted(tiny_spec(), world, drive(0.5, 0.6)).row;
    EXPECT_EQ(to_string(row.outcome), "error");
    EXPECT_NE(row.reason.find("carries no objects"), std::string::npos) << row.reason;
  }
}

/// The tip holds a cup 0.1 m ahead of it, in a world of one goal.
World holds_a_cup() {
  World world = tiny_world(0.6);
  world.held = Held{"cup", {}};
  world.objects = {sphere("cup", {1.0, 0.0, 0.5}, 0.08)};
  return world;
}

TEST(HeldObjects, AreInTheHandFromTheFirstInstant) {
  std::vector<double> times;
  const auto look = [&](const Observation& o, StepResult&) {
    times.push_back(o.time);
    ASSERT_TRUE(o.carried.has_value()) << o.time;
    EXPECT_EQ(o.carried->object, 0);
    EXPECT_NEAR((o.carried->X_EO.translation() - Vector3(0.1, 0.0, 0.0)).norm(), 0.0, 1e-12);
    EXPECT_EQ(o.carried->support, kNoSupport);
    EXPECT_FALSE(o.objects[0].visible);
  };
  const TrialOutput out = drive_to_goals(holds_a_cup(), look);
  EXPECT_EQ(to_string(out.row.outcome), "success") << out.row.reason;
  ASSERT_FALSE(times.empty());
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_EQ(out.row.goals, "");

  // The tip stops 0.33 m before the wall, the cup reaches 0.18 m ahead of it.
  World wall = holds_a_cup();
  wall.objects.push_back(sphere("wall", {1.7, 0.0, 0.5}, 0.05));
  const TrialRow hit = drive_to_goals(wall).row;
  EXPECT_EQ(to_string(hit.outcome), "collision") << hit.reason;
  EXPECT_EQ(hit.link + " " + hit.object, "carried:cup wall");
  wall.held.reset();
  wall.objects.erase(wall.objects.begin());
  EXPECT_EQ(to_string(drive_to_goals(wall).row.outcome), "success") << "the hand alone stops before it";

  // In touch at the start.
  World touching = holds_a_cup();
  touching.objects.push_back(sphere("wall", {1.1, 0.0, 0.5}, 0.05));
  const TrialRow start = drive_to_goals(touching).row;
  EXPECT_EQ(start.link + " " + start.object, "carried:cup wall");
  EXPECT_EQ(start.collision_time_s, 0.0);
}

TEST(HeldObjects, StandOnWhatIsUnderThemAndAreLeftAtGoals) {
  World world = goals_ahead({0.4, 0.45}, true);
  world.held = Held{"cup", {}};
  world.objects = {sphere("cup", {0.9, 0.0, 0.5}, 0.08), sphere("plate", {0.9, 0.0, 0.401}, 0.0)};
  world.objects[1].shape = {ShapeKind::kBox, {0.1, 0.1, 0.04}, nullptr};
  world.goal.leave = "cup";
  world.witness = world.start;
  const World again = world_from_json(nlohmann::ordered_json::parse(to_json(world).dump()), "test");
  ASSERT_TRUE(again.held.has_value());
  int on_plate = 0, clear = 0, left = 0;
  const auto look = [&](const Observation& o, StepResult&) {
    if (!o.carried)
      ++left;
    else
      ++(o.carried->support == 1 ? on_plate : clear);
    if (!o.carried) {
      EXPECT_NEAR(o.objects[0].X_WO.translation().x(), 1.3, 0.03);
    }
  };
  const TrialOutput out = drive_to_goals(again, look);
  EXPECT_EQ(out.row.goals_reached, 2.0) << out.row.reason;
  EXPECT_GT(on_plate, 5);
  EXPECT_GT(clear, 5);
  EXPECT_GT(left, 0);
}

// The upper arm is not rigid with the hand.
TEST(HeldObjects, TouchTheLinksThatTheyMay) {
  World world = holds_a_cup();
  set_pose(world.objects[0], {0.32, 0.0, 0.52}, Eigen::Quaterniond::Identity());
  const TrialRow hit = drive_to_goals(world).row;
  EXPECT_EQ(to_string(hit.outcome), "collision");
  EXPECT_EQ(hit.object, "self:carried:cup") << hit.reason;
  const std::string link = hit.link;
  world.held->touch = {link, "slide"};
  const TrialOutput out = drive_to_goals(world, [&](const Observation& o, StepResult&) {
    EXPECT_EQ((o.carried->touch.array() >= 0.0).count(), 1) << "the hand needs none";
  });
  EXPECT_EQ(to_string(out.row.outcome), "success") << out.row.reason;
  world.held->touch = {"elbow"};
  const TrialRow row = drive_to_goals(world).row;
  EXPECT_EQ(to_string(row.outcome), "error");
  EXPECT_NE(row.reason.find("robot tiny has no link 'elbow'"), std::string::npos) << row.reason;
}

/// A controller of moma that is not told what the hand holds.
class Forgetful : public StepController {
 public:
  explicit Forgetful(const TrialSpec& spec)
      : own_(spec.robot->model, told_params(spec), spec.simulation.control_period) {}
  void reset(std::span<const ObjectShape> objects) override { own_.reset(objects); }
  void prepare(StepResult& result) const override { own_.prepare(result); }
  void step(const Observation& observation, StepResult& result) noexcept override {
    seen_ = observation;
    seen_.carried.reset();
    own_.step(seen_, result);
  }

 private:
  Controller own_;
  Observation seen_;
};

// A rod in the Panda's hand hangs as low as a post on the way; the hand alone would pass above it.
TEST(HeldObjects, AreCarriedPastWhatTheHandAloneWouldPass) {
  const Scratch folder;
  const std::string configs = MOMA_SOURCE_DIR "/configs/";
  for (const char* mode : {"kinematic", "dynamic"}) {
    const Suite suite = load_suite(folder.write(
        "suite.yaml", "name: rod\nrobot: " + configs + "robots/panda.yaml\ncontrollers: {moma: " + configs +
                          "controllers/moma.yaml}\nworlds: {families: {open: {}}}\nsimulation: {mode: " + mode +
                          ", time_limit: 20}\ntrials: 1\n"));
    const SuitePoint& point = suite.points.front();
    const auto& model = point.robot->model;
    World world;
    world.start.q = world.witness.q = model->ready;
    world.witness.q[0] = 1.2;
    Kinematics kinematics(model);
    kinematics.update(Vector3::Zero(), world.witness.q);
    set_pose(world.goal, kinematics.X_WE().translation(), Eigen::Quaterniond(kinematics.X_WE().linear()));
    kinematics.update(Vector3::Zero(), world.start.q);
    const Isometry& X_WE = kinematics.X_WE();
    WorldObject rod, post;
    rod.name = "rod";
    rod.shape = {ShapeKind::kBox, {0.03, 0.03, 0.3}, nullptr};
    set_pose(rod, X_WE * Vector3(0.0, 0.0, 0.15), Eigen::Quaterniond(X_WE.linear()));
    post.name = "post";
    const double radius = X_WE.translation().head<2>().norm(), height = X_WE.translation().z() - 0.12;
    post.shape = {ShapeKind::kBox, {0.06, 0.06, height}, nullptr};
    set_pose(post, {radius * std::cos(0.6), radius * std::sin(0.6), 0.5 * height}, Eigen::Quaterniond::Identity());
    world.objects = {rod, post};
    world.held = Held{"rod", {}};
    world = world_from_json(nlohmann::ordered_json::parse(to_json(world).dump()), "rod");

    const TrialRow past = run_trial(point, world).row;
    EXPECT_EQ(to_string(past.outcome), "success") << mode << ": " << past.reason;
    TrialParts forgets;
    forgets.controller = [](const TrialSpec& spec) { return std::make_unique<Forgetful>(spec); };
    const TrialRow hit = run_trial(point, world, forgets).row;
    EXPECT_EQ(hit.link + " " + hit.object, "carried:rod post") << mode << ": " << hit.reason;
    world.held.reset();
    world.objects.erase(world.objects.begin());
    EXPECT_EQ(to_string(run_trial(point, world).row.outcome), "success") << mode;
  }
}

TEST(TrialGoals, OneGoalHasNoneOfThis) {
  const TrialRow row = run_scripted(tiny_spec(), tiny_world(0.4), drive(0.5, 0.8)).row;
  EXPECT_TRUE(std::isnan(row.goals_reached));
  EXPECT_EQ(row.goals, "");
}

TEST(TrialGoals, HaveRowsOfTheirOwnInTheStore) {
  const TemporaryFolder folder;
  const store::Wanted job = synthetic_wanted(0, 4);
  TrialRow row = synthetic_row(0, 4);
  row.goals = R"([{"time_s":0.75,"clearance_m":null},{"time_s":2.0,"clearance_m":0.25}])";
  {
    store::Writer writer(folder / "a.db");
    writer.begin(synthetic_suite({"one"}), {{"moma", "run"}, 1}, std::vector{job});
    writer.add(job, synthetic_world(4), row, nullptr);
    writer.finish(store::RunStatus::kFinished);
  }
  const auto rows =
      store::query(folder / "a.db", "SELECT world, goal, time_s, leg_s, clearance_m FROM v_goals ORDER BY goal").rows;
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(std::get<std::int64_t>(rows[1][0]), 4);
  EXPECT_EQ(std::get<std::int64_t>(rows[1][1]), 2);
  EXPECT_EQ(std::get<double>(rows[0][3]), 0.75);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(rows[0][4]));
  EXPECT_EQ(std::get<double>(rows[1][2]), 2.0);
  EXPECT_EQ(std::get<double>(rows[1][3]), 1.25);
  EXPECT_EQ(std::get<double>(rows[1][4]), 0.25);
}

// The tiny robot cannot roll: a rolled goal is out of reach unless the roll is free.
TEST(FreeDirections, ReachWhatNoWholePoseDoes) {
  TrialSpec spec = tiny_spec();
  World world = tiny_world(0.3);
  world.goal.X_WG.linear() = Eigen::AngleAxisd(1.0, Vector3::UnitX()).toRotationMatrix();
  EXPECT_NE(run_trial(spec, world).row.outcome, Outcome::kSuccess);
  world.goal.free[0] = 1.0;
  const TrialRow axis = run_trial(spec, world).row;
  EXPECT_EQ(to_string(axis.outcome), "success") << axis.reason;
  world.goal.X_WG.linear() = Eigen::AngleAxisd(2.5, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_NE(run_trial(spec, world).row.outcome, Outcome::kSuccess) << "the axis points elsewhere";
  world.goal.free.head<3>().setOnes();
  const TrialRow position = run_trial(spec, world).row;
  EXPECT_EQ(to_string(position.outcome), "success") << position.reason;
  EXPECT_LT(position.position_error_m, spec.success.position);
}

Isometry any_pose(std::uint64_t item) {
  Draws draws(7, 1, Stream::kGoal, 0, item);
  Isometry X = Isometry::Identity();
  X.translation() = Vector3(draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-1, 1));
  const Vector3 axis(draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-1, 1));
  X.linear() = Eigen::AngleAxisd(draws.uniform(-3, 3), axis.normalized()).toRotationMatrix();
  return X;
}

double angle_between(const Matrix3& A, const Matrix3& B) {
  return Eigen::AngleAxisd(Matrix3(A.transpose() * B)).angle();
}

// By search: among the poses that the goal allows, none is nearer.
TEST(FreeDirections, TheNearestPoseIsAllowedAndNearest) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Isometry X_WE = any_pose(2 * i);
    GoalState goal{any_pose(2 * i + 1), Vector6::Zero()};
    EXPECT_EQ(nearest_pose(goal.X_WG, goal.free, X_WE).matrix(), goal.X_WG.matrix());
    const Matrix3& R_WG = goal.X_WG.linear();
    const int a = static_cast<int>(i % 3);

    goal.free[a] = goal.free[3 + a] = 1.0;
    const Isometry about = nearest_pose(goal.X_WG, goal.free, X_WE);
    EXPECT_NEAR((about.linear().col(a) - R_WG.col(a)).norm(), 0.0, 1e-12) << "the axis stays";
    EXPECT_NEAR(about.linear().determinant(), 1.0, 1e-12);
    const double found = angle_between(about.linear(), X_WE.linear());
    for (double turn = -3.1; turn < 3.2; turn += 0.05) {
      const Matrix3 other = R_WG * Eigen::AngleAxisd(turn, Vector3::Unit(a)).toRotationMatrix();
      EXPECT_GE(angle_between(other, X_WE.linear()), found - 1e-9);
    }
    const Vector3 left = R_WG.transpose() * (about.translation() - X_WE.translation());
    const Vector3 whole = R_WG.transpose() * (goal.X_WG.translation() - X_WE.translation());
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(left[k], k == a ? 0.0 : whole[k], 1e-12);

    goal.free.setZero();
    goal.free[(a + 1) % 3] = goal.free[(a + 2) % 3] = 1.0;
    const Isometry tilted = nearest_pose(goal.X_WG, goal.free, X_WE);
    EXPECT_NEAR(Eigen::Quaterniond(Matrix3(R_WG.transpose() * tilted.linear())).vec()[a], 0.0, 1e-12) << "no twist";
    const Vector6 e = pose_error(X_WE, tilted);
    EXPECT_NEAR(e.head<3>().cross(X_WE.linear().col(a)).norm(), 0.0, 1e-9) << "E turns about its own axis";

    goal.free.head<3>().setOnes();
    EXPECT_EQ(nearest_pose(goal.X_WG, goal.free, X_WE).linear(), X_WE.linear());
    EXPECT_EQ(nearest_pose(goal.X_WG, goal.free, X_WE).translation(), goal.X_WG.translation());
  }
}

TEST(PassingThrough, TheSpeedStaysOverTheLastWay) {
  const ServoParams params{.position = 2.0, .orientation = 1.0, .max_linear = 0.5};
  Vector6 v = Vector6::Zero();
  v[3] = 0.1;
  const auto twist = [&](double turn, double way) {
    Vector6 e = Vector6::Zero();
    e[0] = turn;
    e[4] = way;
    const Vector6 nu = passing_twist(params, e, v) - v;
    return std::pair(nu[0], nu[4]);
  };
  using Pair = std::pair<double, double>;
  EXPECT_EQ(twist(0.5, 0.4), Pair(0.5, 0.5)) << "far away as the servo, clamped";
  const auto [turn, way] = twist(0.2, 0.15);
  EXPECT_NEAR(turn, 0.4, 1e-12) << "twice as quick 0.15 m before the goal";
  EXPECT_NEAR(way, 0.5, 1e-12) << "and never above the limit";
  EXPECT_NEAR(twist(0.0, 0.05).second, 3.0 * 2.0 * 0.05, 1e-12) << "three times at most";
  EXPECT_NEAR(twist(0.1, 0.0).first, 3.0 * 0.1, 1e-12);
  EXPECT_EQ(twist(0.0, 0.0), Pair(0.0, 0.0));
}

}  // namespace
}  // namespace moma::test
