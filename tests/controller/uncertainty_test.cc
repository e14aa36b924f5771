// Margins against what the distance library says when everything is off by random draws.

#include "controller/safe/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "controller/params.h"
#include "controller/qp/limits.h"
#include "tests/controller/rig.h"
#include "tests/support/no_alloc.h"

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
  for (const auto& model : built_robots()) {
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
      const double margin = uncertainty.margin(pair, kinematics, row, o.objects, {&spread, 1});
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

ObjectCovariance stated(const Vector3& position, const Vector3& velocity) {
  return {position.asDiagonal(), velocity.asDiagonal()};
}

// n^T (P_p + t^2 P_v) n, worked out by hand.
TEST(Covariance, IsTheMarginOfADistance) {
  const auto model = frankie();
  UncertaintyParams u;
  u.enabled = true;
  u.probability = 0.975;
  u.object_noise = u.object_bias = u.object_velocity = 1.0;  // not in addition
  const Uncertainty uncertainty(u, model->base_dof());
  ProximityPair pair;
  pair.distance.n_W = Vector3(0.6, 0.8, 0.0);
  ObjectState object;
  Kinematics kinematics(model);
  kinematics.update(Vector3::Zero(), model->ready);
  const VectorX row = VectorX::Zero(model->num_velocities());
  PoseTrack track;
  const auto margin = [&] {
    const PlaceSpread spread = uncertainty.spread(track, 0.5);
    return uncertainty.margin(pair, kinematics, row, {&object, 1}, {&spread, 1});
  };
  track.seen = 3;
  track.stated = true;
  track.position_covariance << 4e-4, 1e-4, 0.0, 1e-4, 9e-4, 0.0, 0.0, 0.0, 1.0;
  // 0.36 * 4e-4 + 0.64 * 9e-4 + 2 * 0.48 * 1e-4 = 8.16e-4
  EXPECT_NEAR(margin(), 1.959963984540054 * 0.0285657137141714, 1e-12);
  // 0.25 * 0.36 * 0.01 = 9e-4 more, half a second later
  track.velocity_covariance[0] = 0.01;
  EXPECT_NEAR(margin(), 1.959963984540054 * 0.0414246303544015, 1e-12);
  track.stated = false;
  EXPECT_GT(margin(), 1.0);
}

TEST(Covariance, MoreOfItIsNeverLessOfAMargin) {
  const auto model = frankie();
  Rng rng(5);
  std::normal_distribution<double> normal;
  UncertaintyParams u = some();
  u.growth = 0.1;
  u.object_angular_velocity = 0.02;
  const Uncertainty uncertainty(u, model->base_dof());
  const double z = uncertainty.quantile();
  const PoseFilter filter({0.3, 0.1, 0.2}, {0.05, 0.05, z}, 0.02);
  const auto any = [&](double size) { return Vector3(size * normal(rng), size * normal(rng), size * normal(rng)); };
  Kinematics kinematics(model);
  kinematics.update(Vector3::Zero(), model->ready);
  int rested = 0, grown = 0;
  for (int trial = 0; trial < 300; ++trial) {
    ProximityPair pair;
    pair.distance.n_W = any(1.0).normalized();
    pair.distance.p_second_W = any(1.0);
    ObjectState object;
    Vector6 V = Vector6::Zero();
    V.tail<3>() = any(0.1);
    const VectorX row = VectorX::Random(model->num_velocities());
    ObjectCovariance covariance;
    double last = -1.0;
    bool moved = true;
    for (int k = 0; k < 12; ++k) {
      const Vector3 p = any(0.02), v = any(0.03);
      covariance.position_W += p * p.transpose();
      covariance.velocity_W += v * v.transpose();
      PoseTrack track;
      for (int step = 0; step < 3; ++step) filter.measure(object.X_WO, V, track, &covariance);
      rested += moved && !track.moving ? 1 : 0;
      EXPECT_TRUE(moved || !track.moving) << "what seemed at rest moves for being known less well";
      moved = track.moving;
      const PlaceSpread spread = uncertainty.spread(track, 0.3);
      const double margin = uncertainty.margin(pair, kinematics, row, {&object, 1}, {&spread, 1});
      EXPECT_GE(margin, last) << trial << " " << k;
      grown += margin > last + 1e-6 ? 1 : 0;
      last = margin;
    }
  }
  EXPECT_GT(rested, 20) << "noise is no motion";
  EXPECT_GT(grown, 2000);
}

ControllerParams tracked() {
  ControllerParams params;
  params.prediction.enabled = params.uncertainty.enabled = true;
  params.uncertainty.probability = 0.99;
  return params;
}

Observation beside_a_ball(const RobotModel& model) {
  Observation o;
  o.q = model.ready;
  o.qdot = VectorX::Zero(model.num_velocities());
  o.goal.X_WG.translation() = Vector3(2, 0, 0.8);
  o.objects.resize(1);
  o.objects[0].X_WO.translation() = Vector3(0.65, 0, 0.4);
  return o;
}

// As the rows say that the step poses: in the controller, and held as long as a thing is not seen.
TEST(Covariance, MovesRowsByTheirMargins) {
  const auto model = frankie();
  ControllerParams params = tracked();
  params.uncertainty.keep = 0.1;
  const std::vector<ObjectShape> ball{{.name = "ball", .shape = {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}};
  Rig plain(model, params, ball), known(model, params, ball);
  Observation o = beside_a_ball(*model);
  plain.step(o);
  o.objects[0].covariance = stated({4e-4, 4e-4, 4e-4}, Vector3::Zero());
  int taken = 0;
  {
    const test::NoAlloc guard;
    known.step(o);
    taken = guard.count();
  }
  EXPECT_EQ(taken, 0);
  const DamperParams& damper = params.collision.object;
  const double by = damper.gain * 2.3263478740408408 * 0.02 / (damper.influence - damper.stop);
  const auto expect_moved = [&] {
    const QpProblem &p = plain.controller.problem(), &q = known.controller.problem();
    ASSERT_EQ(p.rows, q.rows);
    int rows = 0;
    for (int r = 0; r < p.rows; ++r) {
      if (p.ids[static_cast<std::size_t>(r)].kind != RowKind::kObject) continue;
      EXPECT_NEAR(p.ubA[r] - q.ubA[r], by, 1e-9);
      ++rows;
    }
    EXPECT_GT(rows, 0);
  };
  expect_moved();
  o.objects[0] = ObjectState{};
  o.objects[0].visible = false;
  plain.step(o);
  known.step(o);
  expect_moved();
  o.objects[0].visible = true;
  o.objects[0].covariance = stated({std::nan(""), 0.0, 0.0}, Vector3::Zero());
  known.step(o);
  EXPECT_EQ(known.result.status, StepStatus::kInvalidInput);
}

// An object whose velocity is within its own uncertainty counts as at rest, beyond it as moving.
TEST(Covariance, IsTheThresholdOfMotion) {
  const auto model = frankie();
  const std::vector<ObjectShape> ball{{.name = "ball", .shape = {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}};
  const auto moving_rows = [&](double velocity, double deviation) {
    Rig rig(model, tracked(), ball);
    Observation o = beside_a_ball(*model);
    o.objects[0].V_WO_W[3] = -velocity;
    o.objects[0].covariance = stated(Vector3::Zero(), Vector3::Constant(deviation * deviation));
    rig.step(o);
    const QpProblem& problem = rig.controller.problem();
    return std::count_if(problem.ids.begin(), problem.ids.begin() + problem.rows,
                         [](const RowId& id) { return id.moves; });
  };
  const double edge = 2.3263478740408408 * std::sqrt(3.0) * 0.05;
  EXPECT_EQ(moving_rows(0.99 * edge, 0.05), 0);
  EXPECT_GT(moving_rows(1.01 * edge, 0.05), 0);
  EXPECT_GT(moving_rows(0.99 * edge, 0.04), 0);
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
