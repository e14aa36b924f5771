#include "world/plant/contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/world/solids.h"
#include "tests/world/support.h"
#include "world/draws.h"

namespace moma {
namespace {

using test::one_object;
using test::one_solid;
using test::random_shape;

struct Collector {
  void take(const Touch& t) {
    if (t.kind == PairKind::kFloor) ++floor;
    if (t.kind != PairKind::kObject) return;
    ++object;
    for (int i = 0; i < t.count; ++i) depth = std::max(depth, static_cast<double>(t.points[i].depth));
  }
  int object = 0, floor = 0;
  double depth = 0.0;
};

Isometry random_pose(Draws& draws, double spread, bool aligned) {
  Isometry X = Isometry::Identity();
  Eigen::Quaterniond q(draws.normal(0, 1), draws.normal(0, 1), draws.normal(0, 1), draws.normal(0, 1));
  X.linear() = q.normalized().toRotationMatrix();
  if (aligned) {  // quarter turns: the case that ODE's box test finds hard
    Matrix3 R = Matrix3::Identity();
    for (int i = 0; i < 3; ++i)
      R = Eigen::AngleAxisd(0.5 * std::numbers::pi * static_cast<double>(draws.choice(4)), Vector3::Unit(i)) * R;
    X.linear() = R;
  }
  for (int i = 0; i < 3; ++i) X.translation()[i] = draws.uniform(-spread, spread);
  X.translation().z() += 0.3;
  return X;
}

class TruthTable : public testing::TestWithParam<std::tuple<ShapeKind, ShapeKind, bool>> {};

TEST_P(TruthTable, AgreesWithTheDistanceLibrary) {
  const auto [first, second, aligned] = GetParam();
  Draws draws(17, 0, Stream::kObjects, static_cast<std::uint64_t>(first), static_cast<std::uint64_t>(second));
  int touching = 0, wrong = 0;
  double worst_depth = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const Shape a = random_shape(first, draws);
    const Shape b = random_shape(second, draws);
    const Isometry X_a = random_pose(draws, 0.3, aligned);
    const Isometry X_b = random_pose(draws, 0.3, aligned);
    const Distance truth = shape_distance(a, X_a, b, X_b);
    if (std::abs(truth.d) < 1e-5) continue;
    const World world = one_object(b, X_b);
    const auto model = one_solid(a, X_a);
    ContactScene scene(model, world, false);
    Kinematics kinematics(model);
    kinematics.update(Vector3::Zero(), model->ready);
    scene.place_robot(kinematics);
    Collector found;
    scene.detect([&](const Touch& t) { found.take(t); });
    touching += truth.d < 0.0;
    if ((found.object > 0) != (truth.d < 0.0)) ++wrong;
    if (truth.d < 0.0 && first != ShapeKind::kBox && second != ShapeKind::kBox)
      worst_depth = std::max(worst_depth, std::abs(found.depth + truth.d));
    EXPECT_EQ(found.floor > 0, lowest_point(a, X_a) < 0.0) << "floor";
  }
  EXPECT_EQ(wrong, 0) << "of " << touching << " touching";
  EXPECT_GT(touching, 300) << "the table must try both answers";
  EXPECT_LT(touching, 2900);
  EXPECT_LT(worst_depth, 1e-9);
}

constexpr auto kSphere = ShapeKind::kSphere;
constexpr auto kBox = ShapeKind::kBox;
constexpr auto kCapsule = ShapeKind::kCapsule;
INSTANTIATE_TEST_SUITE_P(Ode, TruthTable,
                         testing::Values(std::make_tuple(kSphere, kSphere, false),
                                         std::make_tuple(kSphere, kBox, false),
                                         std::make_tuple(kSphere, kCapsule, false), std::make_tuple(kBox, kBox, false),
                                         std::make_tuple(kBox, kBox, true), std::make_tuple(kBox, kCapsule, false),
                                         std::make_tuple(kCapsule, kCapsule, false),
                                         std::make_tuple(kCapsule, kBox, true)));

TEST(Contacts, CylindersAreDecidedByTheDistanceLibrary) {
  Draws draws(19, 0, Stream::kObjects);
  int touching = 0;
  for (int i = 0; i < 300; ++i) {
    Shape a = random_shape(kCapsule, draws);
    Shape b = random_shape(kCapsule, draws);
    b.kind = ShapeKind::kCylinder;
    if (i % 2 == 1) std::swap(a, b);
    const Isometry X_a = random_pose(draws, 0.3, false);
    const Isometry X_b = random_pose(draws, 0.3, false);
    const double d = shape_distance(a, X_a, b, X_b).d;
    if (std::abs(d) < 1e-4) continue;
    const World world = one_object(b, X_b);
    const auto model = one_solid(a, X_a);
    const auto plant = make_plant(model, world, {SimulationMode::kKinematic});
    PlantReport report;
    plant->check_start(report);
    int found = 0;
    for (const Contact& contact : report.contacts) {
      if (contact.kind != PairKind::kObject) continue;
      ++found;
      EXPECT_FALSE(contact.by_ode);
      EXPECT_NEAR(contact.depth, -d, 1e-5);
    }
    EXPECT_EQ(found > 0, d < 0.0) << d;
    touching += d < 0.0;
  }
  EXPECT_GT(touching, 30);
}

TEST(Contacts, SkippingWhatCannotHaveMovedFarEnoughMissesNothing) {
  const auto model = test::robot("panda");
  World world = test::empty_world(*model);
  world.objects = {test::solid("post", ShapeKind::kCylinder, {0.05, 1.2, 0.0}, {0.45, 0.25, 0.6}),
                   test::solid("roller", ShapeKind::kCylinder, {0.1, 0.3, 0.0}, {0.3, -0.6, 0.5})};
  LinearMotion motion;
  motion.V_W << 0.0, 0.0, 1.0, 0.0, 0.2, 0.0;
  world.objects[1].motion = motion;
  const auto plant = make_plant(model, world, {SimulationMode::kKinematic});
  PlantReport report, fresh;
  int touching = 0, free = 0;
  for (int k = 1; k <= 800; ++k) {
    VectorX command(7);
    for (int j = 0; j < 7; ++j) command[j] = 0.8 * std::cos(0.011 * k * (j + 1) + j);
    plant->advance(command, 0.005, report);  // one check
    World now = world;
    now.start.q = plant->state().q;
    now.objects[1].X_WO = evaluate(motion, world.objects[1].X_WO, plant->time()).X;
    make_plant(model, now, {SimulationMode::kKinematic})->check_start(fresh);
    ASSERT_EQ(report.contacts.size(), fresh.contacts.size()) << "step " << k;
    for (std::size_t i = 0; i < fresh.contacts.size(); ++i)
      ASSERT_NEAR(report.contacts[i].depth, fresh.contacts[i].depth, 1e-9);
    (fresh.contacts.empty() ? free : touching) += 1;
  }
  EXPECT_GT(touching, 20);
  EXPECT_GT(free, 20);
}

TEST(Contacts, EachPairOnceWithFirstTimeAndGreatestDepth) {
  std::vector<Contact> contacts;
  ContactLog log(contacts);
  log.add({PairKind::kObject, 2, 1, 0.01, 0.5, true});
  log.add({PairKind::kSelf, 0, 3, 0.02, 0.4, true});
  log.add({PairKind::kObject, 2, 1, 0.05, 0.6, true});
  log.add({PairKind::kObject, 2, 1, 0.03, 0.7, true});
  log.sort();
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_EQ(contacts[0].kind, PairKind::kSelf);
  EXPECT_EQ(contacts[1].time, 0.5);
  EXPECT_EQ(contacts[1].depth, 0.05);
}

}  // namespace
}  // namespace moma
