// Separation rows: the speed that is left against a simulation in fine steps, coefficients and bounds against
// differences of distances and the standard's integrals, what is left out, and a robot that stands before it is met.

#include "controller/qp/separation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/controller/rig.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

// The distance that is used up until the robot stands: it goes on at `speed` for the reaction and then slows down
// evenly, while the other comes at `v_H`; summed in steps of 10 us.
double used_up(double speed, double v_H, double deceleration, double reaction) {
  constexpr double kStep = 1e-5;
  double sum = 0.0, v = speed;
  for (double t = 0.0; t < reaction || v > 0.0; t += kStep) {
    sum += (v + v_H) * kStep;
    if (t >= reaction) v -= deceleration * kStep;
  }
  return sum;
}

TEST(SeparationSpeed, IsThatFromWhichTheRobotStandsAsTheyMeet) {
  int checked = 0;
  for (const double room : {0.02, 0.3, 1.0, 2.5}) {
    for (const double v_H : {0.0, 0.2, 1.6}) {
      for (const double a : {0.4, 1.5, 12.0}) {
        for (const double reaction : {0.0, 0.1, 0.4}) {
          const double speed = separation_speed(room, v_H, a, reaction);
          if (v_H * reaction >= room) {
            EXPECT_EQ(speed, 0.0);
            continue;
          }
          EXPECT_GT(speed, 0.0);
          EXPECT_NEAR(used_up(speed, v_H, a, reaction), room, 1e-4 * (1.0 + room + speed + v_H))
              << room << " " << v_H << " " << a << " " << reaction;
          ++checked;
        }
      }
    }
  }
  EXPECT_GT(checked, 80);
  EXPECT_EQ(separation_speed(-0.1, 0.0, 1.0, 0.1), 0.0);
  EXPECT_EQ(separation_speed(1.0, 0.5, 0.0, 0.1), 0.0);
  EXPECT_EQ(separation_speed(std::nan(""), 0.5, 1.0, 0.1), 0.0);
  EXPECT_NEAR(separation_speed(1.0, 2.0, kInfinity, 0.25), 2.0, 1e-15);
  EXPECT_TRUE(std::isinf(separation_speed(1.0, 2.0, kInfinity, 0.0)));
}

ControllerParams with_separation(const RobotModel& model) {
  ControllerParams p;
  p.collision.separation = {.enabled = true, .reaction = 0.15, .speed = 0.1, .intrusion = 0.05, .share = 0.6};
  p.collision.max_pairs = 500;
  p.acceleration_limit = VectorX::Constant(model.num_velocities(), 4.0);
  return p;
}

using Pair = std::pair<int, int>;

std::map<Pair, double> distances(const RobotModel& model, const std::vector<ObjectShape>& shapes,
                                 const Observation& o) {
  const auto shared = std::make_shared<RobotModel>(model);
  Kinematics kinematics(shared);
  kinematics.update(o.base, o.q);
  Proximity proximity(shared);
  proximity.set_objects(shapes);
  std::map<Pair, double> out;
  for (const ProximityPair& pair : proximity.query(kinematics, o.objects, {100.0, -1.0, -1.0}))
    out[{pair.first, pair.second}] = pair.distance.d;
  return out;
}

// The largest speed in [0, 10] whose integrals use up no more than `room`, by bisection.
double bisected(double room, double v_H, double a, double reaction) {
  double low = 0.0, high = 10.0;
  for (int k = 0; k < 60; ++k) {
    const double v = 0.5 * (low + high);
    const double T_S = v / a;
    const double S_H = v_H * (reaction + T_S), S_R = v * reaction, S_S = v * T_S - 0.5 * a * T_S * T_S;
    (S_H + S_R + S_S <= room ? low : high) = v;
  }
  return low;
}

// Spheres, whose distances have derivatives everywhere.
std::vector<ObjectShape> balls(int count, Rng& rng) {
  std::vector<ObjectShape> out;
  for (int i = 0; i < count; ++i)
    out.push_back({"ball" + std::to_string(i), {ShapeKind::kSphere, {uniform(rng, 0.05, 0.3), 0, 0}, nullptr}});
  return out;
}

