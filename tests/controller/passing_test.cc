// Rows that let objects in motion pass: their tangents against a search over angles, their rate against predicted
// motion, what they leave alone, and what they are for.

#include "controller/qp/passing.h"

#include <gtest/gtest.h>

#include "tests/controller/rig.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

ControllerParams with_passing(double clearance = 0.0) {
  ControllerParams p;
  p.collision.passing = {.enabled = true, .horizon = 4.0, .clearance = clearance};
  p.collision.max_pairs = 200;
  return p;
}

// A convex hull: the corners of a wedge.
Shape wedge() {
  auto hull = std::make_shared<ConvexHull>();
  hull->vertices = {{-0.2, -0.1, 0}, {0.3, -0.1, 0}, {-0.2, 0.25, 0}, {-0.2, -0.1, 0.4}, {0.3, -0.1, 0.4}};
  return {ShapeKind::kConvex, Vector3::Zero(), hull};
}

Shape random_shape(Rng& rng) { return rng() % 5 == 0 ? wedge() : random_object(rng, "o").shape; }

Isometry random_pose(Rng& rng, double spread) {
  Isometry X = Isometry::Identity();
  X.linear() = random_rotation(rng);
  X.translation() = random_vector(rng, spread);
  return X;
}

// Whether the solids' shadows overlap when the robot's is moved by `by`, by separating directions.
bool shadows_meet(const Shape& robot, const Isometry& X_WR, const Shape& object, const Isometry& X_WO,
                  const Vector3& by) {
  for (int k = 0; k < 2000; ++k) {
    const double angle = 2 * kPi * k / 2000;
    const Vector3 n(std::cos(angle), std::sin(angle), 0);
    const double gap = n.dot(by) + n.dot(support_point(robot, X_WR, -n)) - n.dot(support_point(object, X_WO, n));
    if (gap > 0.0) return false;
  }
  return true;
}

TEST(Passing, SupportPointsAreTheFurthestOfTheSolid) {
  Rng rng(41);
  for (int trial = 0; trial < 300; ++trial) {
    const Shape shape = random_shape(rng);
    const Isometry X = random_pose(rng, 1.0);
    const Vector3 n = random_vector(rng, 1.0).normalized();
    const Vector3 p = support_point(shape, X, n);
    // It belongs to the solid, and a half-space beyond it touches the solid there.
    EXPECT_LT(shape_distance({ShapeKind::kSphere, {1e-6, 0, 0}, nullptr},
                             Eigen::Translation3d(p) * Isometry::Identity(), shape, X)
                  .d,
              1e-5);
    const Isometry up(Eigen::Quaterniond::FromTwoVectors(n, -Vector3::UnitZ()));
    EXPECT_NEAR(lowest_point(shape, up * X), -n.dot(p), 1e-9) << to_string(shape.kind);
  }
}

TEST(Passing, TangentsTouchAndNothingSticksOut) {
  Rng rng(42);
  int found = 0, direct = 0, inside = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Shape robot = random_shape(rng), object = random_shape(rng);
    const Isometry X_WR = random_pose(rng, 0.6), X_WO = random_pose(rng, 0.6);
    const Vector3 v = random_vector(rng, 0.5);
    const Tangent t = passing_tangent(robot, X_WR, object, X_WO, v);
    if (!t.exists) {
      EXPECT_TRUE(shadows_meet(robot, X_WR, object, X_WO, Vector3::Zero())) << trial;
      ++inside;
      continue;
    }
    ++found;
    EXPECT_NEAR(t.n_W.norm(), 1.0, 1e-9);
    EXPECT_NEAR(t.n_W.dot(t.along_W), 0.0, 1e-8);
    EXPECT_EQ(t.n_W.z(), 0.0);
    // Moved along the tangent, with a hair's breadth to the outside nothing is met; to the inside, the object is: not
    // there where the shadow ends in a sharp corner that leans, but a little before or after.
    const Vector3 there = t.length * t.along_W;
    EXPECT_FALSE(shadows_meet(robot, X_WR, object, X_WO, there + 1e-4 * t.n_W)) << trial;
    const Vector3 inside_W = there - 1e-4 * t.n_W;
    bool met = shadows_meet(robot, X_WR, object, X_WO, inside_W);
    direct += met;
    for (double along = 1e-4; !met && along < 0.01; along *= 2.0)
      met = shadows_meet(robot, X_WR, object, X_WO, inside_W + along * t.along_W) ||
            shadows_meet(robot, X_WR, object, X_WO, inside_W - along * t.along_W);
    EXPECT_TRUE(met) << trial;
  }
  EXPECT_GT(found, 800);
  EXPECT_GT(direct, 0.99 * found);
  EXPECT_GT(inside, 100);
}

