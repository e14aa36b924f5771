#include "controller/model/shape_ways.h"

#include <gtest/gtest.h>

#include "controller/model/kinematics.h"
#include "tests/support/finite_difference.h"
#include "tests/support/robots.h"

namespace moma {
namespace {

class ShapeWaysOf : public testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const RobotModel> model_ = test::load_model(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Robots, ShapeWaysOf, testing::ValuesIn(test::all_robots()),
                         [](const auto& robot) { return test::test_name(robot.param); });

// Points of the surface, in the shape's frame.
std::vector<Vector3> points_of(const Shape& shape, std::mt19937& engine) {
  std::normal_distribution<double> normal;
  std::vector<Vector3> points;
  for (int k = 0; k < 5; ++k) {
    const Vector3 n = Vector3(normal(engine), normal(engine), normal(engine)).normalized();
    points.push_back(support_point(shape, Isometry::Identity(), n));
  }
  return points;
}

// From one configuration to another, near or far, and halfway there: no point moves more than what is said.
TEST_P(ShapeWaysOf, AreNeverShorterThanWhatPointsMove) {
  const RobotModel& model = *model_;
  ShapeWays ways(model);
  std::mt19937 engine(41);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Kinematics before(model_), after(model_);
  const int dof = model.base_dof();
  std::vector<std::vector<Vector3>> points;
  for (const CollisionShape& shape : model.shapes) points.push_back(points_of(shape.shape, engine));
  double used_world = 0.0, used_height = 0.0, used_pair = 0.0;  // shares of what is said
  for (int trial = 0; trial < 80; ++trial) {
    const test::State a = test::random_state(model, engine);
    const double part = trial % 2 == 0 ? 0.02 : 1.0;
    const VectorX target = test::random_state(model, engine).q;
    VectorX gone = VectorX::Zero(model.num_velocities()), v = gone;
    for (int i = 0; i < dof; ++i) v[i] = trial % 3 == 0 ? 0.0 : part * uniform(engine);
    for (int i = 0; i < model.num_joints(); ++i)
      if (trial % 5 < 2 || i == trial % model.num_joints()) v[dof + i] = part * (target[i] - a.q[i]);
    before.update(a.base, a.q);
    ways.begin(before);
    ways.limit(v.cwiseAbs());
    test::State b = a;
    const double time = trial % 4 == 0 ? 0.5 : 1.0;
    integrate(model, b.base, b.q, v, time);
    gone = time * v.cwiseAbs();
    after.update(b.base, b.q);
    const auto share = [](double moved, double way) { return way > 1e-9 ? moved / way : moved; };
    for (std::size_t s = 0; s < model.shapes.size(); ++s) {
      EXPECT_LE(ways.in_world(static_cast<int>(s), gone), ways.most_in_world(static_cast<int>(s)) + 1e-12);
      const Isometry X_a = before.X_WS(model.shapes[s]), X_b = after.X_WS(model.shapes[s]);
      for (const Vector3& p : points[s]) {
        const Vector3 moved = X_b * p - X_a * p;
        used_world = std::max(used_world, share(moved.norm(), ways.in_world(static_cast<int>(s), gone)));
        used_height = std::max(used_height, share(std::abs(moved.z()), ways.in_height(static_cast<int>(s), gone)));
      }
    }
    for (std::size_t k = 0; k < model.self_pairs.size(); ++k) {
      const auto i = static_cast<std::size_t>(model.self_pairs[k].first);
      const auto j = static_cast<std::size_t>(model.self_pairs[k].second);
      for (const Vector3& p : points[i]) {
        for (const Vector3& r : points[j]) {
          const double from = (before.X_WS(model.shapes[i]) * p - before.X_WS(model.shapes[j]) * r).norm();
          const double to = (after.X_WS(model.shapes[i]) * p - after.X_WS(model.shapes[j]) * r).norm();
          const double way = ways.between(model.self_pairs[k].first, model.self_pairs[k].second, gone);
          used_pair = std::max(used_pair, share(std::abs(to - from), way));
        }
      }
    }
  }
  // Never more than all of it; and much of it, or it would leave nothing out.
  for (const double used : {used_world, used_height, used_pair}) EXPECT_LE(used, 1.0 + 1e-9);
  EXPECT_GT(used_world, 0.7);
  EXPECT_GT(used_height, 0.3);
  if (!model.self_pairs.empty()) {
    EXPECT_GT(used_pair, 0.3);
  }
}

}  // namespace
}  // namespace moma
