// Rows against differences: every collision row bounds the measured rate of change of its distance, for still and
// moving objects; tracking, wheel rows and the objective against their definitions written out again.

#include <gtest/gtest.h>

#include "tests/controller/rig.h"

namespace moma {
namespace {

using namespace test;

// Signed distance of the row's pair after moving robot and objects by v and their twists for dt.
double moved_distance(const RobotModel& model, const std::vector<ObjectShape>& shapes, const Observation& o,
                      const ProximityPair& pair, const VectorX& v, double dt) {
  Vector3 base = o.base;
  VectorX q = o.q;
  integrate(model, base, q, v, dt);
  Kinematics kin(std::make_shared<RobotModel>(model));
  kin.update(base, q);
  const CollisionShape& first = model.shapes[static_cast<std::size_t>(pair.first)];
  if (pair.kind == PairKind::kFloor) return lowest_point(first.shape, kin.X_WS(first));
  if (pair.kind == PairKind::kSelf) {
    const CollisionShape& second = model.shapes[static_cast<std::size_t>(pair.second)];
    return shape_distance(first.shape, kin.X_WS(first), second.shape, kin.X_WS(second)).d;
  }
  const Isometry X = moved_pose(o.objects[static_cast<std::size_t>(pair.second)], dt);
  return shape_distance(first.shape, kin.X_WS(first), shapes[static_cast<std::size_t>(pair.second)].shape, X).d;
}

const DamperParams& damper(const CollisionParams& p, PairKind kind) {
  return kind == PairKind::kObject ? p.object : kind == PairKind::kFloor ? p.floor : p.self;
}

// At the row's limit A qdot = ub the distance shrinks at exactly zeta, so everywhere d_dot = (ub - A qdot) - zeta.
TEST(ControllerRows, CollisionRowsMatchTheMeasuredRateOfDistance) {
  Rng rng(4);
  int checked[3] = {0, 0, 0}, moving = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const auto model = built_robots()[rng() % 3];
    ControllerParams p;
    p.collision.self.influence = 0.4;
    p.collision.floor.influence = 0.5;
    p.collision.max_pairs = 200;
    p.collision.moving_room = 0.02;
    std::vector<ObjectShape> shapes;
    // Spheres and capsules: round, so that the nearest point does not jump while differencing.
    for (int i = 0; i < 5; ++i) {
      ObjectShape o{std::string("o") + std::to_string(i),
                    {ShapeKind::kSphere, {uniform(rng, 0.05, 0.2), 0, 0}, nullptr}};
      if (i % 2 == 1) o.shape = {ShapeKind::kCapsule, {0.08, uniform(rng, 0.1, 0.5), 0}, nullptr};
      shapes.push_back(o);
    }
    Rig rig(model, p, shapes);
    Observation o = random_observation(*model, shapes.size(), rng);
    const bool still = trial % 2 == 0;
    if (still)
      for (ObjectState& s : o.objects) s.V_WO_W.setZero();
    rig.step(o);
    const ControllerCore& c = rig.controller;
    for (int r = 0; r < c.problem().rows; ++r) {
      const RowId& id = c.problem().ids[static_cast<std::size_t>(r)];
      if (id.kind == RowKind::kTracking || id.kind == RowKind::kWheel) continue;
      const PairKind kind = id.kind == RowKind::kObject  ? PairKind::kObject
                            : id.kind == RowKind::kFloor ? PairKind::kFloor
                                                         : PairKind::kSelf;
      const auto pairs = c.distances();
      const auto pair = std::find_if(pairs.begin(), pairs.end(), [&](const ProximityPair& candidate) {
        return candidate.kind == kind && candidate.first == id.first &&
               (kind == PairKind::kFloor || candidate.second == id.second);
      });
      ASSERT_NE(pair, pairs.end()) << c.row_name(r);
      EXPECT_EQ(id.d, pair->distance.d) << c.row_name(r);
      EXPECT_EQ(id.p_first_W, pair->distance.p_first_W) << c.row_name(r);
      EXPECT_EQ(id.p_second_W, pair->distance.p_second_W) << c.row_name(r);
      if (kind == PairKind::kObject && pair->distance.d < 0.01) continue;  // inside, the normal may jump
      if (kind == PairKind::kSelf && pair->distance.d < 0.01) continue;
      VectorX v = VectorX::NullaryExpr(model->num_velocities(), [&] { return uniform(rng, -0.5, 0.5); });
      const double h = 1e-5;
      const double ahead = moved_distance(*model, shapes, o, *pair, v, h);
      const double behind = moved_distance(*model, shapes, o, *pair, v, -h);
      const double here = moved_distance(*model, shapes, o, *pair, v, 0.0);
      // A kink (the nearest point jumping between the ends of a capsule) shows as one-sided slopes that differ.
      if (std::abs((ahead - here) - (here - behind)) > 1e-4 * h) continue;
      const double rate = (ahead - behind) / (2 * h);
      const DamperParams& d = damper(p.collision, kind);
      const double kept = d.stop + (kind == PairKind::kObject && !still ? p.collision.moving_room : 0.0);
      const double zeta = d.gain * (pair->distance.d - kept) / (d.influence - d.stop);
      const double row = c.problem().A.row(r).head(model->num_velocities()).dot(v);
      EXPECT_NEAR(c.problem().ubA[r] - row - zeta, rate, 2e-5) << c.row_name(r) << " of " << model->name;
      EXPECT_TRUE(std::isinf(c.problem().lbA[r]));
      ++checked[static_cast<int>(kind)];
      moving += kind == PairKind::kObject && !still ? 1 : 0;
    }
  }
  EXPECT_GT(checked[0], 200);
  EXPECT_GT(checked[1], 100);
  EXPECT_GT(checked[2], 100);
  EXPECT_GT(moving, 100);
}

// The cost of approaching objects falls as fast as their weighted mean distance grows, times its weight and the nearest
// one's square.
TEST(ControllerRows, ApproachingObjectsCostsAsMuchAsTheirMeanDistanceShrinks) {
  Rng rng(11);
  int checked = 0, none = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const auto model = built_robots()[rng() % 3];
    ControllerParams p;
    p.collision.self.enabled = trial % 2 == 0;
    std::vector<ObjectShape> shapes(4, {"o", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}});
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i].name += std::to_string(i);
    Observation o = random_observation(*model, shapes.size(), rng);
    for (ObjectState& s : o.objects) s.V_WO_W.setZero();
    Rig without(model, p, shapes);
    without.step(o);
    p.collision.away = 2.5;
    Rig with(model, p, shapes);
    with.step(o);
    const VectorX g = with.controller.problem().g - without.controller.problem().g;
    EXPECT_EQ(with.controller.problem().H, without.controller.problem().H);
    const VectorX v = VectorX::NullaryExpr(model->num_velocities(), [&] { return uniform(rng, -0.5, 0.5); });
    double sum = 0.0, rate = 0.0, nearest = 1.0;
    bool smooth = true;
    const QpProblem& problem = with.controller.problem();
    for (const ProximityPair& pair : with.controller.distances()) {
      const auto has_row = [&](const RowId& id) {
        return id.kind == RowKind::kObject && id.first == pair.first && id.second == pair.second;
      };
      if (pair.kind != PairKind::kObject ||
          std::none_of(problem.ids.begin(), problem.ids.begin() + problem.rows, has_row))
        continue;
      constexpr double kStep = 1e-5;
      const double ahead = moved_distance(*model, shapes, o, pair, v, kStep);
      const double behind = moved_distance(*model, shapes, o, pair, v, -kStep);
      const double here = moved_distance(*model, shapes, o, pair, v, 0.0);
      smooth &= pair.distance.d > 0.01 && std::abs(ahead - 2.0 * here + behind) < 1e-4 * kStep;
      const double far = (here - 0.05) / (0.3 - 0.05);  // 0 at the stop distance, 1 at that of influence
      sum += 1.0 - far;
      rate += (1.0 - far) * (ahead - behind) / (2.0 * kStep);
      nearest = std::min(nearest, far);
    }
    if (sum == 0.0) {
      EXPECT_TRUE(g.isZero(0.0));
      ++none;
    } else if (smooth) {
      const double lambda = 2.5 * (1.0 - nearest) * (1.0 - nearest);
      EXPECT_NEAR(g.head(v.size()).dot(v), -lambda * rate / sum, 1e-4 * lambda) << model->name;
      EXPECT_TRUE(g.tail(g.size() - v.size()).isZero(0.0)) << "the slack";
      ++checked;
    }
  }
  EXPECT_GT(checked, 100);
  EXPECT_GT(none, 10);
}