// Predicted for `time` at constant velocities of both, the way of the robot's centre relative to the object's.
Vector3 relative_way(const RobotModel& model, const Observation& o, const RowId& id, const VectorX& v, double time) {
  Vector3 base = o.base;
  VectorX q = o.q;
  integrate(model, base, q, v, time);
  Kinematics before(std::make_shared<RobotModel>(model)), after(std::make_shared<RobotModel>(model));
  before.update(o.base, o.q);
  after.update(base, q);
  const CollisionShape& shape = model.shapes[static_cast<std::size_t>(id.first)];
  const Vector3 moved = after.X_WS(shape).translation() - before.X_WS(shape).translation();
  return moved - time * o.objects[static_cast<std::size_t>(id.second)].V_WO_W.tail<3>();
}

// A X qdot <= ub says n^T (relative velocity) >= -gap/horizon: against differences of the predicted positions.
TEST(Passing, RowsMatchThePredictedMotion) {
  Rng rng(43);
  int checked = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto model = built_robots()[1 + rng() % 2];
    const ControllerParams p = with_passing();
    const std::vector<ObjectShape> shapes = random_objects(rng, 6);
    Rig rig(model, p, shapes);
    const ControllerCore& c = rig.controller;
    Observation o = random_observation(*model, shapes.size(), rng, 1.5);
    for (ObjectState& s : o.objects) s.X_WO.translation().z() = 0.3;
    rig.step(o);
    for (int r = 0; r < c.problem().rows; ++r) {
      const RowId& id = c.problem().ids[static_cast<std::size_t>(r)];
      if (id.kind != RowKind::kPassing) continue;
      const CollisionShape& part = model->shapes[static_cast<std::size_t>(id.first)];
      const Isometry X_WS = c.kinematics().X_WS(part);
      const ObjectState& state = o.objects[static_cast<std::size_t>(id.second)];
      const Shape& object = shapes[static_cast<std::size_t>(id.second)].shape;
      const Tangent t = passing_tangent(part.shape, X_WS, object, state.X_WO, state.V_WO_W.tail<3>());
      ASSERT_TRUE(t.exists);
      const Vector3 to = ((state.X_WO.translation() - X_WS.translation()).cwiseProduct(Vector3(1, 1, 0))).normalized();
      const double gap = to.dot(support_point(object, state.X_WO, -to)) - to.dot(support_point(part.shape, X_WS, to));
      const VectorX v = VectorX::NullaryExpr(model->num_velocities(), [&] { return uniform(rng, -0.5, 0.5); });
      const double h = 1e-5;
      const Vector3 rate = (relative_way(*model, o, id, v, h) - relative_way(*model, o, id, v, -h)) / (2 * h);
      const double row = c.problem().A.row(r).head(model->num_velocities()).dot(v);
      EXPECT_NEAR(c.problem().ubA[r] - row, t.n_W.dot(rate) + std::max(gap, 0.0) / 4.0, 1e-8) << c.row_name(r);
      EXPECT_EQ(c.row_name(r), "passing/" + shapes[static_cast<std::size_t>(id.second)].name + "/" + part.name);
      ++checked;
    }
  }
  EXPECT_GT(checked, 150);
}

// What the rows promise: a relative velocity that keeps to one with no gap allowed for never meets the object.
TEST(Passing, WhatARowAllowsNeverMeetsTheObject) {
  Rng rng(44);
  int met = 0, passed = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Shape robot = random_shape(rng), object = random_shape(rng);
    const Isometry X_WR = random_pose(rng, 0.8), X_WO = random_pose(rng, 0.8);
    Vector3 w = random_vector(rng, 1.0);
    w.z() = 0.0;
    const Tangent t = passing_tangent(robot, X_WR, object, X_WO, -w);
    if (!t.exists) continue;
    bool meets = false;
    for (double time = 0.0; time < 4.0 && !meets; time += 0.02)
      meets = shadows_meet(robot, X_WR, object, X_WO, time * w);
    if (t.n_W.dot(w) >= 0.0) {
      EXPECT_FALSE(meets) << trial;
    }
    (meets ? met : passed) += 1;
  }
  EXPECT_GT(met, 20);
  EXPECT_GT(passed, 50);
}

