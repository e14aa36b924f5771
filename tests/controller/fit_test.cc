#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "controller/fit/enclosing.h"
#include "controller/fit/partition.h"
#include "controller/fit/placed.h"
#include "fit_oracle.h"

namespace moma {
namespace {

using fit::Placed;
using fit::Triangles;

constexpr double kPi = std::numbers::pi;

Isometry random_pose(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  Isometry X = Isometry::Identity();
  X.linear() = Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine))
                   .normalized()
                   .toRotationMatrix();
  X.translation() = 0.2 * Vector3(normal(engine), normal(engine), normal(engine));
  return X;
}

Triangles moved(Triangles triangles, const Isometry& X) {
  for (fit::Triangle& t : triangles)
    for (Vector3& p : t) p = X * p;
  return triangles;
}

void add_quad(Triangles& triangles, const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  triangles.push_back({a, b, c});
  triangles.push_back({a, c, d});
}

// Twelve triangles, as large as they can be.
Triangles box_mesh(const Vector3& low, const Vector3& high) {
  const auto at = [&](int x, int y, int z) {
    return Vector3(x != 0 ? high.x() : low.x(), y != 0 ? high.y() : low.y(), z != 0 ? high.z() : low.z());
  };
  Triangles t;
  for (int s = 0; s < 2; ++s) {
    add_quad(t, at(s, 0, 0), at(s, 1, 0), at(s, 1, 1), at(s, 0, 1));
    add_quad(t, at(0, s, 0), at(1, s, 0), at(1, s, 1), at(0, s, 1));
    add_quad(t, at(0, 0, s), at(1, 0, s), at(1, 1, s), at(0, 1, s));
  }
  return t;
}