TEST(ControllerRows, NearestFirstAndLimitedInNumber) {
  Rng rng(5);
  const auto model = frankie();
  const std::vector<ObjectShape> shapes = random_objects(rng, 20);
  ControllerParams p;
  p.collision.max_pairs = 7;
  Rig rig(model, p, shapes);
  for (int trial = 0; trial < 50; ++trial) {
    rig.step(random_observation(*model, shapes.size(), rng, 0.6));
    const ControllerCore& c = rig.controller;
    const auto pairs = c.distances();
    int collision_rows = 0;
    std::vector<RowKind> kinds;
    for (int r = 0; r < c.problem().rows; ++r) {
      const RowKind kind = c.problem().ids[static_cast<std::size_t>(r)].kind;
      kinds.push_back(kind);
      collision_rows += kind == RowKind::kObject || kind == RowKind::kFloor || kind == RowKind::kSelf ? 1 : 0;
    }
    EXPECT_TRUE(std::is_sorted(kinds.begin(), kinds.end())) << "tracking, object, floor, self, wheel";
    EXPECT_LE(collision_rows, 7);
    if (pairs.size() >= 7 && c.rows_left_out() == 0) {
      EXPECT_EQ(collision_rows, 7);
    }
    for (std::size_t i = 1; i < pairs.size(); ++i) {
      const auto order = [&](const ProximityPair& x) { return x.distance.d - damper(p.collision, x.kind).stop; };
      EXPECT_LE(order(pairs[i - 1]), order(pairs[i]));
    }
  }
}

