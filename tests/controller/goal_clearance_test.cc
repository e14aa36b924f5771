// Distances near the goal: the hand's by coal at a configuration that has it there, and whether goals that are nearer
// to objects than rows keep, or nearer to joint limits than paths keep, are planned for and reached.
#include "controller/safe/goal_clearance.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "controller/controller_core.h"
#include "controller/lookahead/path_watch.h"
#include "controller/qp/collision.h"
#include "tests/controller/plan_scenes.h"

namespace moma::test {
namespace {

ControllerParams params_at_goal(const RobotModel& model, bool on) {
  ControllerParams params = plan_params(model);
  params.collision.at_goal.enabled = on;
  return params;
}

/// The Panda with its hand at a configuration of the witness's, a ball `gap` from the hand's nearest solid.
struct Grasp {
  std::shared_ptr<const RobotModel> model = load_model("configs/robots/panda.yaml");
  WholeConfiguration witness;
  Scene scene;

  explicit Grasp(double gap) {
    scene = make_scene(model, 1, 0);
    witness = WholeConfiguration::Zero(3 + model->num_joints());
    witness.tail(7) << 0.6, 0.2, -0.3, -1.7, 0.1, 1.9, 0.5;
    Kinematics kinematics(model);
    kinematics.update(witness.head<3>(), witness.tail(7));
    scene.X_WG = kinematics.X_WE();
    scene.shapes = {{"ball", make_sphere(0.05)}};
    scene.states.resize(1);
    // Along the hand's axis, from far to where the gap is left.
    double along = 0.4;
    do {
      along -= 2e-4;
      scene.states[0].X_WO.translation() = kinematics.X_WE() * Vector3(0.0, 0.0, along);
    } while (object_clearance(*model, kinematics, scene) > gap);
  }
};

TEST(GoalClearance, IsThatOfTheHandWhereverTheRobotIs) {
  const auto model = load_model("configs/robots/frankie.yaml");
  GoalClearance hand(*model);
  Kinematics here(model), at_goal(model);
  Proximity proximity(model);
  constexpr double kRange = 0.5;
  int near = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Scene scene = make_scene(model, seed, 12);
    std::mt19937_64 engine(seed);
    VectorX q = model->ready;
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] += uniform_in(engine, -0.4, 0.4);
    at_goal.update({uniform_in(engine, -1.0, 4.0), uniform_in(engine, -1.0, 1.0), uniform_in(engine, -3.0, 3.0)}, q);
    here.update(scene.start.head<3>(), scene.start.tail(model->num_joints()));
    scene.states[0].V_WO_W[4] = 0.3;  // what moves does not count,
    scene.states[1].visible = false;  // nor what is not seen
    double expected = kRange;
    for (const CollisionShape& shape : model->shapes) {
      const std::string& link = model->links[static_cast<std::size_t>(shape.link)].name;
      if (link != "panda_link7" && link != "panda_link8" && link != "panda_hand") continue;
      for (std::size_t k = 2; k < scene.shapes.size(); ++k)
        expected = std::min(
            expected, coal_distance(shape.shape, at_goal.X_WS(shape), scene.shapes[k].shape, scene.states[k].X_WO));
    }
    near += expected < kRange ? 1 : 0;
    proximity.set_objects(scene.shapes);
    hand.allocate(scene.shapes.size());
    EXPECT_NEAR(hand.least(here, at_goal.X_WE(), scene.states, kRange, proximity), expected, 2e-5) << "seed " << seed;
  }
  EXPECT_GT(near, 8) << "too few to say anything";
}

TEST(GoalClearance, WhatIsKeptGrowsFromTheGoalToAllOfIt) {
  const KeptDistance kept{0.004, 0.25, {1.0, 0.0, 0.0}};
  EXPECT_DOUBLE_EQ(kept.of(0.03, {1.0, 0.0, 0.0}), 0.004);
  EXPECT_DOUBLE_EQ(kept.of(0.03, {1.0, 0.04, 0.0}), 0.014);
  EXPECT_DOUBLE_EQ(kept.of(0.03, {1.0, 0.0, -0.2}), 0.03);
  EXPECT_DOUBLE_EQ(kept.of(0.002, {1.0, 0.0, 0.0}), 0.002) << "never more than far from the goal";
  EXPECT_DOUBLE_EQ(KeptDistance{}.of(0.03, Vector3::Zero()), 0.03);
}