// A capsule along z by rings; a sphere where the length is 0.
Triangles capsule_mesh(double radius, double length) {
  constexpr int kRings = 16;  // even: the middle gap is the cylinder
  constexpr int kAround = 32;
  const auto at = [&](int ring, int around) {
    const double polar = kPi * ring / (kRings - 1);
    const double turn = 2 * kPi * around / kAround;
    return Vector3(radius * std::sin(polar) * std::cos(turn), radius * std::sin(polar) * std::sin(turn),
                   radius * std::cos(polar) + (ring < kRings / 2 ? 0.5 : -0.5) * length);
  };
  Triangles t;
  for (int i = 0; i + 1 < kRings; ++i)
    for (int j = 0; j < kAround; ++j) add_quad(t, at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
  return t;
}

double furthest_outside(const Triangles& surface, const std::vector<Placed>& shapes, double spacing = 0.02) {
  double most = 0.0;
  for (const fit::Triangle& t : surface) {
    for (const Vector3& p : test::points_on(t[0], t[1], t[2], spacing)) {
      double least = std::numeric_limits<double>::infinity();
      for (const Placed& s : shapes)
        least = std::min(least, test::outside(s.solid.shape, s.position, test::rotation_of(s.rpy), p));
      most = std::max(most, least);
    }
  }
  return most;
}

std::vector<Placed> fitted(const Triangles& surface, int max_shapes = 3, const fit::Kinds& kinds = {}) {
  return fit::fit_surfaces({surface}, {max_shapes, kinds});
}

TEST(Fit, ATurnedBoxIsFound) {
  std::mt19937_64 engine(1);
  for (int i = 0; i < 4; ++i) {
    const Vector3 half(0.05 + 0.02 * i, 0.11, 0.2);
    const Triangles mesh = moved(box_mesh(-half, half), random_pose(engine));
    const std::vector<Placed> shapes = fitted(mesh);
    ASSERT_EQ(shapes.size(), 1U);
    EXPECT_EQ(shapes[0].solid.shape.kind, ShapeKind::kBox);
    const double ratio = shapes[0].solid.shape.size.prod() / (8 * half.prod());
    EXPECT_GT(ratio, 1.0);
    EXPECT_LT(ratio, 1.01) << i;
    EXPECT_EQ(furthest_outside(mesh, shapes), 0.0);
  }
}

TEST(Fit, ATurnedCapsuleIsFound) {
  std::mt19937_64 engine(2);
  for (int i = 0; i < 3; ++i) {
    const double radius = 0.04 + 0.01 * i;
    const double length = 0.3 - 0.04 * i;
    const Isometry X = random_pose(engine);
    const Triangles mesh = moved(capsule_mesh(radius, length), X);
    const std::vector<Placed> shapes = fitted(mesh);
    ASSERT_EQ(shapes.size(), 1U);
    ASSERT_EQ(shapes[0].solid.shape.kind, ShapeKind::kCapsule);
    const Vector3& size = shapes[0].solid.shape.size;
    EXPECT_NEAR(size.x(), radius, 0.005 * radius) << i;
    EXPECT_NEAR(size.y() + 2 * size.x(), length + 2 * radius, 0.005 * length) << i;
    EXPECT_LT((shapes[0].position - X.translation()).norm(), 5e-4);
    EXPECT_GT(std::abs(test::rotation_of(shapes[0].rpy).col(2).dot(X.linear().col(2))), 0.99999);
    EXPECT_EQ(furthest_outside(mesh, shapes), 0.0);
  }
}

TEST(Fit, ASphereIsFound) {
  std::mt19937_64 engine(3);
  for (int i = 0; i < 3; ++i) {
    const double radius = 0.03 + 0.05 * i;
    const Isometry X = random_pose(engine);
    const Triangles mesh = moved(capsule_mesh(radius, 0.0), X);
    const std::vector<Placed> shapes = fitted(mesh);
    ASSERT_EQ(shapes.size(), 1U);
    ASSERT_EQ(shapes[0].solid.shape.kind, ShapeKind::kSphere);
    EXPECT_NEAR(shapes[0].solid.shape.size.x(), radius, 0.003 * radius + 1e-4);
    EXPECT_LT((shapes[0].position - X.translation()).norm(), 5e-4);
    EXPECT_EQ(furthest_outside(mesh, shapes), 0.0);
  }
}

// A body of two long boxes with triangles from end to end: one shape would be mostly air, and no triangle may be left
// uncovered between two shapes.
TEST(Fit, AnAngleIsTakenApart) {
  std::mt19937_64 engine(4);
  for (int i = 0; i < 3; ++i) {
    Triangles mesh = box_mesh({0, 0, 0}, {0.4, 0.06, 0.05});
    const Triangles other = box_mesh({0, 0, 0}, {0.05, 0.06, 0.3});
    mesh.insert(mesh.end(), other.begin(), other.end());
    mesh = moved(mesh, random_pose(engine));
    const std::vector<Placed> one = fitted(mesh, 1);
    const std::vector<Placed> two = fitted(mesh, 2);
    ASSERT_EQ(one.size(), 1U);
    ASSERT_EQ(two.size(), 2U);
    std::vector<fit::Solid> solids{two[0].solid, two[1].solid};
    const double body = 0.06 * (0.4 * 0.05 + 0.05 * 0.25);
    EXPECT_LT(fit::union_volume(solids, 20000), 1.35 * body);
    EXPECT_GT(fit::volume(one[0].solid.shape), 1.8 * body);
    EXPECT_EQ(furthest_outside(mesh, one), 0.0);
    EXPECT_EQ(furthest_outside(mesh, two), 0.0);
  }
}

// Thin in the middle: two cuts at once.
TEST(Fit, ADumbbellIsTakenApart) {
  Triangles mesh = moved(capsule_mesh(0.08, 0.0), Isometry(Eigen::Translation3d(0, 0, 0.25)));
  const Triangles other = moved(capsule_mesh(0.08, 0.0), Isometry(Eigen::Translation3d(0, 0, -0.25)));
  const Triangles rod = capsule_mesh(0.02, 0.4);
  mesh.insert(mesh.end(), other.begin(), other.end());
  mesh.insert(mesh.end(), rod.begin(), rod.end());
  const std::vector<Placed> shapes = fitted(mesh, 3);
  EXPECT_EQ(shapes.size(), 3U);
  std::vector<fit::Solid> solids;
  for (const Placed& s : shapes) solids.push_back(s.solid);
  const double body = 2 * 4.0 / 3.0 * kPi * 0.08 * 0.08 * 0.08 + kPi * 0.02 * 0.02 * 0.34;
  EXPECT_LT(fit::union_volume(solids, 20000), 1.3 * body);
  EXPECT_EQ(furthest_outside(mesh, shapes), 0.0);
}

// Random heaps of triangles, with every choice of kinds and numbers.
TEST(Fit, EnclosesWhateverThereIs) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 12; ++i) {
    Triangles mesh;
    const Vector3 spread = Vector3(0.3, 0.1, 0.05 * (i % 3));  // flat now and then
    for (int k = 0; k < 3 + 4 * i; ++k) {
      fit::Triangle t;
      for (Vector3& p : t) p = spread.cwiseProduct(Vector3(normal(engine), normal(engine), normal(engine)));
      mesh.push_back(t);
    }
    mesh = moved(mesh, random_pose(engine));
    const fit::Kinds kinds{i % 4 == 0, i % 4 != 1, i % 4 != 2};
    const std::vector<Placed> shapes = fitted(mesh, 1 + i % 4, kinds);
    EXPECT_LE(shapes.size(), 1U + static_cast<std::size_t>(i % 4));
    EXPECT_EQ(furthest_outside(mesh, shapes, 0.01), 0.0) << i;
    for (const Placed& s : shapes) {
      EXPECT_TRUE(kinds.sphere || s.solid.shape.kind != ShapeKind::kSphere);
      EXPECT_TRUE(kinds.capsule || s.solid.shape.kind != ShapeKind::kCapsule);
      EXPECT_TRUE(kinds.box || s.solid.shape.kind != ShapeKind::kBox);
    }
  }
}

