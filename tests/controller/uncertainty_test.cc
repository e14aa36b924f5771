// Margins against what the distance library says when everything is off by random draws.

#include "controller/safe/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "controller/params.h"
#include "controller/qp/limits.h"
#include "tests/controller/rig.h"

namespace moma {
namespace {

using namespace test;

TEST(NormalQuantile, HasTheProbabilityBelowIt) {
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-15);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-12);  // tables
  EXPECT_NEAR(normal_quantile(0.99), 2.326347874040841, 1e-12);
  EXPECT_NEAR(normal_quantile(0.999999), 4.753424308822899, 1e-6);
}

UncertaintyParams some() {
  UncertaintyParams u;
  u.enabled = true;
  u.object_bias = 0.002;
  u.object_noise = 0.003;
  u.object_rotation_bias = 0.004;
  u.base_position = 0.002;
  u.base_rotation = 0.003;
  u.joints = 0.002;
  return u;
}

Isometry turned(const Isometry& X, const Vector3& turn, const Vector3& shift) {
  Isometry out = X;
  if (turn.norm() > 0.0) out.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * X.linear();
  out.translation() += shift;
  return out;
}

TEST(Uncertainty, MarginsAreTheSpreadOfDistancesThatAreOff) {
  Rng rng(1);
  std::normal_distribution<double> normal;
  const auto draw3 = [&](double sigma) {
    return Vector3(sigma * normal(rng), sigma * normal(rng), sigma * normal(rng));
  };
  int checked = 0;
  for (const auto& model : all_robots()) {
    const UncertaintyParams u = some();
    const Uncertainty uncertainty(u, model->base_dof());
    PoseTrack track;
    track.seen = 4;
    track.pose_spread = 0.25;
    const PlaceSpread spread = uncertainty.spread(track, 0.1);
    EXPECT_NEAR(spread.position, std::sqrt(4e-6 + 0.25 * 9e-6), 1e-12);
    for (int trial = 0; trial < 12; ++trial) {
      // Balls and capsules: their nearest points do not jump.
      ObjectShape object{.name = "o", .shape = {ShapeKind::kCapsule, {0.1, 0.3, 0.0}, nullptr}};
      Kinematics kinematics(model);
      Proximity proximity(model);
      proximity.set_objects({&object, 1});
      Observation o = random_observation(*model, 1, rng, 0.9);
      kinematics.update(o.base, o.q);
      const auto near = proximity.query(kinematics, o.objects, {0.6, -1.0, -1.0});
      if (near.empty()) continue;
      const ProximityPair pair = near.front();
      if (pair.distance.d < 0.15) continue;
      const CollisionShape& link = model->shapes[static_cast<std::size_t>(pair.first)];
      Matrix3X J(3, model->num_velocities());
      kinematics.point_jacobian(link.link, pair.distance.p_first_W, J);
      const VectorX row = -J.transpose() * pair.distance.n_W;
      const double margin = uncertainty.margin(pair, kinematics, row, &o.objects[0], spread);
      double sum = 0.0, squares = 0.0;
      constexpr int kDraws = 3000;
      Kinematics off(model);
      for (int k = 0; k < kDraws; ++k) {
        Vector3 base = o.base;
        if (model->base_dof() > 0)
          base += Vector3(u.base_position * normal(rng), u.base_position * normal(rng), u.base_rotation * normal(rng));
        VectorX q = o.q;
        for (double& x : q) x += u.joints * normal(rng);
        off.update(base, q);
        const Isometry X_WO = turned(o.objects[0].X_WO, draw3(spread.rotation), draw3(spread.position));
        const double d = shape_distance(link.shape, off.X_WS(link), object.shape, X_WO).d;
        sum += d;
        squares += (d - pair.distance.d) * (d - pair.distance.d);
      }
      EXPECT_NEAR(margin / uncertainty.quantile(), std::sqrt(squares / kDraws), 0.08 * std::sqrt(squares / kDraws))
          << model->name << " trial " << trial << ", mean " << sum / kDraws - pair.distance.d;
      ++checked;
    }
  }
  EXPECT_GT(checked, 8);
}

TEST(Uncertainty, GrowsWhileSomethingIsNotSeenAndWithTheAgeOfAVelocity) {
  UncertaintyParams u = some();
  u.growth = 0.1;
  u.object_velocity = 0.05;
  const Uncertainty uncertainty(u, 2);
  PoseTrack track;
  track.seen = 1;
  const double resting = uncertainty.spread(track, 0.5).position;
  track.moving = true;
  const double moving = uncertainty.spread(track, 0.5).position;
  EXPECT_NEAR(moving * moving - resting * resting, 0.025 * 0.025, 1e-12);
  track.moving = false;
  track.unseen = 2.0;
  const double unseen = uncertainty.spread(track, 0.5).position;
  EXPECT_NEAR(unseen * unseen - resting * resting, 0.2 * 0.2, 1e-12);
}

