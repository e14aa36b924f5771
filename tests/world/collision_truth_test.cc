// Every contact that the plants decide, against proofs: a plane between two solids, or a point that both contain.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/overlap_oracle.h"
#include "tests/world/solids.h"
#include "world/draws.h"
#include "world/plant/contacts.h"

namespace moma {
namespace {

using test::one_object;
using test::one_solid;
using test::overlap;
using test::Overlap;
using test::random_shape;

constexpr int kPlacements = 10000;
constexpr double kDeepest = 1e-6;  // a miss may be no deeper [m]
// Gaps below this may be closed by rounding (the distance library's: 9e-9 seen), or by the turns of 1e-9 rad that
// every box gets [m].
constexpr double kRounding = 1e-8;

Matrix3 random_rotation(Draws& draws) {
  const Eigen::Quaterniond q(draws.normal(0, 1), draws.normal(0, 1), draws.normal(0, 1), draws.normal(0, 1));
  return q.normalized().toRotationMatrix();
}

/// One of the 24 turns by whole quarters, exact: its entries are 0 and +-1.
Matrix3 quarter_turn(Draws& draws) {
  Matrix3 R = Matrix3::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    Matrix3 quarter = Matrix3::Zero();
    quarter(axis, axis) = 1.0;
    quarter((axis + 1) % 3, (axis + 2) % 3) = -1.0;
    quarter((axis + 2) % 3, (axis + 1) % 3) = 1.0;
    for (std::uint64_t turns = draws.choice(4); turns > 0; --turns) R = quarter * R;
  }
  return R;
}

/// Any rotation; quarter turns; quarter turns of one against the other, both tilted; one common axis, both tilted.
std::pair<Matrix3, Matrix3> rotations(int kind, Draws& draws) {
  switch (kind) {
    case 0:
      return {random_rotation(draws), random_rotation(draws)};
    case 1:
      return {quarter_turn(draws), quarter_turn(draws)};
    case 2: {
      const Matrix3 tilt = random_rotation(draws);
      return {tilt, tilt * quarter_turn(draws)};
    }
    default: {
      const Matrix3 tilt = random_rotation(draws);
      const Vector3 axis = Vector3::Unit(static_cast<Eigen::Index>(draws.choice(3)));
      return {tilt * quarter_turn(draws), tilt * Eigen::AngleAxisd(draws.uniform(0.0, 6.3), axis).toRotationMatrix()};
    }
  }
}

Vector3 random_point(Draws& draws, double spread) {
  return {draws.uniform(-spread, spread), draws.uniform(-spread, spread), draws.uniform(-spread, spread)};
}

/// Signed distance: 2e-8 to 1e-2 m apart, or 1e-6 to 1e-2 m deep, evenly in the logarithm.
double small_distance(Draws& draws) {
  if (draws.choice(2) == 0) return std::pow(10.0, draws.uniform(-7.7, -2.0));
  return -std::pow(10.0, draws.uniform(-6.0, -2.0));
}

struct ContactCollector {
  void take(const Touch& t) {
    object |= t.kind == PairKind::kObject;
    floor |= t.kind == PairKind::kFloor;
  }
  bool object = false, floor = false;
};

/// What the plants see: ODE's contacts, and the distance library's where it decides.
ContactCollector contacts_of(const Shape& A, const Isometry& X_A, const Shape* B, const Isometry& X_B) {
  const World world = B != nullptr ? one_object(*B, X_B) : World();
  const auto model = one_solid(A, X_A);
  ContactScene scene(model, world, false);
  Kinematics kinematics(model);
  kinematics.update(Vector3::Zero(), model->ready);
  scene.place_robot(kinematics);
  ContactCollector found;
  scene.detect([&](const Touch& t) { found.take(t); });
  std::vector<Contact> exact;
  ContactLog log(exact);
  scene.detect_exact(kinematics, 0.0, log);
  for (const Contact& contact : exact) {
    found.object |= contact.kind == PairKind::kObject;
    found.floor |= contact.kind == PairKind::kFloor;
  }
  return found;
}

struct PairPlacement {
  Shape A, B;
  Isometry X_A = Isometry::Identity(), X_B = Isometry::Identity();
  test::OverlapResult truth() const { return overlap(A, X_A, B, X_B, kDeepest); }
};

class CollisionTruth : public testing::TestWithParam<std::tuple<ShapeKind, ShapeKind>> {
 protected:
  Draws draws(std::uint64_t seed) const {
    return {seed, 0, Stream::kObjects, static_cast<std::uint64_t>(std::get<0>(GetParam())),
            static_cast<std::uint64_t>(std::get<1>(GetParam()))};
  }

  /// As robot and object, and the other way round, with every kind of rotations in turn.
  static PairPlacement place(int i, Draws& draws) {
    const auto [first, second] = GetParam();
    PairPlacement p;
    p.A = random_shape(i % 2 == 0 ? first : second, draws);
    p.B = random_shape(i % 2 == 0 ? second : first, draws);
    const auto [R_A, R_B] = rotations(i / 2 % 4, draws);
    p.X_A.linear() = R_A;
    p.X_B.linear() = R_B;
    p.X_A.translation() = random_point(draws, 0.3);
    p.X_B.translation() = random_point(draws, 0.3);
    return p;
  }

  /// Moves B along the line of nearest points until this is about the signed distance.
  static void bring_to(double distance, PairPlacement& p, Draws& draws) {
    const Vector3 away = random_point(draws, 0.1);
    test::OverlapResult truth = p.truth();
    while (truth.verdict != Overlap::kApart) {
      p.X_B.translation() += away;
      truth = p.truth();
    }
    p.X_B.translation() += truth.n_W * (truth.gap - distance);
  }