TEST(Fit, PointsLinesAndPlanes) {
  const Vector3 p(0.1, 0.2, 0.3);
  const Triangles point{{p, p, p}};
  const Triangles line{{p, p + Vector3(0.2, 0, 0.1), p + Vector3(0.1, 0, 0.05)}};
  Triangles plane;
  add_quad(plane, p, p + Vector3(0.3, 0, 0), p + Vector3(0.3, 0.2, 0), p + Vector3(0, 0.2, 0));
  const Triangles speck = moved(box_mesh({0, 0, 0}, {1e-6, 1e-6, 1e-6}), Isometry(Eigen::Translation3d(1, 2, 3)));
  const Triangles hall = moved(box_mesh({-500, -500, -500}, {500, 500, 500}), Isometry(Eigen::Translation3d(1, 2, 3)));
  for (const Triangles* mesh : std::initializer_list<const Triangles*>{&point, &line, &plane, &speck, &hall}) {
    for (const fit::Kinds kinds : {fit::Kinds{}, fit::Kinds{true, false, false}, fit::Kinds{false, true, false},
                                   fit::Kinds{false, false, true}}) {
      const std::vector<Placed> shapes = fitted(*mesh, 3, kinds);
      ASSERT_FALSE(shapes.empty());
      EXPECT_EQ(furthest_outside(*mesh, shapes), 0.0);
      const fit::FitError error = fit::measure(*mesh, shapes);
      EXPECT_TRUE(std::isfinite(error.mean_overshoot) && std::isfinite(error.most_overshoot));
      for (const Placed& s : shapes) {
        EXPECT_TRUE(s.solid.shape.size.allFinite() && s.position.allFinite() && s.rpy.allFinite());
        const int count = s.solid.shape.kind == ShapeKind::kSphere ? 1 : s.solid.shape.kind == ShapeKind::kBox ? 3 : 2;
        EXPECT_GT(s.solid.shape.size.head(count).minCoeff(), 0.0);
      }
    }
  }
  EXPECT_LT(fit::volume(fitted(plane)[0].solid.shape), 1.2e-3 * 0.3 * 0.2);
}