TEST(ControllerRows, RowsTheRobotCannotChangeAreLeftOutAndCounted) {
  const auto model = panda();
  std::vector<ObjectShape> shapes = {{"o", {ShapeKind::kSphere, {0.05, 0, 0}, nullptr}}};
  // A shape on the fixed root cannot move at all.
  auto fixed = std::make_shared<RobotModel>(*model);
  fixed->shapes.push_back({"foot", 1, {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}, Isometry::Identity(), true});
  Rig rig(fixed, {}, shapes);
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(7);
  o.goal.X_WG = pose(0.5, 0, 0.5, kPi, 0, 0);
  o.objects.resize(1);
  o.objects[0].X_WO = pose(0.0, -0.3, 0.0, 0, 0, 0);
  rig.step(o);
  // The foot, and link1 whose axis is that of joint 1, against the object. Against the floor neither has a pair.
  EXPECT_EQ(rig.controller.rows_left_out(), 2);
  for (int r = 0; r < rig.controller.problem().rows; ++r) EXPECT_NE(rig.controller.row_name(r), "object/o/foot");
  EXPECT_EQ(rig.result.status, StepStatus::kSolved);
}

TEST(ControllerRows, InvisibleObjectsHaveNoRows) {
  Rng rng(6);
  const auto model = frankie();
  std::vector<ObjectShape> shapes = {random_object(rng, "a"), random_object(rng, "b")};
  Rig rig(model, {}, shapes);
  Observation o = random_observation(*model, 2, rng);
  o.q = model->ready;
  Kinematics kin(model);
  kin.update(o.base, o.q);
  for (ObjectState& s : o.objects) s.X_WO.translation() = kin.X_WE().translation();
  o.objects[0].visible = false;
  o.objects[0].X_WO.translation().setConstant(NAN);
  rig.step(o);
  EXPECT_NE(rig.result.status, StepStatus::kInvalidInput) << "what is not seen does not count";
  bool seen = false;
  for (int r = 0; r < rig.controller.problem().rows; ++r) {
    EXPECT_EQ(rig.controller.row_name(r).find("object/a/"), std::string::npos);
    seen = seen || rig.controller.row_name(r).starts_with("object/b/");
  }
  EXPECT_TRUE(seen);
}

