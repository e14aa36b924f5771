// Rows of capsules' ends: their n and zeta by differencing the distance of the cap sphere, and how many there are.

#include "controller/qp/end_rows.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/controller/rig.h"

namespace moma {
namespace {

using namespace test;

constexpr double kRange = 0.25;

ControllerParams with_ends(int max_pairs = 200) {
  ControllerParams p;
  p.collision.end_rows = kRange;
  p.collision.max_pairs = max_pairs;
  return p;
}

// The ball at one end of the capsule, as a shape and a pose.
std::pair<Shape, Isometry> cap(const Shape& capsule, const Isometry& X_WS, bool upper) {
  Isometry X = X_WS;
  X.translation() += (upper ? 0.5 : -0.5) * capsule.size.y() * X_WS.linear().col(2);
  return {Shape{ShapeKind::kSphere, {capsule.size.x(), 0, 0}, nullptr}, X};
}

// Distance of the row's ball to the other shape after moving everything for dt.
double moved_distance(const RobotModel& model, const std::vector<ObjectShape>& shapes, const Observation& o,
                      const RowId& id, const VectorX& v, double dt) {
  Vector3 base = o.base;
  VectorX q = o.q;
  integrate(model, base, q, v, dt);
  Kinematics kin(std::make_shared<RobotModel>(model));
  kin.update(base, q);
  const CollisionShape& robot = model.shapes[static_cast<std::size_t>(id.first)];
  const Shape& object = shapes[static_cast<std::size_t>(id.second)].shape;
  const Isometry X_WO = moved_pose(o.objects[static_cast<std::size_t>(id.second)], dt);
  if (id.end <= 2) {
    const auto [ball, X] = cap(robot.shape, kin.X_WS(robot), id.end == 2);
    return shape_distance(ball, X, object, X_WO).d;
  }
  const auto [ball, X] = cap(object, X_WO, id.end == 4);
  return shape_distance(robot.shape, kin.X_WS(robot), ball, X).d;
}

// At the row's limit the distance shrinks at exactly zeta: d_dot = (ub - A qdot) - zeta, of the ball, not of the pair.
TEST(EndRows, MatchTheMeasuredRateOfTheBallsDistance) {
  Rng rng(31);
  int checked[5] = {};
  for (int trial = 0; trial < 150; ++trial) {
    const auto model = built_robots()[rng() % 3];
    const ControllerParams p = with_ends();
    const std::vector<ObjectShape> shapes = random_objects(rng, 6);
    Rig rig(model, p, shapes);
    const ControllerCore& c = rig.controller;
    const Observation o = random_observation(*model, shapes.size(), rng, 0.9);
    rig.step(o);
    for (int r = 0; r < c.problem().rows; ++r) {
      const RowId& id = c.problem().ids[static_cast<std::size_t>(r)];
      if (id.kind != RowKind::kObject || id.end == 0) continue;
      const VectorX v = VectorX::NullaryExpr(model->num_velocities(), [&] { return uniform(rng, -0.5, 0.5); });
      const double h = 1e-5;
      const double here = moved_distance(*model, shapes, o, id, v, 0.0);
      EXPECT_NEAR(id.d, here, 1e-9) << c.row_name(r);
      if (here < 0.01) continue;  // inside, the normal may jump
      const double ahead = moved_distance(*model, shapes, o, id, v, h);
      const double behind = moved_distance(*model, shapes, o, id, v, -h);
      if (std::abs((ahead - here) - (here - behind)) > 1e-4 * h) continue;  // an edge passes by
      const DamperParams& d = p.collision.object;
      const double zeta = d.gain * (here - d.stop) / (d.influence - d.stop);
      const double row = c.problem().A.row(r).head(model->num_velocities()).dot(v);
      EXPECT_NEAR(c.problem().ubA[r] - row - zeta, (ahead - behind) / (2 * h), 2e-5)
          << c.row_name(r) << " of " << model->name;
      ++checked[id.end];
    }
  }
  for (int end = 1; end <= 4; ++end) EXPECT_GT(checked[end], 40) << "end " << end;
}

TEST(EndRows, ExistForNearPairsWithCapsulesAndAreNamed) {
  Rng rng(32);
  const auto model = frankie();
  int ends = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const std::vector<ObjectShape> shapes = random_objects(rng, 8);
    Rig rig(model, with_ends(), shapes);
    const ControllerCore& c = rig.controller;
    const Observation o = random_observation(*model, shapes.size(), rng, 0.9);
    rig.step(o);
    std::set<std::tuple<int, int, int>> seen;
    for (int r = 0; r < c.problem().rows; ++r) {
      const RowId& id = c.problem().ids[static_cast<std::size_t>(r)];
      if (id.kind != RowKind::kObject) continue;
      EXPECT_TRUE(seen.insert({id.first, id.second, id.end}).second) << "twice: " << c.row_name(r);
      const std::string plain = "object/" + shapes[static_cast<std::size_t>(id.second)].name + "/" +
                                model->shapes[static_cast<std::size_t>(id.first)].name;
      EXPECT_EQ(c.row_name(r), id.end == 0 ? plain : plain + "@" + std::to_string(id.end));
    }
    // Both ends of every capsule of a pair nearer than `end_rows`, unless they are out of the damper's reach.
    for (const ProximityPair& pair : c.distances()) {
      if (pair.kind != PairKind::kObject) continue;
      for (int end = 1; end <= 4; ++end) {
        const bool robots = end <= 2;
        const Shape& shape = robots ? model->shapes[static_cast<std::size_t>(pair.first)].shape
                                    : shapes[static_cast<std::size_t>(pair.second)].shape;
        const bool has = seen.count({pair.first, pair.second, end}) > 0;
        if (pair.distance.d >= kRange || shape.kind != ShapeKind::kCapsule) {
          EXPECT_FALSE(has);
        } else {
          const double d = moved_distance(*model, shapes, o, {RowKind::kObject, pair.first, pair.second, end},
                                          VectorX::Zero(9), 0.0);
          EXPECT_EQ(has, d < 0.3) << d;
          ends += has ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(ends, 300);
}

// They come on top of max_pairs, and however many there are, the problem has room: none is lost.
TEST(EndRows, DoNotCountAsPairsAndNeverOverflow) {
  Rng rng(33);
  const auto model = frankie();
  std::vector<ObjectShape> shapes;
  for (int i = 0; i < 12; ++i)
    shapes.push_back({std::string("o") + std::to_string(i), {ShapeKind::kCapsule, {0.05, 0.1, 0}, nullptr}});
  for (const int max_pairs : {0, 1, 5, 200}) {
    ControllerParams p = with_ends(max_pairs);
    p.collision.end_rows = 5.0;
    p.collision.object.influence = 5.0;
    Rig rig(model, p, shapes);
    const ControllerCore& c = rig.controller;
    for (int trial = 0; trial < 20; ++trial) {
      rig.step(random_observation(*model, shapes.size(), rng, 0.5));
      int usual = 0, ends = 0, objects = 0;
      for (int r = 0; r < c.problem().rows; ++r) {
        const RowId& id = c.problem().ids[static_cast<std::size_t>(r)];
        if (id.kind == RowKind::kTracking || id.kind == RowKind::kWheel) continue;
        (id.end > 0 ? ends : usual) += 1;
        objects += id.end == 0 && id.kind == RowKind::kObject ? 1 : 0;
      }
      EXPECT_LE(usual, max_pairs);
      EXPECT_EQ(ends, 4 * objects);
      EXPECT_LE(c.problem().rows, c.problem().capacity());
      EXPECT_EQ(c.problem().ids[static_cast<std::size_t>(c.problem().rows - 1)].kind, RowKind::kWheel)
          << "the rows after them had room too";
    }
  }
}

// A capsule that swings past parallel over another: without end rows what the rows allow jumps from end to end.
TEST(EndRows, HoldBothEndsOfParallelCapsules) {
  Rng rng(34);
  const auto model = frankie();
  const CollisionShape& shape = model->shapes[3];
  ControllerParams p = with_ends();
  Kinematics kin(model);
  std::vector<ObjectShape> shapes{{"bar", {ShapeKind::kCapsule, {0.04, 0.6, 0}, nullptr}}};
  Observation o = random_observation(*model, 1, rng);
  o.base.setZero();
  o.q = model->ready;
  kin.update(o.base, o.q);
  o.objects[0].V_WO_W.setZero();
  o.objects[0].X_WO = kin.X_WS(shape);
  o.objects[0].X_WO.translation() += 0.15 * kin.X_WS(shape).linear().col(0);
  for (const bool on : {false, true}) {
    p.collision.end_rows = on ? kRange : 0.0;
    Rig rig(model, p, shapes);
    const ControllerCore& c = rig.controller;
    std::set<int> ends;
    rig.step(o);
    for (int r = 0; r < c.problem().rows; ++r) {
      const RowId& id = c.problem().ids[static_cast<std::size_t>(r)];
      if (id.kind == RowKind::kObject && id.first == 3) ends.insert(id.end);
    }
    EXPECT_TRUE(ends.count(0));
    EXPECT_EQ(ends.count(1) + ends.count(2), on ? 2u : 0u);
  }
}

}  // namespace
}  // namespace moma