TEST(Fit, NumbersAreRoundAndTheSameEveryTime) {
  std::mt19937_64 engine(6);
  const Triangles mesh = moved(capsule_mesh(0.07, 0.2), random_pose(engine));
  const std::vector<Placed> a = fitted(mesh);
  const std::vector<Placed> b = fitted(mesh);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].solid.shape.size, b[i].solid.shape.size);
    EXPECT_EQ(a[i].position, b[i].position);
    EXPECT_EQ(a[i].rpy, b[i].rpy);
    for (const Vector3& v : {a[i].solid.shape.size, a[i].position, a[i].rpy})
      for (const double x : v) EXPECT_EQ(std::round(x * 1e4) / 1e4, x);
  }
}

// Every subset of two to four points has a ball through it; the smallest that holds all is the answer.
TEST(SmallestBall, IsThatOfAllSubsets) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 200; ++run) {
    std::vector<Vector3> points;
    for (int i = 0; i < 9; ++i)
      points.emplace_back(normal(engine), normal(engine), run % 5 == 0 ? 0.0 : normal(engine));
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Vector3& centre) {
      double r = 0.0;
      for (const Vector3& p : points) r = std::max(r, (p - centre).norm());
      least = std::min(least, r);
    };
    // The centre of a subset lies in the subset's plane and at equal distance: linear equations in the least norm.
    for (unsigned mask = 1; mask < 512; ++mask) {
      std::vector<Vector3> s;
      for (int i = 0; i < 9; ++i)
        if ((mask >> i & 1U) != 0) s.push_back(points[static_cast<std::size_t>(i)]);
      if (s.size() < 2 || s.size() > 4) continue;
      Eigen::MatrixXd A(static_cast<Eigen::Index>(s.size()) - 1, 3);
      Eigen::VectorXd b(A.rows());
      for (Eigen::Index i = 0; i < A.rows(); ++i) {
        A.row(i) = (s[static_cast<std::size_t>(i + 1)] - s[0]).transpose();
        b[i] = 0.5 * A.row(i).squaredNorm();
      }
      consider(s[0] + A.completeOrthogonalDecomposition().solve(b));
    }
    EXPECT_NEAR(fit::smallest_ball<3>(points).radius, least, 1e-9) << run;
  }
}

TEST(FitMeasure, AgreesWithFormulas) {
  fit::Solid a;
  a.shape = {ShapeKind::kSphere, {0.3, 0, 0}, nullptr};
  fit::Solid b = a;
  b.X_LS.translation() = Vector3(0.4, 0, 0);
  const double ball = 4.0 / 3.0 * kPi * 0.027;
  const double lens = kPi * (4 * 0.3 + 0.4) * (2 * 0.3 - 0.4) * (2 * 0.3 - 0.4) / 12;
  const std::vector<fit::Solid> both{a, b};
  EXPECT_NEAR(fit::union_volume(both, 30000), 2 * ball - lens, 0.01 * ball);
  for (const Vector3& p : fit::union_surface(both, 1000)) {
    EXPECT_NEAR(std::min(p.norm(), (p - Vector3(0.4, 0, 0)).norm()), 0.3, 1e-12);
  }

  // A sphere around a cube sticks out by r - a/2 over the faces' middles; a box sticks out by what rounding adds.
  const Triangles cube = box_mesh({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1});
  const fit::FitError error = fit::measure(cube, fitted(cube, 1, {true, false, false}));
  const double r = 0.1 * std::sqrt(3.0);
  EXPECT_NEAR(error.most_overshoot, r - 0.1, 1e-3);
  EXPECT_NEAR(error.volume_ratio.value_or(0.0), 4.0 / 3.0 * kPi * r * r * r / 0.008, 5e-3);
  EXPECT_EQ(error.uncovered, 0.0);
  const fit::FitError tight = fit::measure(cube, fitted(cube));
  EXPECT_LT(tight.most_overshoot, 2e-4);
  EXPECT_NEAR(tight.volume_ratio.value_or(0.0), 1.0, 3e-3);

  // A shape that is too small is noticed: the cube's corner sticks out of its inscribed ball.
  Placed small;
  small.solid.shape = {ShapeKind::kSphere, {0.1, 0, 0}, nullptr};
  EXPECT_NEAR(fit::measure(cube, {small}).uncovered, r - 0.1, 1e-12);
}

}  // namespace
}  // namespace moma