TEST(ControllerRows, TrackingRows) {
  Rng rng(7);
  const auto model = frankie();
  ControllerParams p;
  p.servo = {.position = 2.0, .orientation = 1.0, .max_linear = 0.4, .max_angular = 0.6};
  p.tracking_band << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6;
  p.collision.object.enabled = false;
  Rig rig(model, p);
  for (int trial = 0; trial < 50; ++trial) {
    const Observation o = random_observation(*model, 0, rng);
    rig.step(o);
    const ControllerCore& c = rig.controller;
    const Isometry& X = c.kinematics().X_WE();
    // Independent of log_so3: the angle-axis of R_d R^T.
    const Eigen::AngleAxisd turn(Matrix3(o.goal.X_WG.linear() * X.linear().transpose()));
    Vector3 angular = turn.angle() * turn.axis();
    Vector3 linear = 2.0 * (o.goal.X_WG.translation() - X.translation());
    if (angular.norm() > 0.6) angular *= 0.6 / angular.norm();
    if (linear.norm() > 0.4) linear *= 0.4 / linear.norm();
    Vector6 nu;
    nu << angular, linear;
    nu += o.goal.V_WG_W;
    ASSERT_EQ(c.problem().rows, 8);
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(c.row_name(i), std::string("tracking/") + std::to_string(i));
      EXPECT_NEAR(c.problem().lbA[i], nu[i] - p.tracking_band[i], 1e-12);
      EXPECT_NEAR(c.problem().ubA[i], nu[i] + p.tracking_band[i], 1e-12);
      EXPECT_EQ(c.problem().A.row(i).head(9), c.J().row(i));
      EXPECT_EQ(c.problem().A.row(i).tail<6>(), Vector6::Unit(i).transpose());
    }
    EXPECT_EQ(c.row_name(6), "wheel/left");
    EXPECT_EQ(c.row_name(7), "wheel/right");
  }
}

TEST(ControllerRows, WheelsMatchTheRollingOfTheBase) {
  Rng rng(8);
  for (const auto& model : {frankie(), mecanum()}) {
    const Wheels& w = *model->base.wheels;
    Rig rig(model, {});
    rig.step(random_observation(*model, 0, rng));
    const ControllerCore& c = rig.controller;
    VectorX v = VectorX::Zero(c.problem().n());
    const int dof = model->base_dof();
    for (int i = 0; i < dof; ++i) v[i] = uniform(rng, -1, 1);
    const double half = w.separation / 2;
    int row = 6;
    while (c.problem().ids[static_cast<std::size_t>(row)].kind != RowKind::kWheel) ++row;
    if (dof == 2) {
      // The ground speed under each wheel, which rolls without slipping.
      EXPECT_NEAR(c.problem().A.row(row).dot(v), (v[0] - v[1] * half) / w.radius, 1e-12);
      EXPECT_NEAR(c.problem().A.row(row + 1).dot(v), (v[0] + v[1] * half) / w.radius, 1e-12);
    } else {
      // A mecanum wheel's rollers run at 45 degrees: only the velocity along the free direction's normal turns it.
      const double sx[] = {1, 1, -1, -1}, sy[] = {1, -1, 1, -1};
      const char* names[] = {"front_left", "front_right", "rear_left", "rear_right"};
      for (int i = 0; i < 4; ++i) {
        const Vector2 at(sx[i] * w.wheelbase / 2, sy[i] * half);
        const Vector2 ground(v[0] - v[2] * at.y(), v[1] + v[2] * at.x());
        const double across = i == 0 || i == 3 ? -1.0 : 1.0;
        EXPECT_NEAR(c.problem().A.row(row + i).dot(v), (ground.x() + across * ground.y()) / w.radius, 1e-12) << i;
        EXPECT_EQ(c.row_name(row + i), std::string("wheel/") + names[i]);
      }
    }
    EXPECT_EQ(c.problem().ubA[row], w.max_speed);
    EXPECT_EQ(c.problem().lbA[row], -w.max_speed);
    EXPECT_EQ(c.wheels().size(), dof == 2 ? 2 : 4);
  }
}

