#include "controller/model/proximity.h"

#include <gtest/gtest.h>

#include <cstring>
#include <numbers>

#include "tests/support/finite_difference.h"
#include "tests/support/no_alloc.h"
#include "tests/support/robots.h"
#include "tests/support/shapes.h"

namespace moma {
namespace {

using test::make_box;
using test::make_capsule;
using test::make_cylinder;
using test::make_sphere;
using test::placed;

// One scene around a robot: objects of every kind at random places.
struct RobotAndObjects {
  std::vector<ObjectShape> shapes;
  std::vector<ObjectState> states;
};

RobotAndObjects random_scene(std::mt19937& engine, int count, double spread) {
  RobotAndObjects scene;
  for (int i = 0; i < count; ++i) {
    scene.shapes.push_back({"object" + std::to_string(i), test::random_shape(static_cast<ShapeKind>(i % 5), engine)});
    ObjectState state;
    state.X_WO = test::random_pose(engine, spread);
    state.X_WO.translation().z() += 0.5;
    scene.states.push_back(state);
  }
  return scene;
}

class ProximityOf : public testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const RobotModel> model_ = test::load_model(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Robots, ProximityOf, testing::ValuesIn(test::all_robots()),
                         [](const auto& robot) { return test::test_name(robot.param); });

// The prefilter may drop no pair, and the order is fixed: every pair is measured here one by one.
TEST_P(ProximityOf, FindsWhatMeasuringEveryPairFinds) {
  std::mt19937 engine(31);
  Kinematics kinematics(model_);
  Proximity proximity(model_);
  const RobotAndObjects scene = random_scene(engine, 10, 1.2);
  proximity.set_objects(scene.shapes);
  int found = 0;
  for (int trial = 0; trial < 3; ++trial) {
    test::State state = test::random_state(*model_, engine);
    state.base = 0.2 * state.base;
    kinematics.update(state.base, state.q);
    const auto pairs = proximity.query(kinematics, scene.states, {0.3, 0.2, 0.15});
    std::size_t k = 0;
    const auto expect = [&](PairKind kind, int first, int second, const Distance& exact, double range) {
      const bool present =
          k < pairs.size() && pairs[k].kind == kind && pairs[k].first == first && pairs[k].second == second;
      EXPECT_EQ(present, exact.d < range) << "kind " << static_cast<int>(kind) << " " << first << " " << second;
      if (!present) return;
      EXPECT_EQ(pairs[k].distance.d, exact.d);
      EXPECT_EQ(pairs[k].distance.n_W, exact.n_W);
      ++k;
      ++found;
    };
    const int count = static_cast<int>(model_->shapes.size());
    const auto& shapes = model_->shapes;
    for (int i = 0; i < count; ++i) {
      const CollisionShape& s = shapes[static_cast<std::size_t>(i)];
      for (int j = 0; j < 10; ++j) {
        const auto o = static_cast<std::size_t>(j);
        expect(PairKind::kObject, i, j,
               shape_distance(s.shape, kinematics.X_WS(s), scene.shapes[o].shape, scene.states[o].X_WO), 0.3);
      }
    }
    for (int i = 0; i < count; ++i) {
      const CollisionShape& s = shapes[static_cast<std::size_t>(i)];
      Distance floor;
      floor.d = s.rigid_with_base ? 1.0 : lowest_point(s.shape, kinematics.X_WS(s));
      expect(PairKind::kFloor, i, -1, floor, 0.2);
    }
    for (const SelfPair& pair : model_->self_pairs) {
      if (!pair.row) continue;
      const CollisionShape& a = shapes[static_cast<std::size_t>(pair.first)];
      const CollisionShape& b = shapes[static_cast<std::size_t>(pair.second)];
      expect(PairKind::kSelf, pair.first, pair.second,
             shape_distance(a.shape, kinematics.X_WS(a), b.shape, kinematics.X_WS(b)), 0.15);
    }
    EXPECT_EQ(k, pairs.size());
  }
  EXPECT_GT(found, 3);
}

TEST_P(ProximityOf, SameInputSameBitsWhateverCameBefore) {
  std::mt19937 engine(32);
  const RobotAndObjects scene = random_scene(engine, 10, 0.8);
  const test::State a = test::random_state(*model_, engine);
  const test::State b = test::random_state(*model_, engine);
  Kinematics kinematics(model_);
  Proximity used(model_);
  Proximity fresh(model_);
  used.set_objects(scene.shapes);
  fresh.set_objects(scene.shapes);
  const ProximityRanges ranges{0.4, 0.2, 0.2};
  for (int i = 0; i < 5; ++i) {
    kinematics.update(Vector3::Zero(), i % 2 == 0 ? b.q : VectorX(0.5 * b.q));
    used.query(kinematics, scene.states, ranges);
  }
  kinematics.update(Vector3::Zero(), a.q);
  const auto first = used.query(kinematics, scene.states, ranges);
  const auto second = fresh.query(kinematics, scene.states, ranges);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(0, std::memcmp(&first[i].distance, &second[i].distance, sizeof(Distance))) << i;
    EXPECT_EQ(first[i].first, second[i].first);
  }
}

TEST_P(ProximityOf, QueryDoesNotAllocate) {
  std::mt19937 engine(33);
  const RobotAndObjects scene = random_scene(engine, 10, 0.6);
  Kinematics kinematics(model_);
  Proximity proximity(model_);
  proximity.set_objects(scene.shapes);
  std::vector<test::State> states;
  for (int i = 0; i < 20; ++i) states.push_back(test::random_state(*model_, engine));
  std::size_t pairs = 0;
  const test::NoAlloc guard;  // from the first query on: no warm-up
  for (const test::State& state : states) {
    kinematics.update(0.1 * state.base, state.q);
    pairs += proximity.query(kinematics, scene.states, {0.5, 0.3, 0.3}).size();
  }
  EXPECT_EQ(guard.count(), 0);
  EXPECT_GT(pairs, 20U);
}

// Each pair's normal and points give the derivative of its distance, as the controller's rows use them.
TEST_P(ProximityOf, NormalsAndPointsGiveTheDerivative) {
  std::mt19937 engine(34);
  const RobotAndObjects scene = random_scene(engine, 10, 0.8);
  Kinematics kinematics(model_);
  Proximity proximity(model_);
  proximity.set_objects(scene.shapes);
  const int n = model_->num_velocities();
  Matrix3X J1(3, n);
  Matrix3X J2(3, n);
  int checked = 0;
  int agree = 0;
  for (int trial = 0; trial < 4; ++trial) {
    test::State state = test::random_state(*model_, engine);
    state.base = 0.2 * state.base;
    kinematics.update(state.base, state.q);
    const auto span = proximity.query(kinematics, scene.states, {0.3, 0.2, 0.1});
    const std::vector<ProximityPair> pairs(span.begin(), span.end());
    for (const ProximityPair& pair : pairs) {
      if (pair.distance.d < 0.01) continue;
      const CollisionShape& a = model_->shapes[static_cast<std::size_t>(pair.first)];
      kinematics.update(state.base, state.q);
      kinematics.point_jacobian(a.link, pair.distance.p_first_W, J1);
      if (pair.kind == PairKind::kSelf) {
        kinematics.point_jacobian(model_->shapes[static_cast<std::size_t>(pair.second)].link, pair.distance.p_second_W,
                                  J2);
        J1 -= J2;
      }
      const VectorX gradient = J1.transpose() * pair.distance.n_W;
      const VectorX v = VectorX::Random(n);
      const double h = 2e-4;
      const auto measure = [&](double time) {
        const test::State s = test::drive(*model_, state, time * v);
        kinematics.update(s.base, s.q);
        if (pair.kind == PairKind::kFloor) return lowest_point(a.shape, kinematics.X_WS(a));
        const auto j = static_cast<std::size_t>(pair.second);
        if (pair.kind == PairKind::kObject)
          return shape_distance(a.shape, kinematics.X_WS(a), scene.shapes[j].shape, scene.states[j].X_WO).d;
        const CollisionShape& b = model_->shapes[j];
        return shape_distance(a.shape, kinematics.X_WS(a), b.shape, kinematics.X_WS(b)).d;
      };
      const double numeric = (measure(h) - measure(-h)) / (2.0 * h);
      ++checked;
      // Where a face lies flat on a face the nearest point jumps, and the two sides of the difference disagree.
      if (std::abs(gradient.dot(v) - numeric) < 0.02 + 0.02 * std::abs(numeric)) ++agree;
    }
  }
  EXPECT_GT(checked, 3);
  EXPECT_GE(agree, checked - checked / 20) << agree << " of " << checked;
}

TEST(Proximity, RangesSwitchKindsOff) {
  const auto model = test::load_model("configs/robots/frankie.yaml");
  Kinematics kinematics(model);
  Proximity proximity(model);
  const std::vector<ObjectShape> shapes{{"ball", make_sphere(0.1)}};
  proximity.set_objects(shapes);
  std::vector<ObjectState> states(1);
  states[0].X_WO.translation() = Vector3(0.6, 0, 0.2);
  EXPECT_EQ(proximity.query(kinematics, states, {0.3, -1, -1}).size(), 1U);
  EXPECT_EQ(proximity.query(kinematics, states, {-1, -1, -1}).size(), 0U);
  states[0].visible = false;
  EXPECT_EQ(proximity.query(kinematics, states, {0.3, -1, -1}).size(), 0U);
  for (const ProximityPair& pair : proximity.query(kinematics, states, {-1, -1, 0.2})) {
    EXPECT_EQ(pair.kind, PairKind::kSelf);
    EXPECT_LT(pair.first, pair.second);
  }
  EXPECT_GT(proximity.query(kinematics, states, {-1, 2.0, -1}).size(), 5U);
  proximity.set_objects({});
  EXPECT_EQ(proximity.query(kinematics, {}, {0.3, -1, -1}).size(), 0U);
}

TEST(Proximity, SurvivesNonsense) {
  const auto model = test::load_model("configs/robots/panda.yaml");
  Kinematics kinematics(model);
  Proximity proximity(model);
  std::mt19937 engine(35);
  RobotAndObjects scene = random_scene(engine, 10, 0.3);
  proximity.set_objects(scene.shapes);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, 1e300}) {
    std::vector<ObjectState> states = scene.states;
    for (ObjectState& state : states) state.X_WO.translation().x() = bad;
    EXPECT_TRUE(proximity.query(kinematics, states, {}).empty());
    states = scene.states;
    for (ObjectState& state : states) state.X_WO.linear()(0, 0) = bad;
    for (const ProximityPair& pair : proximity.query(kinematics, states, {}))
      EXPECT_TRUE(std::isfinite(pair.distance.d) && pair.distance.n_W.allFinite());
    kinematics.update(Vector3::Zero(), VectorX::Constant(7, bad));
    for (const ProximityPair& pair : proximity.query(kinematics, scene.states, {0.3, 0.1, 0.1}))
      EXPECT_TRUE(pair.distance.n_W.allFinite());
    kinematics.update(Vector3::Zero(), model->ready);
  }
}

}  // namespace
}  // namespace moma