  static bool hit(const PairPlacement& p) { return contacts_of(p.A, p.X_A, &p.B, p.X_B).object; }
};

TEST_P(CollisionTruth, NoMissAndNoFalseHit) {
  Draws draws = this->draws(23);
  int deep = 0, apart = 0, boundary = 0, missed = 0, invented = 0, undecided = 0;
  double nearest_gap = 1.0;
  for (int i = 0; i < kPlacements; ++i) {
    PairPlacement p = place(i, draws);
    if (i / 8 % 2 == 0) bring_to(small_distance(draws), p, draws);
    const test::OverlapResult truth = p.truth();
    switch (truth.verdict) {
      case Overlap::kApart:
        ++apart;
        nearest_gap = std::min(nearest_gap, truth.gap);
        if (truth.gap > kRounding && hit(p)) {
          ++invented;
          EXPECT_LE(invented, 3) << "placement " << i << ": " << truth.gap << " m apart";
        }
        break;
      case Overlap::kDeep:
        ++deep;
        if (!hit(p)) {
          ++missed;
          EXPECT_LE(missed, 3) << "placement " << i;
        }
        break;
      case Overlap::kBoundary:
        ++boundary;
        break;
      case Overlap::kUndecided:
        ++undecided;
        break;
    }
  }
  std::printf("%d apart, %d overlap by more than 1e-6 m, %d touch within that; %d missed, %d invented\n", apart, deep,
              boundary, missed, invented);
  EXPECT_EQ(missed, 0) << "of " << deep;
  EXPECT_EQ(invented, 0) << "of " << apart;
  EXPECT_EQ(undecided, 0) << "neither a plane nor a point was found";
  EXPECT_LT(boundary, kPlacements / 50) << "nothing is said about these";
  EXPECT_GT(deep, kPlacements / 5);
  EXPECT_GT(apart, kPlacements / 5);
  EXPECT_LT(nearest_gap, 1e-7) << "the table must try small gaps";
}

TEST_P(CollisionTruth, OverlapsOfMicrometresAreFound) {
  Draws draws = this->draws(31);
  int deep = 0, missed = 0;
  for (int i = 0; i < 4000; ++i) {
    PairPlacement p = place(i, draws);
    bring_to(-std::pow(10.0, draws.uniform(-5.9, -5.0)), p, draws);
    if (p.truth().verdict != Overlap::kDeep) continue;
    ++deep;
    missed += !hit(p);
  }
  EXPECT_EQ(missed, 0) << "of " << deep;
  EXPECT_GT(deep, 3000);
}

class FloorTruth : public testing::TestWithParam<ShapeKind> {};

TEST_P(FloorTruth, NoMissAndNoFalseHit) {
  Draws draws(29, 0, Stream::kObjects, static_cast<std::uint64_t>(GetParam()));
  int missed = 0, invented = 0, deep = 0, apart = 0;
  for (int i = 0; i < kPlacements; ++i) {
    const Shape A = random_shape(GetParam(), draws);
    Isometry X = Isometry::Identity();
    X.linear() = rotations(i % 4, draws).first;
    X.translation() = random_point(draws, 0.3);
    X.translation().z() -= test::least_along(A, X, Vector3::UnitZ()) - small_distance(draws);
    const double lowest = test::least_along(A, X, Vector3::UnitZ());
    const bool hit = contacts_of(A, X, nullptr, X).floor;
    deep += lowest < -kDeepest;
    apart += lowest > 0.0;
    missed += !hit && lowest < -kDeepest;
    invented += hit && lowest > kRounding;
  }
  EXPECT_EQ(missed, 0) << "of " << deep;
  EXPECT_EQ(invented, 0) << "of " << apart;
  EXPECT_GT(deep, kPlacements / 3);
  EXPECT_GT(apart, kPlacements / 3);
}

INSTANTIATE_TEST_SUITE_P(Pairs, CollisionTruth,
                         testing::Values(std::make_tuple(ShapeKind::kSphere, ShapeKind::kSphere),
                                         std::make_tuple(ShapeKind::kSphere, ShapeKind::kCapsule),
                                         std::make_tuple(ShapeKind::kSphere, ShapeKind::kBox),
                                         std::make_tuple(ShapeKind::kSphere, ShapeKind::kCylinder),
                                         std::make_tuple(ShapeKind::kCapsule, ShapeKind::kCapsule),
                                         std::make_tuple(ShapeKind::kCapsule, ShapeKind::kBox),
                                         std::make_tuple(ShapeKind::kCapsule, ShapeKind::kCylinder),
                                         std::make_tuple(ShapeKind::kBox, ShapeKind::kBox),
                                         std::make_tuple(ShapeKind::kBox, ShapeKind::kCylinder),
                                         std::make_tuple(ShapeKind::kCylinder, ShapeKind::kCylinder)),
                         [](const auto& pair) {
                           return std::string(to_string(std::get<0>(pair.param))) + "_" +
                                  std::string(to_string(std::get<1>(pair.param)));
                         });
INSTANTIATE_TEST_SUITE_P(Shapes, FloorTruth,
                         testing::Values(ShapeKind::kSphere, ShapeKind::kCapsule, ShapeKind::kBox,
                                         ShapeKind::kCylinder),
                         [](const auto& floor) { return std::string(to_string(floor.param)); });

}  // namespace
}  // namespace moma