TEST(ControllerRows, ObjectiveIsTheSumOfItsTerms) {
  Rng rng(9);
  const auto model = frankie();
  ControllerParams p;
  p.error_norm.kind = ErrorNormKind::kL1;
  p.lambda_q = VectorX::LinSpaced(7, 0.01, 0.07);
  p.k_epsilon = 0.7;
  p.manipulability.weight = 0.3;
  p.acceleration_weight = VectorX::LinSpaced(9, 0.1, 0.9);
  p.posture = {.weight = 0.2, .gain = 1.5, .target = {}};
  p.collision.object.enabled = false;
  Rig rig(model, p);
  const Observation o = random_observation(*model, 0, rng);
  rig.step(o);
  const ControllerCore& c = rig.controller;
  const Vector3 e_p = o.goal.X_WG.translation() - c.kinematics().X_WE().translation();
  const double e = e_p.cwiseAbs().sum();
  const Vector3 in_base = Eigen::AngleAxisd(-o.base.z(), Vector3::UnitZ()) *
                          (c.kinematics().X_WE().translation() - Vector3(o.base.x(), o.base.y(), 0));
  VectorX H(15), g(15);
  H.head(2).setConstant(1 / e);
  H.segment(2, 7) = p.lambda_q;
  H.tail(6).setConstant(1 / e);
  g.setZero();
  g[1] = -0.7 * std::atan2(in_base.y(), in_base.x());
  g.segment(2, 7) = -0.3 * c.J_m();
  H.head(9) += p.acceleration_weight;
  g.head(9) -= p.acceleration_weight.cwiseProduct(o.qdot);
  H.segment(2, 7).array() += 0.2;
  g.segment(2, 7) -= 0.2 * 1.5 * (model->ready - o.q);
  EXPECT_LT((c.problem().H - H).lpNorm<Eigen::Infinity>(), 1e-12);
  EXPECT_LT((c.problem().g - g).lpNorm<Eigen::Infinity>(), 1e-12);
  EXPECT_NEAR(rig.result.error_norm, e, 1e-12);

  // Switched off, a term leaves no trace.
  ControllerParams off;
  off.lambda_q = VectorX::Constant(7, 0.5);
  off.base_weight = {false, 0.25};
  off.slack.weight = {false, 3.0};
  off.k_epsilon = 0.0;
  off.manipulability.weight = 0.0;
  Rig bare(model, off);
  bare.step(o);
  EXPECT_EQ(bare.controller.problem().g, VectorX::Zero(15));
  VectorX expected(15);
  expected << 0.25, 0.25, VectorX::Constant(7, 0.5), VectorX::Constant(6, 3.0);
  EXPECT_EQ(bare.controller.problem().H, expected);
  EXPECT_GT(bare.result.manipulability, 0.0) << "reported whether it is weighed or not";

  ControllerParams hard;
  hard.slack.enabled = false;
  Rig no_slack(model, hard);
  no_slack.step(o);
  EXPECT_EQ(no_slack.controller.problem().n(), 9);
  EXPECT_EQ(no_slack.result.slack, Vector6::Zero());
}

}  // namespace
}  // namespace moma