// A row moves by the damper's slope times the margin; with nothing uncertain it is what it was.
TEST(Uncertainty, MovesRowsByTheirMargins) {
  Rng rng(2);
  const auto model = frankie();
  ControllerParams plain;
  plain.prediction.enabled = true;
  ControllerParams zero = plain, some_off = plain;
  zero.uncertainty.enabled = some_off.uncertainty.enabled = true;
  some_off.uncertainty.object_bias = 0.01;
  const std::vector<ObjectShape> shapes = random_objects(rng, 8);
  Rig a(model, plain, shapes), b(model, zero, shapes), c(model, some_off, shapes);
  int rows = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Observation o = random_observation(*model, 8, rng, 0.8);
    for (Rig* rig : {&a, &b, &c}) {
      rig->controller.reset(shapes);
      rig->step(o);
    }
    EXPECT_EQ(a.result.command, b.result.command);
    const QpProblem &p = a.controller.problem(), &q = c.controller.problem();
    ASSERT_EQ(p.rows, q.rows);
    const DamperParams& damper = plain.collision.object;
    for (int r = 0; r < p.rows; ++r) {
      if (p.ids[static_cast<std::size_t>(r)].kind != RowKind::kObject) continue;
      const double by = damper.gain * normal_quantile(0.99) * 0.01 / (damper.influence - damper.stop);
      EXPECT_NEAR(p.ubA[r] - q.ubA[r], by, 1e-9);
      ++rows;
    }
  }
  EXPECT_GT(rows, 50);
}

// What is not seen for a while has its rows on, then none.
TEST(Uncertainty, KeepsRowsOfWhatIsNotSeen) {
  const auto model = frankie();
  ControllerParams params;
  params.prediction.enabled = params.uncertainty.enabled = true;
  params.uncertainty.keep = 0.1;
  Rig rig(model, params, {{.name = "ball", .shape = {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}});
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(9);
  o.goal.X_WG.translation() = Vector3(2, 0, 0.8);
  o.objects.resize(1);
  o.objects[0].X_WO.translation() = Vector3(0.55, 0, 0.4);
  rig.step(o);
  const int seen = rig.rows(RowKind::kObject);
  ASSERT_GT(seen, 0);
  o.objects[0] = ObjectState{};
  o.objects[0].visible = false;
  for (int k = 0; k < 5; ++k) {
    rig.step(o);
    EXPECT_EQ(rig.rows(RowKind::kObject), seen) << k;
  }
  rig.step(o);
  EXPECT_EQ(rig.rows(RowKind::kObject), 0);
}

// Driven in small steps: from the speed that sight leaves, the base stands before what comes towards it.
TEST(Sight, LeavesASpeedFromWhichTheBaseStopsInTime) {
  for (const double comes : {0.0, 0.4}) {
    for (const double a : {0.5, 2.0}) {
      RobotModel model = *frankie();
      model.base.max_linear = 100.0;
      const SightParams sight{.enabled = true, .range = 2.0, .reach = 0.7, .reaction = 0.25, .speed = comes};
      double v = sight_speed(sight, model, a), way = 0.0, time = 0.0;
      EXPECT_GT(v, 0.2);
      for (constexpr double kStep = 1e-6; v > 0.0; time += kStep) {
        way += v * kStep;
        if (time >= sight.reaction) v -= a * kStep;
      }
      EXPECT_NEAR(way + comes * time, 1.3, 1e-4);
      model.base.max_linear = 0.3;
      EXPECT_LE(sight_speed(sight, model, a), 0.3);
    }
  }
  ControllerParams params;
  params.acceleration_limit = VectorX::Constant(9, 0.5);
  params.sight = {.enabled = true, .range = 1.2, .reach = 1.0, .reaction = 0.3, .speed = 0.0};
  params.servo.max_linear = params.servo.max_angular = 0.8;
  params.base_weight = {false, 0.01};
  params.slack.weight = {false, 10.0};
  params.lambda_q = VectorX::Constant(7, 10.0);
  Rig rig(frankie(), params);
  Observation o;
  o.q = frankie()->ready;
  o.qdot = VectorX::Zero(9);
  o.goal.X_WG = rig.controller.kinematics().X_WE();
  o.goal.X_WG.translation().x() += 5.0;
  for (int k = 0; k < 200; ++k) {
    rig.step(o);
    o.qdot = rig.result.command;
  }
  EXPECT_NEAR(rig.result.command[0], sight_speed(params.sight, *frankie(), 0.5), 1e-6);
}

}  // namespace
}  // namespace moma