// A goal with the hand 6 mm from a ball: rows that stop at 3 cm everywhere keep the robot from it.
TEST(GoalClearance, RowsLetTheHandComeToItsObject) {
  const Grasp grasp(0.006);
  for (const bool on : {false, true}) {
    ControllerParams params = params_at_goal(*grasp.model, on);
    params.plan.enabled = false;
    params.collision.object.stop = 0.03;
    ControllerCore controller(grasp.model, params, 0.02);
    controller.reset(grasp.scene.shapes);
    StepResult result;
    controller.prepare(result);
    Observation o;
    o.q = grasp.witness.tail(7) + VectorX::Constant(7, 0.05);
    o.qdot = VectorX::Zero(7);
    o.goal.X_WG = grasp.scene.X_WG;
    o.objects = grasp.scene.states;
    double least = 1.0;
    Kinematics kinematics(grasp.model);
    for (int k = 0; k < 500; ++k) {
      controller.step(o, result);
      integrate(*grasp.model, o.base, o.q, result.command, 0.02);
      o.qdot = result.command;
      kinematics.update(o.base, o.q);
      least = std::min(least, object_clearance(*grasp.model, kinematics, grasp.scene));
    }
    const double error = result.error.tail<3>().norm();
    EXPECT_GT(least, 0.001) << on;
    if (on)
      EXPECT_LT(error, 0.002);
    else
      EXPECT_GT(error, 0.01) << "the goal asks nothing of the rows";
  }
}

/// A ball `gap` from the forearm, far from the hand.
struct ByTheForearm : Grasp {
  explicit ByTheForearm(double gap) : Grasp(0.1) {
    Kinematics kinematics(model);
    kinematics.update(witness.head<3>(), witness.tail(7));
    const Isometry& X_W5 = kinematics.X_WL(model->find_link("panda_link5"));
    double along = 0.5;
    do {
      along -= 2e-4;
      scene.states[0].X_WO.translation() = X_W5 * Vector3(0.0, along, -0.2);
    } while (object_clearance(*model, kinematics, scene) > gap);
  }
};

/// Collision rows where the hand is at its goal.
struct Rows {
  Grasp grasp;
  ControllerParams params;
  Deceleration deceleration{*grasp.model, params.acceleration_limit, false};
  Uncertainty uncertainty{params.uncertainty, 0};
  CollisionRows rows{*grasp.model, params.collision, deceleration, uncertainty};
  Kinematics kinematics{grasp.model};
  Proximity proximity{grasp.model};
  QpProblem problem;

  Rows(Grasp of, ControllerParams with) : grasp(std::move(of)), params(std::move(with)) {
    kinematics.update(grasp.witness.head<3>(), grasp.witness.tail(7));
    proximity.set_objects(grasp.scene.shapes);
    problem.allocate(7 + 6, rows.allocate(1));
  }

  /// The bound of the nearest pair's row.
  double bound() {
    problem.rows = 0;
    rows.select(proximity.query(kinematics, grasp.scene.states, rows.ranges()), grasp.scene.states);
    rows.add(kinematics, grasp.scene.states, {}, problem);
    EXPECT_GT(problem.rows, 0);
    return problem.ubA[0];
  }
};

// With the hand at its goal, 10 mm are too little for the forearm and enough for the hand.
TEST(GoalClearance, BringsNoOtherPartThanTheHandNear) {
  constexpr double kGap = 0.01, kHand = 0.003, kClearance = 0.0175;
  const Grasp of_hand(kGap);
  const ByTheForearm of_arm(kGap);
  for (const Grasp* grasp : {&of_hand, static_cast<const Grasp*>(&of_arm)}) {
    const bool arm = grasp == &of_arm;
    const ControllerParams params = params_at_goal(*grasp->model, true);
    const MotionLimits limits(*grasp->model, params);
    FreeSpace space(grasp->model, limits);
    space.set_objects(grasp->scene.shapes);
    space.set_states(grasp->scene.states);
    Keeps keeps = space.keeps();
    keeps.clearances = {kClearance, -1.0, -1.0};
    space.keep(keeps);
    space.keep_near({kHand, 0.25, grasp->scene.X_WG.translation()});
    EXPECT_EQ(space.free(grasp->witness), !arm);
    space.keep_near({kHand, 0.25, grasp->scene.X_WG.translation()}, 0.9 * kGap);
    EXPECT_TRUE(space.free(grasp->witness));
    space.keep_near({});
    EXPECT_FALSE(space.free(grasp->witness));

    Rows at(*grasp, params);
    at.rows.keep_from_resting({kHand, kClearance, kClearance}, 15.0);
    EXPECT_EQ(at.bound() < 0.0, arm) << "the row asks for more distance";
  }
}

