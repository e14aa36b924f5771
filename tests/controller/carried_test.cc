// A carried object: a shape of the hand that keeps off everything else, and no obstacle; distances by coal's own entry
// point, rows and steps of the controller, and the robot that carries nothing bit for bit.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "controller/controller_core.h"
#include "controller/model/shape_ways.h"
#include "tests/controller/plan_scenes.h"
#include "tests/support/no_alloc.h"

namespace moma::test {
namespace {

constexpr ProximityRanges kFar{2.0, 2.0, 2.0};

Isometry in_hand() {
  Isometry X = Isometry::Identity();
  X.translation() = Vector3(0.02, -0.01, 0.15);
  X.linear() = Eigen::AngleAxisd(0.4, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  return X;
}

// A robot at rest with its arm ready, and E at its goal.
Observation at_ready(const RobotModel& model, Kinematics& kinematics) {
  Observation o;
  o.q = model.ready;
  o.qdot = VectorX::Zero(model.num_velocities());
  kinematics.update(o.base, o.q);
  o.goal.X_WG = kinematics.X_WE();
  return o;
}

TEST(Carried, IsAShapeOfTheHandAndNoObstacle) {
  const auto plain = load_model("configs/robots/frankie.yaml");
  const auto model = with_spare_shape(*plain);
  const int spare = static_cast<int>(model->shapes.size()) - 1;
  Proximity proximity(model), empty(plain);
  Kinematics kinematics(model), at(plain);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scene scene = make_scene(plain, seed, 6);
    proximity.set_objects(scene.shapes);
    empty.set_objects(scene.shapes);
    kinematics.update(scene.start.head<3>(), scene.start.tail(model->num_joints()));
    at.update(scene.start.head<3>(), scene.start.tail(model->num_joints()));

    carry(*model, {}, nullptr);
    const auto without = empty.query(at, scene.states, kFar);
    const auto absent = proximity.query(kinematics, scene.states, kFar);
    ASSERT_EQ(absent.size(), without.size());
    for (std::size_t i = 0; i < absent.size(); ++i) {
      EXPECT_EQ(absent[i].first, without[i].first);
      EXPECT_EQ(absent[i].second, without[i].second);
      EXPECT_EQ(absent[i].distance.d, without[i].distance.d);
    }

    const Carried carried{0, in_hand(), 1};
    carry(*model, carried, &scene.shapes[0].shape);
    const Isometry X_WO = kinematics.X_WE() * carried.X_EO;
    int of_spare = 0, own = 0;
    for (const ProximityPair& pair : proximity.query(kinematics, scene.states, kFar)) {
      EXPECT_FALSE(pair.kind == PairKind::kObject && pair.second == 0) << "what is carried is no obstacle";
      if (pair.kind != PairKind::kSelf && pair.first != spare) continue;
      if (pair.kind == PairKind::kSelf && pair.second != spare) continue;
      const Shape& shape = scene.shapes[0].shape;
      double expected = 0.0;
      if (pair.kind == PairKind::kObject) {
        const auto k = static_cast<std::size_t>(pair.second);
        EXPECT_NE(pair.second, 1) << "its support";
        expected = coal_distance(shape, X_WO, scene.shapes[k].shape, scene.states[k].X_WO);
        ++of_spare;
      } else if (pair.kind == PairKind::kFloor) {
        expected = -support(shape, X_WO, -Vector3::UnitZ());
        ++of_spare;
      } else {
        const CollisionShape& other = model->shape(pair.first);
        EXPECT_NE(model->rigid_root(other.link), model->rigid_root(model->tip)) << other.name;
        expected = coal_distance(other.shape, kinematics.X_WS(other), shape, X_WO);
        ++own;
      }
      EXPECT_NEAR(pair.distance.d, expected, 2e-5) << "seed " << seed;
    }
    EXPECT_GE(of_spare, 1);
    EXPECT_GT(own, 3);
  }
}

// Every other pair keeps its bits.
TEST(Carried, MayTouchSomeShapes) {
  const auto model = with_spare_shape(*load_model("configs/robots/panda.yaml"));
  const int spare = static_cast<int>(model->shapes.size()) - 1;
  Proximity proximity(model);
  const std::vector<ObjectShape> shapes{{"ball", make_sphere(0.05)}};
  proximity.set_objects(shapes);
  const Kinematics kinematics(model);
  std::vector<ObjectState> states(1);
  const auto pairs = [&](const Vector6& touch) {
    Carried carried{0, in_hand(), kNoSupport};
    carried.touch = touch;
    carry(*model, carried, &shapes[0].shape);
    std::vector<std::pair<int, double>> out;
    for (const ProximityPair& pair : proximity.query(kinematics, states, kFar))
      if (pair.kind == PairKind::kSelf && pair.second == spare) out.emplace_back(pair.first, pair.distance.d);
    return out;
  };
  auto all = pairs(Carried().touch);
  ASSERT_GT(all.size(), 3u);
  Vector6 touch = Carried().touch;
  touch[0] = all[1].first;
  touch[1] = all[2].first;
  const auto rest = pairs(touch);
  EXPECT_FALSE(proximity.within(PairKind::kSelf, all[1].first, spare, states, 2.0).has_value());
  EXPECT_TRUE(proximity.within(PairKind::kSelf, all[0].first, spare, states, 2.0).has_value());
  all.erase(all.begin() + 1, all.begin() + 3);
  EXPECT_EQ(rest, all);
}

TEST(Carried, StandsOnTheFloorUntilItIsLifted) {
  const auto model = with_spare_shape(*load_model("configs/robots/panda.yaml"));
  Proximity proximity(model);
  const std::vector<ObjectShape> shapes{{"ball", make_sphere(0.05)}};
  proximity.set_objects(shapes);
  const Kinematics kinematics(model);
  const auto floor_pairs = [&](int support) {
    carry(*model, Carried{0, in_hand(), support}, &shapes[0].shape);
    int count = 0;
    for (const ProximityPair& pair : proximity.query(kinematics, std::vector<ObjectState>(1), {-1.0, 5.0, -1.0}))
      count += pair.first + 1 == static_cast<int>(model->shapes.size()) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(floor_pairs(kNoSupport), 1);
  EXPECT_EQ(floor_pairs(kFloorSupport), 0);
}

// Travel bounds follow the shape: no point of it travels farther between two configurations.
TEST(Carried, TravelsNoFartherThanItsBound) {
  const auto model = with_spare_shape(*load_model("configs/robots/frankie.yaml"));
  const Shape box = make_box(0.1, 0.2, 0.3);
  const int spare = static_cast<int>(model->shapes.size()) - 1;
  ShapeWays ways(*model);
  carry(*model, Carried{0, in_hand(), kNoSupport}, &box);
  Kinematics from(model), to(model);
  from.update(Vector3::Zero(), model->ready);
  ways.begin(from);
  VectorX most = VectorX::Constant(model->num_velocities(), 0.02);
  ways.limit(most);
  EXPECT_GT(ways.radius(spare), 0.18);
  Vector3 base = Vector3::Zero();
  VectorX q = model->ready;
  integrate(*model, base, q, most, 1.0);
  to.update(base, q);
  double moved = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 p = 0.5 * Vector3(corner & 1 ? 0.1 : -0.1, corner & 2 ? 0.2 : -0.2, corner & 4 ? 0.3 : -0.3);
    moved = std::max(moved, (to.X_WS(model->shape(spare)) * p - from.X_WS(model->shape(spare)) * p).norm());
  }
  EXPECT_GT(moved, 0.02);
  EXPECT_LE(moved, ways.most_in_world(spare));
}

// Told what it carries, a controller has rows for it, and none for it; taking and leaving allocate nothing.
TEST(Carried, HasRowsOfItsOwn) {
  const auto model = load_model("configs/robots/frankie.yaml");
  ControllerParams params = plan_params(*model);
  params.collision.object = {true, 0.3, 0.02, 1.0};
  ControllerCore controller(model, params, 0.02);
  Kinematics kinematics(model);
  Observation o = at_ready(*model, kinematics);
  o.goal.X_WG.translation().x() += 0.5;
  const std::vector<ObjectShape> shapes{{"cup", make_box(0.06, 0.06, 0.06)}, {"wall", make_sphere(0.05)}};
  controller.reset(shapes);
  o.objects.resize(2);
  o.objects[0].X_WO = kinematics.X_WE() * in_hand();
  o.objects[1].X_WO = o.objects[0].X_WO;
  o.objects[1].X_WO.translation() += kinematics.X_WE().linear().col(2) * 0.2;  // 12 cm beyond the cup
  StepResult result;
  controller.prepare(result);
  const auto rows_of = [&](const std::string& name) {
    int count = 0;
    for (int row = 0; row < controller.problem().rows; ++row)
      count += controller.row_name(row).find(name) != std::string::npos ? 1 : 0;
    return count;
  };
  controller.step(o, result);
  EXPECT_EQ(rows_of("carried"), 0);
  EXPECT_GT(rows_of("cup"), 0);

  o.carried = Carried{0, in_hand(), kNoSupport};
  int counted = 0;
  {
    const NoAlloc guard;
    for (int i = 0; i < 40; ++i) {
      if (i == 20) o.carried.reset();
      if (i == 30) o.carried = Carried{0, in_hand(), 1};
      controller.step(o, result);
    }
    counted = guard.count();
  }
  EXPECT_EQ(counted, 0);  // under sanitizers always
  EXPECT_EQ(rows_of("object/wall/carried"), 1) << "its support";
  o.carried = Carried{0, in_hand(), kNoSupport};
  controller.step(o, result);
  EXPECT_EQ(rows_of("cup"), 0);
  EXPECT_EQ(rows_of("object/wall/carried"), 1);
  EXPECT_EQ(result.status, StepStatus::kSolved);

  o.carried->object = 2;
  controller.step(o, result);
  EXPECT_EQ(result.status, StepStatus::kInvalidInput) << "there is no such object";
  o.carried = Carried{0, in_hand(), kNoSupport};
  o.carried->X_EO.translation().x() = std::nan("");
  controller.step(o, result);
  EXPECT_EQ(result.status, StepStatus::kInvalidInput);
}

// A cup that stands on a table, which is measured 3 mm too high, and a goal below.
TEST(Carried, IsNotPressedIntoItsSupport) {
  const auto model = load_model("configs/robots/panda.yaml");
  ControllerParams params = plan_params(*model);
  params.collision.object = {true, 0.3, 0.03, 0.6};
  ControllerCore controller(model, params, 0.02);
  Kinematics kinematics(model);
  Observation o = at_ready(*model, kinematics);
  const Vector3 hand = kinematics.X_WE().translation();
  Isometry X_WO = Isometry::Identity();
  X_WO.translation() = hand - Vector3(0.0, 0.0, 0.05);
  const std::vector<ObjectShape> shapes{{"cup", make_box(0.06, 0.06, 0.06)}, {"table", make_box(0.8, 0.8, 0.02)}};
  controller.reset(shapes);
  o.objects.resize(2);
  o.objects[1].X_WO.translation() = hand - Vector3(0.0, 0.0, 0.09 - 0.003);
  o.carried = Carried{0, kinematics.X_WE().inverse(Eigen::Isometry) * X_WO, 1};
  o.goal.X_WG.translation() += Vector3(0.05, 0.1, -0.2);
  StepResult result;
  controller.prepare(result);
  double lowest = 0.0;
  for (int k = 0; k < 100; ++k) {
    controller.step(o, result);
    integrate(*model, o.base, o.q, result.command, 0.02);
    o.qdot = result.command;
    kinematics.update(o.base, o.q);
    lowest = std::min(lowest, (kinematics.X_WE() * o.carried->X_EO).translation().z() - X_WO.translation().z());
  }
  EXPECT_GT(lowest, -0.004);
}

}  // namespace
}  // namespace moma::test