// A ball comes at a differential base from the side: the base drives out of its way, on the side where it is, while
// the ball is still beyond the influence of any pair. With the usual rows alone it stands until it is hit.
TEST(Passing, TheBaseDrivesOutOfTheWay) {
  const auto model = frankie();
  for (const double ahead : {-0.1, 0.1}) {
    for (const bool on : {false, true}) {
      ControllerParams p = with_passing(0.1);
      p.collision.passing.enabled = on;
      const std::vector<ObjectShape> ball = {{"ball", {ShapeKind::kSphere, {0.15, 0, 0}, nullptr}}};
      Rig rig(model, p, ball);
      Observation o;
      o.q = model->ready;
      o.qdot = VectorX::Zero(9);
      Kinematics kin(model);
      kin.update(o.base, o.q);
      o.goal.X_WG = kin.X_WE();
      o.objects.resize(1);
      o.objects[0].X_WO.translation() = Vector3(ahead, 0.8, 0.3);
      o.objects[0].V_WO_W << 0, 0, 0, 0, -0.4, 0;
      rig.step(o);
      ASSERT_EQ(rig.result.status, StepStatus::kSolved);
      if (on) {
        EXPECT_LT(rig.result.command[0] * ahead, -0.005) << "away from the path at x = " << ahead;
      } else {
        EXPECT_LT(std::abs(rig.result.command[0]), 0.01);
      }
    }
  }
}

TEST(Passing, FixedBasesStillHiddenHighAndDisabledObjectsHaveNoRows) {
  const auto rows = [](const std::shared_ptr<const RobotModel>& model, const ObjectState& state, bool collisions) {
    ControllerParams p = with_passing();
    p.collision.object.enabled = collisions;
    const std::vector<ObjectShape> ball = {{"ball", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}};
    Rig rig(model, p, ball);
    Observation o;
    o.q = model->ready;
    o.qdot = VectorX::Zero(model->num_velocities());
    o.goal.X_WG = pose(0.5, 0, 0.8, kPi, 0, 0);
    o.objects = {state};
    rig.step(o);
    return rig.rows(RowKind::kPassing);
  };
  ObjectState state;
  state.X_WO.translation() = Vector3(0.2, 1.2, 0.35);
  state.V_WO_W << 0, 0, 0, 0, -0.3, 0;
  EXPECT_EQ(rows(frankie(), state, true), 1);
  EXPECT_EQ(rows(mecanum(), state, true), 1);
  EXPECT_EQ(rows(panda(), state, true), 0) << "a fixed base drives nowhere";
  EXPECT_EQ(rows(frankie(), state, false), 0) << "no collision rows, none of these";
  ObjectState changed = state;
  changed.visible = false;
  EXPECT_EQ(rows(frankie(), changed, true), 0);
  changed = state;
  changed.V_WO_W << 0.5, 0, 0, 0, 0, -0.3;
  EXPECT_EQ(rows(frankie(), changed, true), 0) << "turning or moving upwards it goes nowhere";
  changed = state;
  changed.X_WO.translation().z() = 1.2;
  EXPECT_EQ(rows(frankie(), changed, true), 0) << "above the base";
  changed = state;
  changed.X_WO.translation().y() = 20.0;
  EXPECT_EQ(rows(frankie(), changed, true), 0) << "so far away that nothing could break the row";
  changed.X_WO.translation().setConstant(NAN);
  EXPECT_EQ(rows(frankie(), changed, true), 0);
}

// Without objects in motion, and without the option, every bit of the step is what it is without these rows.
TEST(Passing, StillObjectsChangeNoBit) {
  Rng rng(45);
  for (int trial = 0; trial < 150; ++trial) {
    const auto model = built_robots()[rng() % 3];
    ControllerParams p = with_passing(0.1);
    p.collision.end_rows = 0.1;
    p.acceleration_limit = VectorX::Constant(model->num_velocities(), 5.0);
    p.escape.enabled = p.servo.vortex.enabled = true;
    ControllerParams off = p;
    off.collision.passing.enabled = false;
    const std::vector<ObjectShape> shapes = random_objects(rng, 8);
    Rig with(model, p, shapes), without(model, off, shapes);
    const StepResult &a = with.result, &b = without.result;
    for (int k = 0; k < 5; ++k) {
      Observation o = random_observation(*model, shapes.size(), rng, 0.8);
      for (ObjectState& s : o.objects) s.V_WO_W.setZero();
      with.step(o);
      without.step(o);
      ASSERT_EQ(a.command, b.command);
      ASSERT_EQ(a.status, b.status);
      ASSERT_EQ(a.fallback, b.fallback);
      ASSERT_EQ(a.iterations, b.iterations);
      ASSERT_EQ(a.rows, b.rows);
    }
  }
}