// With the hand at a goal that is close to a ball, a base 15 mm beside a post has to leave it.
TEST(GoalClearance, BringsTheBaseNoNearer) {
  const auto model = load_model("configs/robots/frankie.yaml");
  Kinematics kinematics(model);
  kinematics.update(Vector3::Zero(), model->ready);
  const auto approach = [&](const Shape& shape, const Isometry& X, const Vector3& along, double gap) {
    Scene scene;
    scene.shapes = {{"", shape}};
    scene.states.resize(1);
    for (double way = 1.0; way > 0.0; way -= 2e-4) {
      scene.states[0].X_WO = X * Eigen::Translation3d(way * along);
      if (object_clearance(*model, kinematics, scene) <= gap) break;
    }
    return scene.states[0];
  };
  constexpr double kGap = 0.015;
  const Shape ball = make_sphere(0.05), post = make_cylinder(0.05, 0.1);
  ControllerParams params = params_at_goal(*model, true);
  params.plan.enabled = false;
  params.collision.braking.enabled = false;
  ControllerCore controller(model, params, 0.02);
  controller.reset(std::vector<ObjectShape>{{"ball", ball}, {"post", post}});
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(model->num_velocities());
  o.goal.X_WG = kinematics.X_WE();
  o.objects = {approach(ball, kinematics.X_WE(), Vector3::UnitZ(), 0.008),
               approach(post, Isometry(Eigen::Translation3d(0.0, 0.0, 0.1)), Vector3::UnitY(), kGap)};
  StepResult result;
  controller.prepare(result);
  controller.step(o, result);
  const QpProblem& problem = controller.problem();
  int rows = 0;
  for (int row = 0; row < problem.rows; ++row) {
    const RowId& id = problem.ids[static_cast<std::size_t>(row)];
    if (id.kind != RowKind::kObject) continue;
    if (id.second == 0 && id.d < 0.01) {
      EXPECT_GT(problem.ubA[row], 0.0) << "the hand may be there";
    }
    if (id.second != 1 || id.d > kGap + 1e-3) continue;
    ++rows;
    EXPECT_TRUE(model->shape(id.first).rigid_with_base);
    EXPECT_LT(problem.ubA[row], 0.0) << "d " << id.d;
  }
  EXPECT_GT(rows, 0);
}

// A path that brings the forearm as near to a ball as it was planned near its goal is not broken.
TEST(GoalClearance, WatchAsksOfTheArmWhatItsPathKeeps) {
  const ByTheForearm grasp(0.008);
  const ControllerParams params = params_at_goal(*grasp.model, true);
  const MotionLimits limits(*grasp.model, params);
  PathWatch watch(grasp.model, params.plan.decisions, limits, params.collision.at_goal.slope);
  watch.set_objects(grasp.scene.shapes);
  Path path;
  path.begin(grasp.witness);
  path.duration = 1.0;
  ASSERT_TRUE(path.add({0.0, {1.0, 0.5, 0.5}, WholeConfiguration::Zero(grasp.witness.size())}));
  path.X_WG = grasp.scene.X_WG;
  path.clearance = 0.035;
  path.kept_at_goal = 0.003;
  for (const double arm : {0.00875, kInfinity}) {
    path.arm_at_goal = arm;
    watch.forget();
    long budget = 100;
    EXPECT_EQ(watch.holds(path, {}, 0.0, grasp.scene.states, budget), arm < kInfinity) << arm;
  }
}

// The damper's row lets a distance of 8 mm shrink at gain (d - d_s)/(d_i - d_s); on a path at its rate, which is
// higher.
TEST(GoalClearance, PathsMayComeNearAtARateOfTheirOwn) {
  const Grasp grasp(0.008);
  ControllerParams params = params_at_goal(*grasp.model, true);
  params.collision.object = {true, 0.3, 0.03, 0.6};
  params.collision.braking.enabled = false;
  Rows at(grasp, params);
  constexpr double kStop = 0.003;
  for (const double rate : {0.0, 1.0, 15.0}) {
    at.rows.keep_from_resting({kStop, kStop, kStop}, rate);
    const double bound = at.bound(), d = at.problem.ids[0].d, own = 0.6 / (0.3 - kStop);
    EXPECT_NEAR(bound, std::max(own, rate) * (d - kStop), 1e-12) << rate;
    EXPECT_NEAR(d, 0.008, 3e-4);
  }
}

