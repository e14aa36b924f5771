// The ways to a stop, against the same in steps of a fifth of a millisecond that share no code with the check.

#include "controller/safe/brake_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "controller/qp/collision.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/control_period.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

struct BrakeScene {
  std::shared_ptr<const RobotModel> model;
  VectorX acceleration;
  std::vector<ObjectShape> shapes;

  explicit BrakeScene(std::shared_ptr<const RobotModel> m, Rng& rng) : model(std::move(m)) {
    acceleration = VectorX::Constant(model->num_velocities(), 5.0);
    if (model->base_dof() > 0) acceleration.head(model->base_dof() - 1).setConstant(model->base.max_acceleration.x());
    if (model->base_dof() > 0) acceleration[model->base_dof() - 1] = model->base.max_acceleration.y();
    shapes = random_objects(rng, 6);
  }
  BrakeCheck check(double margin, int every, const OwnMargins& own = {}) const {
    BrakeCheck c(model, {.enabled = true, .margin = margin, .every = every}, acceleration, true, kPeriod, {{}, 0}, own);
    c.set_objects(shapes);
    return c;
  }
};

// Of the base, as a drive does it: the linear velocity is one vector.
double rate(const BrakeScene& scene, const VectorX& u, Eigen::Index i) {
  const bool pair = scene.model->base_dof() == 3 && i < 2;
  const double size = pair ? std::hypot(u[0], u[1]) : std::abs(u[i]);
  return size > 0.0 ? scene.acceleration[i] * std::abs(u[i]) / size : 0.0;
}

// To objects alone, or to the floor and to itself alone.
constexpr ProximityRanges kObjects{1.0, -1.0, -1.0}, kFloor{-1.0, 1.0, -1.0}, kSelf{-1.0, -1.0, 1.0};

// Least distance on the way: one period (or `hold`) towards u by the drive, then braking.
double simulated(const BrakeScene& scene, const Observation& o, const VectorX& u, bool in_proportion,
                 const ProximityRanges& ranges = kObjects, double hold = kPeriod) {
  Kinematics kinematics(scene.model);
  Proximity proximity(scene.model);
  proximity.set_objects(scene.shapes);
  constexpr double h = 2e-4;
  Vector3 base = o.base;
  VectorX q = o.q, v = u;
  const int dof = scene.model->base_dof();
  v.head(dof) = o.qdot.head(dof);
  double last = 0.0;
  for (Eigen::Index i = 0; i < u.size(); ++i)
    if (u[i] != 0.0) last = std::max(last, std::abs(u[i]) / rate(scene, u, i));
  double least = 1e9;
  for (double t = 0.0; t < hold + last; t += h) {
    if (t < hold) {
      VectorX change = u - v;
      if (dof > 0) {
        const double linear = change.head(dof - 1).norm(), most = scene.model->base.max_acceleration.x() * h;
        if (linear > most) change.head(dof - 1) *= most / linear;
        const double turn = scene.model->base.max_acceleration.y() * h;
        change[dof - 1] = std::min(std::max(change[dof - 1], -turn), turn);
      }
      v += change;
    } else {
      for (Eigen::Index i = 0; i < u.size(); ++i) {
        const double down = in_proportion ? std::abs(u[i]) / last : rate(scene, u, i);
        v[i] = std::copysign(std::max(0.0, std::abs(u[i]) - down * (t - hold)), u[i]);
      }
    }
    base.z() += 0.5 * h * (dof > 0 ? v[dof - 1] : 0.0);
    if (dof > 0) {
      const double vy = dof == 3 ? v[1] : 0.0;
      base.x() += h * (v[0] * std::cos(base.z()) - vy * std::sin(base.z()));
      base.y() += h * (v[0] * std::sin(base.z()) + vy * std::cos(base.z()));
      base.z() += 0.5 * h * v[dof - 1];
    }
    q += h * v.tail(q.size());
    const long step = std::lround(t / h);
    if (step % 5 != 0) continue;
    kinematics.update(base, q);
    for (const ProximityPair& pair : proximity.query(kinematics, o.objects, ranges))
      least = std::min(least, pair.distance.d);
  }
  return least;
}

