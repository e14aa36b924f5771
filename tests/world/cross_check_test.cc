// The two detectors of contact beside each other: they agree, and where ODE is made to lie it is noticed. This
// program's dCollide stands before the library's own.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cmath>

#include "tests/world/solids.h"
#include "tests/world/support.h"

namespace {
enum class Ode { kHonest, kBlind, kSeeing };
Ode ode_is = Ode::kHonest;
}  // namespace

extern "C" int dCollide(dGeomID a, dGeomID b, int flags, dContactGeom* contact, int skip) {
  using Function = int(dGeomID, dGeomID, int, dContactGeom*, int);
  static auto* const real = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, "dCollide"));
  if (ode_is == Ode::kBlind) return 0;
  const int found = real(a, b, flags, contact, skip);
  if (ode_is == Ode::kHonest || found > 0) return found;
  *contact = {};
  contact->g1 = a;
  contact->g2 = b;
  return 1;
}

namespace moma {
namespace {

Isometry at(double x, double y, double z) {
  Isometry X = Isometry::Identity();
  X.translation() = Vector3(x, y, z);
  return X;
}

Shape ball(double radius) { return {ShapeKind::kSphere, Vector3(radius, 0, 0), nullptr}; }

class CrossCheckTest : public testing::Test {
 protected:
  void TearDown() override { ode_is = Ode::kHonest; }
  static DetectorCheck check(const std::shared_ptr<const RobotModel>& model, const World& world) {
    const auto plant = make_plant(model, world, {SimulationMode::kKinematic});
    PlantReport report;
    plant->check_start(report);
    return plant->cross_check();
  }
};

TEST_F(CrossCheckTest, AMissedContactIsCountedWithItsDepth) {
  const auto model = test::one_solid(ball(0.1), at(0, 0, 1));
  World world = test::one_object(ball(0.2), at(0.29, 0, 1));  // 1 cm deep
  EXPECT_EQ(check(model, world).disagreements, 0);
  ode_is = Ode::kBlind;
  const DetectorCheck missed = check(model, world);
  EXPECT_EQ(missed.disagreements, 1);
  EXPECT_NEAR(missed.deepest, 0.01, 1e-6);
  world = test::one_object(ball(0.2), at(0.31, 0, 1));
  EXPECT_EQ(check(model, world).disagreements, 0) << "there is nothing to be missed";
}

TEST_F(CrossCheckTest, AnInventedContactIsCountedWithItsGap) {
  const auto model = test::one_solid(ball(0.1), at(0, 0, 1));
  // Apart, but the boxes around them overlap: others are not asked about.
  const World world = test::one_object(ball(0.2), at(0.22, 0.22, 1));
  EXPECT_EQ(check(model, world).disagreements, 0);
  ode_is = Ode::kSeeing;
  const DetectorCheck invented = check(model, world);
  EXPECT_EQ(invented.disagreements, 1);
  EXPECT_NEAR(invented.deepest, 0.22 * std::sqrt(2.0) - 0.3, 1e-6);
}

TEST_F(CrossCheckTest, SelfCollisionIsComparedToo) {
  RobotModel changed = *test::robot("ur5");
  const auto model = std::make_shared<const RobotModel>(changed);
  World world = test::empty_world(*model);
  EXPECT_EQ(check(model, world).disagreements, 0);
  world.start.q << 0.0, -0.3, 2.9, 0.5, 0.0, 0.0;  // folded: the forearm lies in the upper arm
  EXPECT_EQ(check(model, world).disagreements, 0) << "both find it";
  ode_is = Ode::kBlind;
  EXPECT_GT(check(model, world).disagreements, 0);
}

TEST_F(CrossCheckTest, TheDetectorsAgreeThroughMovesAndChangeNothing) {
  const Worlds source =
      test::worlds("{seed: 8, families: {clutter: {weight: 1, objects: 12}, moving: {weight: 1, objects: 6}}}");
  for (const char* name : {"frankie", "lift_ur5"}) {
    const auto model = test::robot(name);
    for (const SimulationMode mode : {SimulationMode::kKinematic, SimulationMode::kDynamic}) {
      for (std::uint64_t i = 0; i < 4; ++i) {
        const World world = source.make(model, i);
        const auto checked = make_plant(model, world, {mode});
        const auto plain = make_plant(model, world, {mode});
        PlantReport report, other;
        VectorX command = VectorX::Zero(model->num_velocities());
        command[0] = 0.8;  // through everything
        for (int k = 0; k < 60; ++k) {
          checked->advance(command, 0.02, report);
          plain->advance(command, 0.02, other);
          ASSERT_EQ(report.contacts.size(), other.contacts.size());
          ASSERT_EQ(checked->state().q, plain->state().q);
          ASSERT_EQ(checked->state().base, plain->state().base);
          const DetectorCheck found = checked->cross_check();
          ASSERT_EQ(found.disagreements, 0) << name << " world " << i << " step " << k << ": " << found.deepest << " m";
          if (report.diverged) break;
        }
      }
    }
  }
}

}  // namespace
}  // namespace moma