TEST(SeparationRows, AreTheStandardsDistanceSolvedForTheRobotsSpeed) {
  Rng rng(51);
  constexpr double h = 1e-6;
  int rows = 0, resting = 0, left_out = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto model = built_robots()[static_cast<std::size_t>(trial) % built_robots().size()];
    const ControllerParams p = with_separation(*model);
    const std::vector<ObjectShape> shapes = balls(4, rng);
    Rig rig(model, p, shapes);
    Observation o = random_observation(*model, shapes.size(), rng, 1.5);
    for (ObjectState& object : o.objects) {
      object.V_WO_W.head<3>().setZero();
      if (rng() % 4 == 0) object.V_WO_W.setZero();
    }
    rig.step(o);
    const QpProblem& problem = rig.controller.problem();
    const int nv = model->num_velocities();
    const std::map<Pair, double> now = distances(*model, shapes, o);
    Observation later = o;
    for (ObjectState& object : later.objects) object.X_WO.translation() += h * object.V_WO_W.tail<3>();
    const std::map<Pair, double> by_objects = distances(*model, shapes, later);
    std::vector<std::map<Pair, double>> ahead, behind;
    for (int i = 0; i < nv; ++i) {
      for (const double sign : {1.0, -1.0}) {
        Observation moved = o;
        const VectorX v = sign * VectorX::Unit(nv, i);
        integrate(*model, moved.base, moved.q, v, h);
        (sign > 0 ? ahead : behind).push_back(distances(*model, shapes, moved));
      }
    }
    std::map<Pair, int> row_of;
    for (int r = 0; r < problem.rows; ++r) {
      const RowId& id = problem.ids[static_cast<std::size_t>(r)];
      if (id.kind == RowKind::kSeparation) row_of[{id.first, id.second}] = r;
    }
    for (const auto& [pair, d] : now) {
      const ObjectState& object = o.objects[static_cast<std::size_t>(pair.second)];
      const auto found = row_of.find(pair);
      if (!in_motion(object)) {
        EXPECT_TRUE(found == row_of.end());
        ++resting;
        continue;
      }
      if (d < 0.01) continue;  // centres may be inside
      VectorX c(nv);
      for (int i = 0; i < nv; ++i)
        c[i] = -(ahead[static_cast<std::size_t>(i)].at(pair) - behind[static_cast<std::size_t>(i)].at(pair)) / (2 * h);
      const double v_H = std::max(0.1, (d - by_objects.at(pair)) / h);
      const double bound = bisected(d - 0.05, v_H, 0.6 * 4.0 * c.lpNorm<1>(), 0.15);
      if (found == row_of.end()) {
        EXPECT_TRUE(d >= 3.0 || c.cwiseAbs().dot(model->velocity_limits()) <= bound + 1e-4 || c.norm() < 1e-4)
            << model->name << " " << d;
        ++left_out;
        continue;
      }
      const int r = found->second;
      EXPECT_LT((problem.A.row(r).head(nv).transpose() - c).cwiseAbs().maxCoeff(), 1e-4) << rig.controller.row_name(r);
      EXPECT_NEAR(problem.ubA[r], bound, 1e-3 * (1.0 + bound)) << rig.controller.row_name(r);
      EXPECT_EQ(rig.controller.row_name(r), "separation/" + shapes[static_cast<std::size_t>(pair.second)].name + "/" +
                                                model->shapes[static_cast<std::size_t>(pair.first)].name);
      ++rows;
    }
  }
  EXPECT_GT(rows, 300);
  EXPECT_GT(resting, 100);
  EXPECT_GT(left_out, 50);
}

// Z: with `uncertainty` a row has less room by the margin that collision rows have.
TEST(SeparationRows, LeaveTheMarginOfTheDistance) {
  const auto model = frankie();
  ControllerParams p = with_separation(*model);
  p.collision.separation.speed = 1.0;
  p.prediction.enabled = true;
  Rig known(model, p, {{"ball", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}});
  p.uncertainty.enabled = true;
  p.uncertainty.probability = 0.975;
  p.uncertainty.joints = 0.01;
  Rig unsure(model, p, {{"ball", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}});
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(model->num_velocities());
  o.goal.X_WG.translation() = Vector3(3, 0, 0.8);
  o.objects.resize(1);
  o.objects[0].X_WO.translation() = Vector3(1.3, 0.1, 0.6);
  o.objects[0].V_WO_W[3] = -0.3;
  known.step(o);
  unsure.step(o);
  const QpProblem &a = known.controller.problem(), &b = unsure.controller.problem();
  int rows = 0;
  for (int r = 0; r < a.rows; ++r) {
    if (a.ids[static_cast<std::size_t>(r)].kind != RowKind::kSeparation) continue;
    for (int s = 0; s < b.rows; ++s) {
      if (known.controller.row_name(r) != unsure.controller.row_name(s)) continue;
      const auto c = a.A.row(r).head(model->num_velocities());
      const double margin = 1.959963984540054 * 0.01 * c.tail(model->num_joints()).norm();
      const double brake = 0.6 * 4.0 * c.lpNorm<1>();
      // S_p of the two speeds differs by the margin.
      const auto separation = [&](double v) { return 0.15 + v / brake + 0.15 * v + 0.5 * v * v / brake; };
      if (b.ubA[s] <= 0.0) continue;
      EXPECT_NEAR(separation(a.ubA[r]) - separation(b.ubA[s]), margin, 1e-9) << known.controller.row_name(r);
      EXPECT_GE(a.ubA[r], b.ubA[s]);
      ++rows;
    }
  }
  EXPECT_GT(rows, 3);
}

