#include "controller/model/analytic_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace moma {
namespace {

double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
}

Isometry pose_within(std::mt19937_64& rng, double reach) {
  const auto u = [&] { return uniform(rng, -1.0, 1.0); };
  Isometry X = Isometry::Identity();
  const double w = u(), x = u(), y = u(), z = u();
  X.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  for (int i = 0; i < 3; ++i) X.translation()[i] = reach * u();
  return X;
}

Shape solid(ShapeKind kind, double x, double y, double z) {
  Shape shape;
  shape.kind = kind;
  shape.size = {x, y, z};
  return shape;
}

// Largest n . p over the solid: what bounds a distance from below without looking for nearest points.
double support(const Shape& shape, const Isometry& X, const Vector3& n_W) {
  const Vector3 n = X.linear().transpose() * n_W;
  double reach = 0.0;
  if (shape.kind == ShapeKind::kBox) reach = 0.5 * n.cwiseAbs().dot(shape.size);
  if (shape.kind == ShapeKind::kCylinder)
    reach = shape.size.x() * std::hypot(n.x(), n.y()) + 0.5 * shape.size.y() * std::abs(n.z());
  if (shape.kind == ShapeKind::kCapsule) reach = shape.size.x() + 0.5 * shape.size.y() * std::abs(n.z());
  return n_W.dot(X.translation()) + reach;
}

struct Pair {
  Shape capsule, other;
  Isometry X1, X2;
};

Pair random_pair(std::mt19937_64& rng, int i) {
  const auto size = [&] { return uniform(rng, 0.02, 0.5); };
  Pair p;
  p.capsule = solid(ShapeKind::kCapsule, uniform(rng, 0.01, 0.1), i % 7 == 0 ? 0.0 : size(), 0.0);
  const double x = size(), y = size(), z = size();
  p.other = i % 2 == 0 ? solid(ShapeKind::kBox, x, y, z) : solid(ShapeKind::kCylinder, 0.5 * x, y, 0.0);
  p.X1 = pose_within(rng, 0.6);
  p.X2 = pose_within(rng, 0.6);
  if (i % 5 == 0) p.X1.linear() = p.X2.linear();  // axes along edges and faces
  return p;
}

// The distance is between the separation of the two along n, and the length between two points of theirs: where
// these meet, all three are right.
TEST(CapsuleDistance, IsCertifiedFromBothSides) {
  std::mt19937_64 rng(11);
  int outside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Pair p = random_pair(rng, i);
    const auto found = capsule_distance(p.capsule, p.X1, p.other, p.X2);
    if (!found) continue;
    ++outside;
    EXPECT_NEAR(found->n_W.norm(), 1.0, 1e-12);
    const double apart = -support(p.capsule, p.X1, -found->n_W) - support(p.other, p.X2, found->n_W);
    EXPECT_NEAR(apart, found->d, 1e-9) << "pair " << i << ": n does not separate by d";
    EXPECT_LT((found->p_first_W - found->p_second_W - found->d * found->n_W).norm(), 1e-12) << "pair " << i;
    EXPECT_NEAR(point_distance(p.capsule, p.X1.inverse() * found->p_first_W).d, 0.0, 1e-9) << "pair " << i;
    EXPECT_NEAR(point_distance(p.other, p.X2.inverse() * found->p_second_W).d, 0.0, 1e-9) << "pair " << i;
  }
  EXPECT_GT(outside, 10000);
}

TEST(CapsuleDistance, LeavesOutOnlyAxesInside) {
  std::mt19937_64 rng(12);
  for (int i = 0; i < 5000; ++i) {
    const Pair p = random_pair(rng, i);
    if (capsule_distance(p.capsule, p.X1, p.other, p.X2)) continue;
    double least = 1.0;
    for (int k = -200; k <= 200; ++k) {
      const Vector3 p_W = p.X1 * Vector3(0.0, 0.0, 0.5 * p.capsule.size.y() * k / 200.0);
      least = std::min(least, point_distance(p.other, p.X2.inverse() * p_W).d);
    }
    EXPECT_LT(least, 2e-3) << "pair " << i << " has its axis outside";
  }
}

TEST(CapsuleDistance, AlongAFaceTheMiddleIsTaken) {
  const Shape capsule = solid(ShapeKind::kCapsule, 0.05, 0.2, 0.0), box = solid(ShapeKind::kBox, 1.0, 1.0, 1.0);
  Isometry X1 = Isometry::Identity();
  X1.translation() = Vector3(0.8, 0.1, 0.0);
  const auto found = capsule_distance(capsule, X1, box, Isometry::Identity());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->d, 0.25, 1e-15);
  EXPECT_LT((found->p_second_W - Vector3(0.5, 0.1, 0.0)).norm(), 1e-12);
  EXPECT_LT((found->n_W - Vector3::UnitX()).norm(), 1e-15);
}

TEST(CapsuleDistance, OtherPairsAreLeftToOthers) {
  const Shape capsule = solid(ShapeKind::kCapsule, 0.05, 0.2, 0.0), sphere = solid(ShapeKind::kSphere, 0.1, 0.0, 0.0);
  Isometry X = Isometry::Identity();
  X.translation().x() = 1.0;
  EXPECT_FALSE(capsule_distance(capsule, X, sphere, Isometry::Identity()));
  EXPECT_FALSE(capsule_distance(sphere, X, capsule, Isometry::Identity()));
}

}  // namespace
}  // namespace moma
