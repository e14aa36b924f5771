// Distances of single pairs of shapes against closed forms, and against the support functions of the solids.
#include <gtest/gtest.h>

#include <numbers>

#include "controller/model/proximity.h"
#include "tests/support/shapes.h"

namespace moma {
namespace {

using test::make_box;
using test::make_capsule;
using test::make_cylinder;
using test::make_sphere;
using test::placed;

constexpr double kHalfPi = std::numbers::pi / 2.0;

void expect_distance(const Distance& found, double d, const Vector3& n, double tolerance = 1e-12) {
  EXPECT_NEAR(found.d, d, tolerance);
  EXPECT_LT((found.n_W - n).norm(), 1e-6 + tolerance) << found.n_W.transpose();
  EXPECT_LT((found.p_first_W - found.p_second_W - found.d * found.n_W).norm(), 1e-5);
}

TEST(ShapeDistance, Spheres) {
  const Shape a = make_sphere(0.1), b = make_sphere(0.2);
  expect_distance(shape_distance(a, placed({1, 0, 0}), b, placed({0, 0, 0})), 0.7, Vector3::UnitX());
  expect_distance(shape_distance(a, placed({0, -0.15, 0}), b, placed({0, 0, 0})), -0.15, -Vector3::UnitY());
  EXPECT_NEAR(shape_distance(a, placed({0, 0, 0}), b, placed({0, 0, 0})).d, -0.3, 1e-12);
}

TEST(ShapeDistance, SphereAndBox) {
  const Shape ball = make_sphere(0.1), box = make_box(0.4, 0.6, 0.8);
  const Isometry X = placed({0, 0, 0});
  expect_distance(shape_distance(ball, placed({0.5, 0.1, 0.1}), box, X), 0.2, Vector3::UnitX());
  const Vector3 diagonal = Vector3(0.3, 0.4, 0).normalized();
  expect_distance(shape_distance(ball, placed({0.5, 0.7, 0}), box, X), 0.4, diagonal);  // an edge
  expect_distance(shape_distance(ball, placed({0.2 + 0.2, 0.3 + 0.2, 0.4 + 0.1}), box, X), 0.2,
                  Vector3(0.2, 0.2, 0.1) / 0.3);                                                   // a corner
  expect_distance(shape_distance(ball, placed({-0.15, 0, 0}), box, X), -0.15, -Vector3::UnitX());  // inside
  expect_distance(shape_distance(box, X, ball, placed({0.5, 0.1, 0.1})), 0.2, -Vector3::UnitX());  // other way round
}

TEST(ShapeDistance, CrossingCapsulesHaveANormal) {
  const Shape a = make_capsule(0.05, 1.0), b = make_capsule(0.08, 1.0);
  const Distance crossing =
      shape_distance(a, placed({0, 0, 0}, {kHalfPi, 0, 0}), b, placed({0, 0, 0}, {0, kHalfPi, 0}));
  EXPECT_NEAR(crossing.d, -0.13, 1e-12);
  EXPECT_NEAR(std::abs(crossing.n_W.z()), 1.0, 1e-9);
  // A hair's breadth either side of crossing: continuous, with the sign of that side.
  for (const double offset : {1e-9, -1e-9, 1e-6, -1e-6, 0.01, -0.01}) {
    const Distance near =
        shape_distance(a, placed({0, 0, offset}, {kHalfPi, 0, 0}), b, placed({0, 0, 0}, {0, kHalfPi, 0}));
    expect_distance(near, -0.13 + std::abs(offset), (offset > 0 ? 1.0 : -1.0) * Vector3::UnitZ(), 1e-9);
  }
  const Distance in_line = shape_distance(a, placed({0, 0, 0.2}), b, placed({0, 0, 0}));
  EXPECT_NEAR(in_line.d, -0.13, 1e-12);
  EXPECT_NEAR(in_line.n_W.norm(), 1.0, 1e-12);
  EXPECT_NEAR(in_line.n_W.z(), 0.0, 1e-9);
}

TEST(ShapeDistance, ParallelCapsules) {
  const Shape a = make_capsule(0.05, 1.0), b = make_capsule(0.05, 0.4);
  expect_distance(shape_distance(a, placed({0.3, 0, 0}), b, placed({0, 0, 0.1})), 0.2, Vector3::UnitX());
  const Distance beyond = shape_distance(a, placed({0, 0, 0}), b, placed({0, 0, 1.0}));
  expect_distance(beyond, 0.2, -Vector3::UnitZ());
}

TEST(ShapeDistance, SphereInsideACylinderNearItsCap) {
  const Shape ball = make_sphere(0.05), cylinder = make_cylinder(0.3, 0.4);
  expect_distance(shape_distance(ball, placed({0.05, 0, 0.18}), cylinder, placed({0, 0, 0})), -0.07, Vector3::UnitZ());
  expect_distance(shape_distance(ball, placed({0.28, 0, 0.1}), cylinder, placed({0, 0, 0})), -0.07, Vector3::UnitX());
  expect_distance(shape_distance(ball, placed({0.6, 0, 0.6}), cylinder, placed({0, 0, 0})), 0.45, Vector3(3, 0, 4) / 5);
}

TEST(ShapeDistance, LowestPointIsTheSupportDownwards) {
  std::mt19937 engine(41);
  for (int i = 0; i < 500; ++i) {
    const Shape shape = test::random_shape(static_cast<ShapeKind>(i % 5), engine);
    Isometry X = test::random_pose(engine, 1.0);
    if (i % 7 == 0) X.linear() = Matrix3::Identity();
    Vector3 p;
    const double z = lowest_point(shape, X, &p);
    EXPECT_NEAR(z, -test::support(shape, X, -Vector3::UnitZ()), 1e-12) << to_string(shape.kind);
    EXPECT_EQ(z, p.z());
    EXPECT_NEAR(z, lowest_point(shape, X), 0.0);
    EXPECT_LE((p - X.translation()).norm(), bounding_radius(shape) + 1e-12);
  }
}

// For every pair of kinds, apart and overlapping: the gap along the reported normal is the reported distance, and no
// other direction gives a wider gap (a narrower overlap). Together these are the definition of signed distance.
class EveryPairOfKinds : public testing::TestWithParam<std::tuple<int, int>> {};

INSTANTIATE_TEST_SUITE_P(Kinds, EveryPairOfKinds, testing::Combine(testing::Range(0, 5), testing::Range(0, 5)),
                         [](const auto& pair) {
                           const auto name = [](int kind) {
                             return std::string(to_string(static_cast<ShapeKind>(kind)));
                           };
                           return name(std::get<0>(pair.param)) + "_" + name(std::get<1>(pair.param));
                         });

TEST_P(EveryPairOfKinds, IsTheSignedDistance) {
  std::mt19937 engine(42);
  const auto kind1 = static_cast<ShapeKind>(std::get<0>(GetParam()));
  const auto kind2 = static_cast<ShapeKind>(std::get<1>(GetParam()));
  int apart = 0;
  int deep = 0;
  double worst = 0.0;
  const double tolerance = kind1 == ShapeKind::kCylinder && kind2 == ShapeKind::kCylinder ? 5e-5 : 1e-5;
  for (int i = 0; i < 400; ++i) {
    const Shape a = test::random_shape(kind1, engine);
    const Shape b = test::random_shape(kind2, engine);
    const Isometry X1 = test::random_pose(engine, 0.3);
    const Isometry X2 = test::random_pose(engine, 0.3);
    const Distance found = shape_distance(a, X1, b, X2);
    (found.d > 0.0 ? apart : deep)++;
    ASSERT_NEAR(found.n_W.norm(), 1.0, 1e-9);
    const double along = test::gap_along(a, X1, b, X2, found.n_W);
    worst = std::max(worst, std::abs(along - found.d));
    EXPECT_NEAR(along, found.d, tolerance) << i;
    EXPECT_LT((found.p_first_W - found.p_second_W - found.d * found.n_W).norm(), 2e-4) << i;
    for (int k = 0; k < 200; ++k) {
      const Vector3 n = (found.n_W + (k % 2 == 0 ? 0.3 : 2.0) * Vector3::Random()).normalized();
      EXPECT_LT(test::gap_along(a, X1, b, X2, n), found.d + tolerance) << i;
    }
    const Distance swapped = shape_distance(b, X2, a, X1);
    EXPECT_NEAR(swapped.d, found.d, tolerance) << i;
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(deep, 20);
  RecordProperty("worst", std::to_string(worst));
}

}  // namespace
}  // namespace moma