// Braking bounds the speed of approach to 8 mm, unless a path asks for more; the damper's bound holds all the same, and
// braking's before an object that was never seen.
TEST(GoalClearance, PathsMayComeNearFasterThanTheRobotBrakes) {
  const Grasp grasp(0.008);
  ControllerParams params = params_at_goal(*grasp.model, true);
  params.collision.object = {true, 0.3, 0.03, 0.6};
  params.collision.braking = {.enabled = true, .share = 1e-3, .reaction = 0.0};
  Rows at(grasp, params);
  constexpr double kStop = 0.003, kRate = 15.0;
  at.rows.keep_from_resting({kStop, kStop, kStop}, kRate);
  const auto bound = [&](const VectorX* path) {
    at.rows.allow(path);
    return at.bound();
  };
  const double brakes = bound(nullptr);
  const VectorX row = at.problem.A.row(0).head(7).transpose();
  const double damped = kRate * (at.problem.ids[0].d - kStop);
  ASSERT_LT(brakes, 0.3 * damped);
  for (const double share : {-1.0, 0.5, 2.0}) {
    const VectorX path = row * (share * damped / row.squaredNorm());
    EXPECT_NEAR(bound(&path), std::max(brakes, std::min(share, 1.0) * damped), 1e-12) << share;
  }
  const VectorX path = row * (0.5 * damped / row.squaredNorm());
  at.grasp.scene.states[0].seen = false;
  at.rows.keep_from_unseen(params.collision.object);
  EXPECT_LT(bound(&path), brakes) << "never seen";
}

TEST(GoalClearance, PathsLeadToGoalsThatAreNearerThanTheClearance) {
  const Grasp grasp(0.008);
  Kinematics kinematics(grasp.model);
  for (const bool on : {false, true}) {
    Planner planner(grasp.model, params_at_goal(*grasp.model, on));
    EXPECT_EQ(plan_whole(planner, grasp.scene, 1), on);
    if (!on) continue;
    const double clearance = planner.path().clearance;
    WholeConfiguration c;
    double nearest = 1.0;
    for (double t = 0.0; t < planner.path().duration + 0.02; t += 0.02) {
      planner.path().at(t, c);
      kinematics.update(c.head<3>(), c.tail(7));
      const double left = (kinematics.X_WE().translation() - grasp.scene.X_WG.translation()).norm();
      const double d = object_clearance(*grasp.model, kinematics, grasp.scene);
      nearest = std::min(nearest, d);
      // Between two checks a path may be a little nearer than at them, and half as near where motions overlap.
      EXPECT_GT(d, 0.4 * std::min(clearance, planner.path().kept_at_goal + 0.25 * left)) << t;
    }
    EXPECT_NEAR(nearest, 0.008, 0.003);
  }
}

// The goal's only configurations nearby have a joint 0.01 rad from its limit.
TEST(GoalClearance, PathsLeadToGoalsAtAJointsLimit) {
  const auto model = load_model("configs/robots/panda.yaml");
  Scene scene = make_scene(model, 1, 0);
  WholeConfiguration goal = scene.start;
  goal[3 + 3] = model->joints[3].lower + 0.01;  // the elbow, folded, and the wrist outwards: no other one is so near
  goal[3 + 1] = -0.5;
  goal[3 + 5] = 2.2;
  Kinematics kinematics(model);
  kinematics.update(goal.head<3>(), goal.tail(7));
  ASSERT_GT(own_clearance(*model, kinematics), 0.02);
  scene.X_WG = kinematics.X_WE();
  for (const bool on : {false, true}) {
    Planner planner(model, params_at_goal(*model, on));
    EXPECT_EQ(plan_whole(planner, scene, 1), on);
    if (!on) continue;
    planner.begin(scene.start, scene.X_WG, scene.states, 1, 1e3);
    long budget = 1L << 40;
    planner.advance(budget);
    EXPECT_FALSE(planner.found()) << "the policy arrives in 1000 s: a path that is quicker has to keep its distance";
  }
}

}  // namespace
}  // namespace moma::test