Observation still_objects(const BrakeScene& scene, Rng& rng) {
  Observation o = random_observation(*scene.model, scene.shapes.size(), rng, 1.2);
  for (ObjectState& object : o.objects) object.V_WO_W.setZero();
  return o;
}

VectorX near_velocity(const BrakeScene& scene, const VectorX& qdot, Rng& rng) {
  VectorX u = qdot;
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i] += uniform(rng, -0.6, 0.6) * scene.acceleration[i] * kPeriod;
  return u;
}

TEST(BrakeCheck, FindsTheLeastDistanceOnTheWayToAStop) {
  Rng rng(1);
  int within = 0;
  for (const auto& model : built_robots()) {
    for (int trial = 0; trial < 40; ++trial) {
      const BrakeScene scene(model, rng);
      BrakeCheck fine = scene.check(0.5, 1);
      const Observation o = still_objects(scene, rng);
      const VectorX u = near_velocity(scene, o.qdot, rng);
      VectorX out = u;
      // apply() is what hands over where the objects are.
      fine.apply(o, {u, u, u}, {}, out);
      for (const bool in_proportion : {true, false}) {
        const double expected = simulated(scene, o, u, in_proportion);
        const double found = fine.least_distance(o, u, in_proportion);
        if (expected > 0.45) continue;
        ++within;
        // Places are looked at every period, and tips move at up to 3 m/s.
        EXPECT_GT(found, expected - 0.004) << model->name << " trial " << trial << " together " << in_proportion;
        EXPECT_LT(found, expected + 0.03) << model->name << " trial " << trial << " together " << in_proportion;
      }
    }
  }
  EXPECT_GT(within, 100);
}

// Where steps are missed a command acts for longer than a period.
TEST(BrakeCheck, BrakesLaterWhereTheCommandMayActForLonger) {
  Rng rng(2);
  int within = 0;
  double off = 0.0, off_without = 0.0;
  for (const auto& model : built_robots()) {
    for (int trial = 0; trial < 20; ++trial) {
      const BrakeScene scene(model, rng);
      BrakeCheck fine = scene.check(0.5, 1);
      const Observation o = still_objects(scene, rng);
      const VectorX u = near_velocity(scene, o.qdot, rng);
      VectorX out = u;
      fine.apply(o, {u, u, u}, {}, out);
      const double once = fine.least_distance(o, u, true);
      fine.set_execution(4 * kPeriod, {});
      const double expected = simulated(scene, o, u, true, kObjects, 4 * kPeriod);
      const double found = fine.least_distance(o, u, true);
      if (expected > 0.45) continue;
      ++within;
      off += std::abs(found - expected);
      off_without += std::abs(std::min(once, 0.5) - expected);
      EXPECT_NEAR(found, expected, 0.04) << model->name << " trial " << trial;
    }
  }
  EXPECT_GT(within, 30);
  EXPECT_LT(off, 0.5 * off_without) << "as far off as without the longer hold";
}