// Something comes head-on: with the rows the robot stands before the two would have met, whatever else it is asked.
TEST(SeparationRows, ARobotStandsBeforeItIsMet) {
  const auto model = frankie();
  const std::vector<ObjectShape> ball{{"ball", {ShapeKind::kSphere, {0.2, 0, 0}, nullptr}}};
  const auto fastest_when_near = [&](bool separation) {
    ControllerParams p = with_separation(*model);
    p.collision.separation.enabled = separation;
    p.collision.object = {true, 0.06, 0.01, 1.0};  // felt late, so that the rows do the work
    p.base_weight = {false, 0.01};
    p.slack.weight = {false, 10.0};
    Rig rig(model, p, ball);
    Observation o;
    o.q = model->ready;
    o.qdot = VectorX::Zero(model->num_velocities());
    o.goal.X_WG = pose(5, 0, 0.6, kPi, 0, 0);
    o.objects.resize(1);
    o.objects[0].X_WO.translation() = Vector3(4.0, 0.0, 0.3);
    o.objects[0].V_WO_W[3] = -0.4;
    double fastest = -1.0, driven = 0.0;
    for (int k = 0; k < 600; ++k) {
      rig.step(o);
      double least = kInfinity;
      for (const auto& [pair, d] : distances(*model, ball, o)) least = std::min(least, d);
      if (least < 0.08) break;
      if (least < 0.112) fastest = std::max(fastest, rig.result.command[0]);
      driven = std::max(driven, rig.result.command[0]);
      integrate(*model, o.base, o.q, rig.result.command, 0.02);
      o.qdot = rig.result.command;
      o.objects[0].X_WO.translation().x() -= 0.4 * 0.02;
    }
    EXPECT_GT(driven, 0.3) << "it went there at first";
    return fastest;
  };
  EXPECT_GT(fastest_when_near(false), 0.2);
  EXPECT_LT(fastest_when_near(true), 0.03);
}

TEST(SeparationRows, GiveWayBeforeRowsOfWhatIsNear) {
  Rng rng(52);
  int relaxed = 0, rows = 0;
  for (int trial = 0; trial < 1200; ++trial) {
    const auto model = frankie();
    const std::vector<ObjectShape> shapes = balls(4, rng);
    ControllerParams p = with_separation(*model);
    p.collision.object.influence = 0.15;
    p.acceleration_limit.setConstant(1.0);
    Rig rig(model, p, shapes);
    Observation o = random_observation(*model, shapes.size(), rng, 1.2);
    for (std::size_t i = 0; i < 2; ++i) o.objects[i].V_WO_W.setZero();
    rig.step(o);
    if (rig.result.fallback != Fallback::kRelaxed || !rig.controller.outcome().only_separation) continue;
    ++relaxed;
    const QpProblem& problem = rig.controller.problem();
    const int nv = model->num_velocities();
    for (int r = 0; r < problem.rows; ++r) {
      if (!is_collision(problem.ids[static_cast<std::size_t>(r)].kind)) continue;
      ++rows;
      EXPECT_LE(problem.A.row(r).dot(rig.controller.solution().x.head(problem.n())), problem.ubA[r] + 1e-6)
          << rig.controller.row_name(r);
    }
    for (int i = 0; i < nv; ++i) EXPECT_LE(rig.result.command[i], problem.ub[i] + 1e-9);
  }
  EXPECT_GT(relaxed, 20);
  EXPECT_GT(rows, 20);
}

TEST(SeparationRows, TakeNoMemory) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  Rng rng(53);
  for (const auto& model : built_robots()) {
    ControllerParams p = with_separation(*model);
    p.prediction.enabled = p.uncertainty.enabled = true;
    Rig rig(model, p, random_objects(rng, 12));
    std::vector<Observation> seen;
    for (int k = 0; k < 50; ++k) seen.push_back(random_observation(*model, 12, rng, 1.0));
    int rows = 0;
    NoAlloc guard;
    for (const Observation& o : seen) {
      rig.step(o);
      rows += rig.rows(RowKind::kSeparation);
    }
    EXPECT_EQ(guard.count(), 0) << model->name;
    EXPECT_GT(rows, 50) << model->name;
  }
}

}  // namespace
}  // namespace moma
