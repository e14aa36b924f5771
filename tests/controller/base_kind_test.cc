// Kinds of base: each description fits itself and the kinematics.

#include "controller/model/base_kind.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "controller/model/kinematics.h"
#include "tests/controller/qp_robots.h"

namespace moma {
namespace {

using namespace test;

std::vector<BaseType> all_types() {
  std::vector<BaseType> all;
  for (std::size_t i = 0; i < words(Of<BaseType>{}).size(); ++i) all.push_back(static_cast<BaseType>(i));
  return all;
}

TEST(BaseKind, CoordinatesAndVelocitiesAreEachOthersInverse) {
  EXPECT_EQ(kind_of(BaseType::kFixed).dof(), 0);
  EXPECT_EQ(kind_of(BaseType::kDifferential).dof(), 2);
  EXPECT_EQ(kind_of(BaseType::kOmnidirectional).dof(), 3);
  EXPECT_TRUE(kind_of(BaseType::kDifferential).nonholonomic());
  EXPECT_TRUE(kind_of(BaseType::kOmnidirectional).lateral());
  for (const BaseType type : all_types()) {
    const BaseKind& kind = kind_of(type);
    VectorX v(kind.dof() + 2);  // joints follow
    for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = 0.25 + static_cast<double>(i);
    const Vector3 V_B = kind.velocity_B(v);
    EXPECT_EQ(V_B.y() != 0.0, kind.lateral()) << to_string(type);
    VectorX back = v;
    back.head(kind.dof()).setZero();
    kind.set_coordinates(V_B, back);
    EXPECT_EQ(back, v) << to_string(type);
    EXPECT_EQ(kind.lateral() || kind.nonholonomic(), kind.dof() > 0) << to_string(type);
    RobotModel robot;
    robot.base.type = type;
    EXPECT_EQ(robot.base_dof(), kind.dof()) << to_string(type);
    EXPECT_EQ(robot.mobile(), kind.dof() > 0) << to_string(type);
  }
}

// What a name says a coordinate does, the robot does: along B's axes, and about z.
TEST(BaseKind, MovesAsItsNamesSay) {
  for (const auto& model : built_robots()) {
    const BaseKind& kind = kind_of(model->base.type);
    for (int i = 0; i < kind.dof(); ++i) {
      Vector3 base(0.3, -0.2, 0.7);
      VectorX q = model->ready, v = VectorX::Zero(model->num_velocities());
      v[i] = 1.0;
      integrate(*model, base, q, v, 0.001);
      const Vector3 moved = base - Vector3(0.3, -0.2, 0.7);
      const std::string name(kind.velocities[static_cast<std::size_t>(i)]);
      const Vector3 wanted = name == "omega" ? Vector3(0, 0, 1)
                             : name == "v_y" ? Vector3(-std::sin(0.7), std::cos(0.7), 0)
                                             : Vector3(std::cos(0.7), std::sin(0.7), 0);
      EXPECT_NEAR((moved / 0.001 - wanted).norm(), 0.0, 1e-9) << model->name << " " << name;
    }
  }
}

TEST(BaseKind, WheelsAreNamedApartAndTurnByTheirCoordinatesOnly) {
  Wheels wheels;
  wheels.wheelbase = 0.4;
  for (const BaseType type : all_types()) {
    const BaseKind& kind = kind_of(type);
    EXPECT_EQ(kind.wheel_row != nullptr, !kind.wheel_names.empty());
    std::set<std::string_view> names(kind.wheel_names.begin(), kind.wheel_names.end());
    EXPECT_EQ(names.size(), kind.wheel_names.size());
    double sum_of_turns = 0.0;
    for (int i = 0; i < static_cast<int>(kind.wheel_names.size()); ++i) {
      const Vector3 row = kind.wheel_row(wheels, i);
      for (int k = kind.dof(); k < 3; ++k) EXPECT_EQ(row[k], 0.0);
      EXPECT_DOUBLE_EQ(row[0], 1.0 / wheels.radius) << "forwards, each wheel rolls as far as the base goes";
      const bool left = kind.wheel_names[static_cast<std::size_t>(i)].find("left") != std::string_view::npos;
      EXPECT_LT(left ? row[kind.dof() - 1] : -row[kind.dof() - 1], 0.0) << "turning left, left wheels go back";
      sum_of_turns += row[kind.dof() - 1];
    }
    EXPECT_NEAR(sum_of_turns, 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace moma