// However many objects: at most max_pairs of these rows, the nearest, and the problem has room for all that follows.
TEST(Passing, AreBoundedByMaxPairsAndTakeNoMemory) {
  Rng rng(46);
  const auto model = frankie();
  const std::vector<ObjectShape> shapes = random_objects(rng, 40);
  for (const int max_pairs : {0, 3, 200}) {
    ControllerParams p = with_passing(0.1);
    p.collision.max_pairs = max_pairs;
    p.collision.end_rows = 0.2;
    p.acceleration_limit = VectorX::Constant(9, 3.0);
    Rig rig(model, p, shapes);
    const ControllerCore& c = rig.controller;
    int most = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const Observation o = random_observation(*model, shapes.size(), rng, 1.5);
      NoAlloc guard;
      rig.step(o);
      if (NoAlloc::works()) {
        ASSERT_EQ(guard.count(), 0);
      }
      const int passing = rig.rows(RowKind::kPassing);
      most = std::max(most, passing);
      EXPECT_LE(passing, max_pairs);
      EXPECT_EQ(c.problem().ids[static_cast<std::size_t>(c.problem().rows - 1)].kind, RowKind::kWheel);
      EXPECT_TRUE(rig.result.command.allFinite());
    }
    EXPECT_EQ(most > 0, max_pairs > 0);
  }
}

// Where passing rows contradict the others they alone give way, acceleration bounds and usual rows hold, and the
// command is the optimum of that problem.
TEST(Passing, GiveWayToTheUsualRows) {
  Rng rng(47);
  int gave_way = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const auto model = built_robots()[1 + rng() % 2];
    ControllerParams p = with_passing(0.1);
    p.acceleration_limit = VectorX::Constant(model->num_velocities(), 2.0);
    const std::vector<ObjectShape> shapes = random_objects(rng, 3);
    Rig rig(model, p, shapes);
    const ControllerCore& c = rig.controller;
    Observation o = random_observation(*model, shapes.size(), rng, 1.5);
    for (ObjectState& s : o.objects) s.X_WO.translation().z() = 0.3;
    rig.step(o);
    if (!c.outcome().only_passing) continue;
    ++gave_way;
    EXPECT_EQ(rig.result.status, StepStatus::kInfeasible);
    EXPECT_EQ(rig.result.fallback, Fallback::kRelaxed);
    EXPECT_GT(c.outcome().collision_slack, 0.0);
    EXPECT_LT(c.kkt_residual(), 1e-6);
    const QpProblem& problem = c.problem();
    for (int r = 0; r < problem.rows; ++r) {
      const double over = problem.A.row(r).head(problem.n()).dot(c.solution().x.head(problem.n())) - problem.ubA[r];
      const bool passing = problem.ids[static_cast<std::size_t>(r)].kind == RowKind::kPassing;
      EXPECT_LT(over, (passing ? c.outcome().collision_slack : 0.0) + 1e-6) << c.row_name(r);
    }
    for (int i = 0; i < model->num_velocities(); ++i) {
      EXPECT_GE(rig.result.command[i], problem.lb[i] - 1e-9);
      EXPECT_LE(rig.result.command[i], problem.ub[i] + 1e-9);
    }
  }
  EXPECT_GT(gave_way, 20);
}

// As an object comes into reach its row changes nothing: it says less than the base can do.
TEST(Passing, ARowEntersWithoutAJump) {
  const auto model = frankie();
  const std::vector<ObjectShape> ball = {{"ball", {ShapeKind::kSphere, {0.15, 0, 0}, nullptr}}};
  Rig rig(model, with_passing(0.05), ball);
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(9);
  o.goal.X_WG = pose(1.5, 0.4, 0.8, kPi, 0, 0);
  o.objects.resize(1);
  o.objects[0].V_WO_W << 0, 0, 0, 0, -0.4, 0;
  VectorX last;
  double largest = 0.0;
  int entered = 0, rows = 0;
  for (int i = 0; i <= 4000; ++i) {
    o.objects[0].X_WO.translation() = Vector3(0.3, 12.0 - 11.3 * i / 4000, 0.3);
    rig.step(o);
    ASSERT_EQ(rig.result.status, StepStatus::kSolved) << i;
    entered += i > 0 && rig.result.rows > rows ? 1 : 0;
    rows = rig.result.rows;
    if (i > 0) largest = std::max(largest, (rig.result.command - last).lpNorm<Eigen::Infinity>());
    last = rig.result.command;
  }
  EXPECT_GE(entered, 1);
  EXPECT_LT(largest, 0.02) << "with steps of 3 mm";
}

}  // namespace
}  // namespace moma