TEST(BrakeCheck, GivesWayOnlyWhereItMustAndStaysInsideTheBox) {
  Rng rng(2);
  int passed = 0, mended = 0;
  for (const auto& model : built_robots()) {
    for (int trial = 0; trial < 800; ++trial) {
      const BrakeScene scene(model, rng);
      BrakeCheck check = scene.check(0.02, 2);
      const Observation o = still_objects(scene, rng);
      const VectorX step = 10.0 * kPeriod * scene.acceleration;  // a robot that can slow down at once, nearly
      const VectorX lower = o.qdot - step, upper = o.qdot + step;
      const VectorX slowest = VectorX::Zero(o.qdot.size()).cwiseMax(lower).cwiseMin(upper);
      const VectorX u = near_velocity(scene, o.qdot, rng);
      VectorX command = u;
      NoAlloc guard;
      const double kept = check.apply(o, {lower, upper, slowest}, {}, command);
      EXPECT_EQ(guard.count(), 0);
      for (Eigen::Index i = 0; i < u.size(); ++i) {
        EXPECT_GE(command[i], lower[i] - 1e-12);
        EXPECT_LE(command[i], upper[i] + 1e-12);
      }
      const auto clearance = [&](const VectorX& v) {
        return std::max(check.least_distance(o, v, true), check.least_distance(o, v, false));
      };
      EXPECT_GE(clearance(command), std::min(clearance(u), 0.02) - 1e-12);
      if (clearance(u) >= 0.02) {
        ++passed;
        EXPECT_EQ(kept, 1.0);
        EXPECT_EQ(command, u);
      } else if (clearance(command) >= 0.02) {
        ++mended;
        EXPECT_LT(kept, 1.0);
      }
    }
  }
  EXPECT_GT(passed, 100);
  EXPECT_GT(mended, 10);
}

TEST(BrakeCheck, LooksAtTheFloorAndAtTheRobotItself) {
  Rng rng(5);
  int by_floor = 0, by_itself = 0;
  constexpr double kMargin = 0.3;
  const OwnMargins own{0.3, 0.2};  // of the floor more, since what no joint lifts is left out
  for (const auto& model : built_robots()) {
    for (int trial = 0; trial < 40; ++trial) {
      const BrakeScene scene(model, rng);
      BrakeCheck check = scene.check(kMargin, 1, own);
      Observation o = still_objects(scene, rng);
      for (ObjectState& object : o.objects) object.visible = false;
      const VectorX u = near_velocity(scene, o.qdot, rng);
      VectorX out = u;
      NoAlloc guard;
      check.apply(o, {u, u, u}, {}, out);
      EXPECT_EQ(guard.count(), 0);
      for (const bool in_proportion : {true, false}) {
        const double to_floor = simulated(scene, o, u, in_proportion, kFloor) - own.floor;
        const double to_itself = simulated(scene, o, u, in_proportion, kSelf) - own.self;
        const double expected = kMargin + std::min(to_floor, to_itself);
        if (expected > kMargin - 0.05) continue;
        ++(to_floor < to_itself ? by_floor : by_itself);
        const double found = check.least_distance(o, u, in_proportion);
        EXPECT_GT(found, expected - 0.004) << model->name << " trial " << trial << " together " << in_proportion;
        EXPECT_LT(found, expected + 0.03) << model->name << " trial " << trial << " together " << in_proportion;
      }
    }
  }
  EXPECT_GT(by_floor, 20);
  EXPECT_GT(by_itself, 20);
}

// What is uncertain by the same in all directions is nearer by the same on the whole way.
TEST(BrakeCheck, KeepsItsMarginForWhatIsUncertain) {
  Rng rng(4);
  UncertaintyParams params;
  params.enabled = true;
  params.object_bias = 0.02;
  const double margin = normal_quantile(params.probability) * 0.02;
  const std::vector<PlaceSpread> spreads(6, PlaceSpread{0.02, 0.0});
  int compared = 0, mended = 0;
  for (const auto& model : built_robots()) {
    const Uncertainty uncertainty(params, model->base_dof());
    for (int trial = 0; trial < 60; ++trial) {
      const BrakeScene scene(model, rng);
      BrakeCheck plain = scene.check(0.4, 2);
      const auto uncertain = [&](double kept) {
        BrakeCheck c(model, {.enabled = true, .margin = kept, .every = 2}, scene.acceleration, true, kPeriod,
                     uncertainty);
        c.set_objects(scene.shapes);
        return c;
      };
      BrakeCheck far = uncertain(0.4), near = uncertain(0.02);
      const Observation o = still_objects(scene, rng);
      const VectorX u = near_velocity(scene, o.qdot, rng);
      VectorX out = u;
      plain.apply(o, {u, u, u}, {}, out);
      NoAlloc guard;
      far.apply(o, {u, u, u}, spreads, out);
      EXPECT_EQ(guard.count(), 0);
      for (const bool in_proportion : {true, false}) {
        const double d = plain.least_distance(o, u, in_proportion);
        if (!(d < 0.4)) continue;
        EXPECT_NEAR(far.least_distance(o, u, in_proportion), d - margin, 1e-12) << model->name << " trial " << trial;
        ++compared;
      }
      // From 2 cm to 2 cm and the margin, one gives way and the other does not.
      const double d = std::max(plain.least_distance(o, u, true), plain.least_distance(o, u, false));
      const VectorX zero = VectorX::Zero(u.size()), box = VectorX::Constant(u.size(), 10.0);
      out = u;
      const double kept = near.apply(o, {-box, box, zero}, spreads, out);
      if (d >= 0.02 + margin) {
        EXPECT_EQ(kept, 1.0);
      }
      if (d < 0.02 + margin && d >= 0.02) {
        mended += kept < 1.0 ? 1 : 0;
        out = u;
        EXPECT_EQ(scene.check(0.02, 2).apply(o, {-box, box, zero}, {}, out), 1.0);
      }
    }
  }
  EXPECT_GT(compared, 100);
  EXPECT_GT(mended, 3);
}

// The same places with all distances at each of them.
double measured_everywhere(const BrakeScene& scene, const Observation& o, const VectorX& u, bool in_proportion,
                           const BrakeCheckParams& params, const OwnMargins& own) {
  Kinematics kinematics(scene.model);
  Proximity proximity(scene.model);
  proximity.set_objects(scene.shapes);
  Vector3 base = o.base;
  VectorX q = o.q, mean = u, times = u;
  double last = 0.0;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    times[i] = u[i] != 0.0 ? std::abs(u[i]) / rate(scene, u, i) : 0.0;
    last = std::max(last, times[i]);
  }
  if (in_proportion) times.setConstant(last);
  double least = kInfinity;
  const auto look = [&] {
    kinematics.update(base, q);
    for (const ProximityPair& pair : proximity.query(kinematics, o.objects, {params.margin, own.floor, own.self})) {
      const double kept = pair.kind == PairKind::kObject  ? params.margin
                          : pair.kind == PairKind::kFloor ? own.floor
                                                          : own.self;
      least = std::min(least, pair.distance.d + params.margin - kept);
    }
  };
  Vector3 velocity = Vector3::Zero(), wanted = Vector3::Zero();
  const int dof = scene.model->base_dof();
  velocity.head(dof) = o.qdot.head(dof);
  wanted.head(dof) = u.head(dof);
  mean.head(dof) = BaseRamp(*scene.model).follow(wanted, kPeriod, velocity).head(dof);
  integrate(*scene.model, base, q, mean, kPeriod);
  look();
  const auto gone = [](double time, double t) { return t < time ? t - 0.5 * t * t / time : 0.5 * time; };
  const double part = params.every * kPeriod;
  for (double from = 0.0; from < last - 1e-12; from += part) {
    const double to = std::min(from + part, last);
    for (Eigen::Index i = 0; i < u.size(); ++i)
      mean[i] = u[i] * (gone(times[i], to) - gone(times[i], from)) / (to - from);
    integrate(*scene.model, base, q, mean, to - from);
    look();
  }
  return least;
}

TEST(BrakeCheck, FindsWithFewDistancesWhatItFindsWithAll) {
  Rng rng(6);
  int within = 0, clear = 0, mended = 0;
  const OwnMargins own{0.01, 0.02};
  for (const auto& model : built_robots()) {
    Kinematics kinematics(model);
    for (int trial = 0; trial < 300; ++trial) {
      const BrakeScene scene(model, rng);
      const BrakeCheckParams params{.enabled = true, .margin = trial % 3 == 0 ? 0.2 : 0.02, .every = 1 + trial % 4};
      BrakeCheck check = scene.check(params.margin, params.every, own);
      check.keep_from_unseen(params.margin);
      Observation o = still_objects(scene, rng);
      for (std::size_t i = 0; i < o.objects.size(); i += 2) o.objects[i].seen = false;
      const VectorX u = near_velocity(scene, o.qdot, rng);
      Proximity proximity(model);
      proximity.set_objects(scene.shapes);
      kinematics.update(o.base, o.q);
      // The rows know the pairs that they keep; unseen space beyond its own influence is not among them.
      CollisionParams dampers;
      dampers.object.influence = 0.3;
      dampers.floor.influence = dampers.self.influence = 0.1;
      dampers.self.enabled = trial % 2 == 0;
      CollisionRows rows(*model, dampers, {*model, scene.acceleration, true}, {{}, 0});
      rows.keep_from_unseen({.influence = 0.15});
      rows.allocate(static_cast<int>(scene.shapes.size()));
      const ProximityRanges ranges = rows.ranges();
      rows.select(proximity.query(kinematics, o.objects, ranges), o.objects);
      const auto near = rows.sorted();
      const VectorX step = 10.0 * kPeriod * scene.acceleration;
      const VectorX lower = o.qdot - step, upper = o.qdot + step;
      const VectorX slowest = VectorX::Zero(o.qdot.size()).cwiseMax(lower).cwiseMin(upper);
      VectorX alone = u, told = u;
      const double kept = check.apply(o, {lower, upper, slowest}, {}, alone);
      NoAlloc guard;
      EXPECT_EQ(check.apply(o, {lower, upper, slowest}, {}, told, {near, ranges}), kept);
      EXPECT_EQ(guard.count(), 0);
      EXPECT_EQ(told, alone) << "what is known of distances shows in the result";
      mended += kept < 1.0 ? 1 : 0;
      for (const bool in_proportion : {true, false}) {
        const double expected = measured_everywhere(scene, o, u, in_proportion, params, own);
        const double found = check.least_distance(o, u, in_proportion);
        ++(expected < params.margin ? within : clear);
        if (expected < params.margin) {
          EXPECT_NEAR(found, expected, 1e-9) << model->name << " trial " << trial << " together " << in_proportion;
        } else {
          EXPECT_EQ(found, kInfinity) << model->name << " trial " << trial << " together " << in_proportion;
        }
      }
    }
  }
  EXPECT_GT(within, 300);
  EXPECT_GT(clear, 300);
  EXPECT_GT(mended, 50);
}

TEST(BrakeCheck, LeavesWhatMovesOut) {
  Rng rng(3);
  BrakeScene scene(frankie(), rng);
  scene.shapes[0] = {"ball", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}};
  BrakeCheck check = scene.check(0.3, 1);
  Observation o = still_objects(scene, rng);
  o.base.setZero();
  o.q = scene.model->ready;
  o.objects[0].X_WO.translation() = Vector3(0.7, 0.0, 0.4);  // ahead of the base, nearer than the margin
  for (std::size_t i = 1; i < o.objects.size(); ++i) o.objects[i].visible = false;
  o.qdot.setZero();
  VectorX command = VectorX::Zero(9);
  command[0] = 0.04;
  const VectorX given = command, box = VectorX::Constant(9, 0.04);
  EXPECT_LT(check.apply(o, {-box, box, VectorX::Zero(9)}, {}, command), 1.0);
  command = given;
  o.objects[0].V_WO_W[3] = -0.2;
  EXPECT_EQ(check.apply(o, {-box, box, VectorX::Zero(9)}, {}, command), 1.0);
  EXPECT_EQ(command, given);
}

}  // namespace
}  // namespace moma
