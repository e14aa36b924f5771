#include "controller/config/robot_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/sampling.h"
#include "tests/support/robots.h"
#include "tests/support/scratch.h"

namespace moma {
namespace {

void expect_same_isometry(const Isometry& a, const Isometry& b, const std::string& what) {
  EXPECT_TRUE(a.matrix() == b.matrix()) << what;
}

// Bit by bit: == on doubles, and NaN is not allowed anywhere.
void expect_same_model(const RobotModel& a, const RobotModel& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.base.type, b.base.type);
  expect_same_isometry(a.base.X_BM, b.base.X_BM, "mount");
  EXPECT_EQ(a.base.max_linear, b.base.max_linear);
  EXPECT_EQ(a.base.max_angular, b.base.max_angular);
  EXPECT_EQ(a.base.max_acceleration, b.base.max_acceleration);
  EXPECT_EQ(a.base.mass, b.base.mass);
  ASSERT_EQ(a.base.wheels.has_value(), b.base.wheels.has_value());
  if (a.base.wheels) {
    EXPECT_EQ(a.base.wheels->radius, b.base.wheels->radius);
    EXPECT_EQ(a.base.wheels->separation, b.base.wheels->separation);
    EXPECT_EQ(a.base.wheels->wheelbase, b.base.wheels->wheelbase);
    EXPECT_EQ(a.base.wheels->max_speed, b.base.wheels->max_speed);
  }
  ASSERT_EQ(a.links.size(), b.links.size());
  for (std::size_t i = 0; i < a.links.size(); ++i) {
    const Link& x = a.links[i];
    const Link& y = b.links[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.parent, y.parent);
    EXPECT_EQ(x.joint, y.joint);
    EXPECT_EQ(x.joint_type, y.joint_type) << x.name;
    expect_same_isometry(x.X_PJ, y.X_PJ, x.name);
    EXPECT_EQ(x.axis, y.axis);
    EXPECT_EQ(x.controlled, y.controlled);
    EXPECT_EQ(x.held, y.held);
    ASSERT_EQ(x.inertial.has_value(), y.inertial.has_value());
    if (!x.inertial) continue;
    EXPECT_EQ(x.inertial->mass, y.inertial->mass);
    EXPECT_EQ(x.inertial->com_L, y.inertial->com_L);
    EXPECT_EQ(x.inertial->I_C, y.inertial->I_C);
  }
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    EXPECT_EQ(a.joints[i].name, b.joints[i].name);
    EXPECT_EQ(a.joints[i].type, b.joints[i].type);
    EXPECT_EQ(a.joints[i].link, b.joints[i].link);
    EXPECT_EQ(a.joints[i].lower, b.joints[i].lower);
    EXPECT_EQ(a.joints[i].upper, b.joints[i].upper);
    EXPECT_EQ(a.joints[i].velocity, b.joints[i].velocity);
    EXPECT_EQ(a.joints[i].effort, b.joints[i].effort);
  }
  EXPECT_EQ(a.tip, b.tip);
  expect_same_isometry(a.X_TE, b.X_TE, "tool");
  EXPECT_EQ(a.ready, b.ready);
  ASSERT_EQ(a.shapes.size(), b.shapes.size());
  for (std::size_t i = 0; i < a.shapes.size(); ++i) {
    EXPECT_EQ(a.shapes[i].name, b.shapes[i].name);
    EXPECT_EQ(a.shapes[i].link, b.shapes[i].link);
    EXPECT_EQ(a.shapes[i].shape.kind, b.shapes[i].shape.kind);
    EXPECT_EQ(a.shapes[i].shape.size, b.shapes[i].shape.size);
    EXPECT_EQ(a.shapes[i].rigid_with_base, b.shapes[i].rigid_with_base);
    expect_same_isometry(a.shapes[i].X_LS, b.shapes[i].X_LS, a.shapes[i].name);
    ASSERT_EQ(a.shapes[i].shape.hull != nullptr, b.shapes[i].shape.hull != nullptr);
    if (!a.shapes[i].shape.hull) continue;
    EXPECT_EQ(a.shapes[i].shape.hull->vertices, b.shapes[i].shape.hull->vertices);
    EXPECT_EQ(a.shapes[i].shape.hull->triangles, b.shapes[i].shape.hull->triangles);
  }
  ASSERT_EQ(a.sensors.size(), b.sensors.size());
  for (std::size_t i = 0; i < a.sensors.size(); ++i) {
    EXPECT_EQ(a.sensors[i].sensor.name, b.sensors[i].sensor.name);
    EXPECT_EQ(a.sensors[i].sensor.field_of_view, b.sensors[i].sensor.field_of_view);
    EXPECT_EQ(a.sensors[i].link, b.sensors[i].link);
    expect_same_isometry(a.sensors[i].X_LC, b.sensors[i].X_LC, a.sensors[i].sensor.name);
  }
  ASSERT_EQ(a.self_pairs.size(), b.self_pairs.size());
  for (std::size_t i = 0; i < a.self_pairs.size(); ++i) {
    EXPECT_EQ(a.self_pairs[i].first, b.self_pairs[i].first);
    EXPECT_EQ(a.self_pairs[i].second, b.self_pairs[i].second);
    EXPECT_EQ(a.self_pairs[i].row, b.self_pairs[i].row);
  }
}

class RobotFileOf : public testing::TestWithParam<std::string> {
 protected:
  const config::LoadedRobot& robot_ = test::loaded(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Robots, RobotFileOf, testing::ValuesIn(test::all_robots()),
                         [](const auto& robot) { return test::test_name(robot.param); });

TEST_P(RobotFileOf, ResolvedFormGivesTheSameModelBitByBit) {
  const std::string text = robot_.resolved.dump();
  EXPECT_EQ(text.find("package://example-robot-data/robots/") == std::string::npos,
            GetParam().find("examples") == std::string::npos &&
                GetParam().find("tests/data") == std::string::npos);  // the URDF's text is in there
  const config::LoadedRobot again = config::robot_from_resolved(nlohmann::ordered_json::parse(text));
  expect_same_model(*robot_.model, *again.model);
  EXPECT_EQ(again.resolved.dump(), text);
  // As part of a YAML file, since JSON is YAML.
  const config::LoadedRobot yaml = config::read_robot(config::parse_yaml(text, "resolved.yaml"), "robot");
  expect_same_model(*robot_.model, *yaml.model);
}

TEST_P(RobotFileOf, LoadingTwiceGivesTheSame) {
  const config::LoadedRobot again = config::load_robot(test::source_path(GetParam()));
  expect_same_model(*robot_.model, *again.model);
  EXPECT_EQ(robot_.warnings, again.warnings);
}

TEST_P(RobotFileOf, IsConsistent) {
  const RobotModel& model = *robot_.model;
  EXPECT_EQ(model.links[0].name, "@base");
  EXPECT_EQ(model.links[1].parent, 0);
  for (std::size_t i = 1; i < model.links.size(); ++i) EXPECT_LT(model.links[i].parent, static_cast<int>(i));
  for (int j = 0; j < model.num_joints(); ++j) {
    const ControlledJoint& joint = model.joints[static_cast<std::size_t>(j)];
    EXPECT_EQ(model.links[static_cast<std::size_t>(joint.link)].controlled, j);
    EXPECT_LT(joint.lower, joint.upper);
    EXPECT_GT(joint.velocity, 0.0);
    EXPECT_GE(model.ready[j], joint.lower);
    EXPECT_LE(model.ready[j], joint.upper);
  }
  std::set<std::string> names;
  for (const CollisionShape& shape : model.shapes) {
    EXPECT_TRUE(names.insert(shape.name).second) << shape.name;
    if (shape.link == 0) {
      EXPECT_TRUE(shape.rigid_with_base);
    }
    if (!shape.shape.hull) continue;
    EXPECT_LE(shape.shape.hull->vertices.size(), 192U) << shape.name;
    // Closed and oriented outwards: Euler's formula, and the origin (the centre of its box) on every face's inner side.
    EXPECT_EQ(shape.shape.hull->triangles.size(), 2 * shape.shape.hull->vertices.size() - 4) << shape.name;
    for (const Eigen::Vector3i& t : shape.shape.hull->triangles) {
      const auto v = [&](int k) { return shape.shape.hull->vertices[static_cast<std::size_t>(t[k])]; };
      EXPECT_GT((v(1) - v(0)).cross(v(2) - v(0)).dot(v(0)), -1e-9) << shape.name;
    }
  }
  for (const SelfPair& pair : model.self_pairs) {
    EXPECT_LT(pair.first, pair.second);
    EXPECT_GE(pair.first, 0);
    EXPECT_LT(pair.second, static_cast<int>(model.shapes.size()));
  }
}

// At `ready` no pair that counts as a self-collision may be in touch.
TEST_P(RobotFileOf, IsFreeOfSelfCollisionAtReady) {
  const RobotModel& model = *robot_.model;
  const Kinematics kinematics(robot_.model);
  for (const SelfPair& pair : model.self_pairs) {
    const CollisionShape& a = model.shapes[static_cast<std::size_t>(pair.first)];
    const CollisionShape& b = model.shapes[static_cast<std::size_t>(pair.second)];
    EXPECT_GT(shape_distance(a.shape, kinematics.X_WS(a), b.shape, kinematics.X_WS(b)).d, 0.0)
        << a.name << " " << b.name;
  }
}

class ShippedRobot : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Robots, ShippedRobot, testing::ValuesIn(test::shipped_robots()),
                         [](const auto& robot) { return test::test_name(robot.param); });

TEST_P(ShippedRobot, StandsOnTheFloorClearOfItsBase) {
  const config::LoadedRobot robot = config::load_robot(test::source_path(GetParam()));
  const RobotModel& model = *robot.model;
  const Kinematics kinematics(robot.model);
  for (const CollisionShape& shape : model.shapes) {
    EXPECT_NE(shape.shape.kind, ShapeKind::kConvex);
    EXPECT_NE(shape.shape.kind, ShapeKind::kCylinder) << "its contacts are unreliable in the physics engine";
    const double lowest = lowest_point(shape.shape, kinematics.X_WS(shape));
    EXPECT_TRUE(shape.rigid_with_base ? lowest >= 0.0 : lowest > 0.0) << shape.name << " at " << lowest << " m";
    if (shape.rigid_with_base || model.shapes[0].link != 0) continue;
    const CollisionShape& base = model.shapes[0];
    EXPECT_GT(shape_distance(base.shape, kinematics.X_WS(base), shape.shape, kinematics.X_WS(shape)).d, 0.0)
        << shape.name;
  }
  double mass = 0.0;
  for (const Link& link : model.links) {
    if (!link.inertial || link.inertial->mass == 0.0) continue;
    mass += link.inertial->mass;
    // A body's principal moments are positive and none exceeds the sum of the others.
    const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(link.inertial->I_C).eigenvalues();
    EXPECT_GT(moments[0], 0.0) << link.name;
    EXPECT_LE(moments[2], 1.0001 * (moments[0] + moments[1])) << link.name;
  }
  EXPECT_GT(mass, 10.0);
  for (const ControlledJoint& joint : model.joints) EXPECT_GT(joint.effort, 0.0) << joint.name;
  for (const std::string& warning : robot.notes) EXPECT_EQ(warning.find("in touch"), std::string::npos) << warning;
}

TEST(RobotFile, FrankieIsAsDescribed) {
  const auto model = test::load_model("configs/robots/frankie.yaml");
  EXPECT_EQ(model->name, "frankie");
  EXPECT_EQ(model->base.type, BaseType::kDifferential);
  EXPECT_EQ(model->base.X_BM.translation(), Vector3(0.15, 0, 0.38));
  EXPECT_EQ(model->base.mass, 90.0);
  ASSERT_TRUE(model->base.wheels.has_value());
  EXPECT_EQ(model->base.wheels->separation, 0.5);
  EXPECT_EQ(model->num_joints(), 7);
  EXPECT_EQ(model->joints[3].name, "panda_joint4");
  EXPECT_EQ(model->joints[3].lower, -3.0718);
  EXPECT_EQ(model->joints[6].effort, 12.0);
  EXPECT_EQ(model->links[static_cast<std::size_t>(model->tip)].name, "panda_hand_tcp");
  EXPECT_EQ(model->shapes[0].name, "@base");
}

TEST(RobotFile, PrismaticTorsoIsInTheChain) {
  for (const char* file : {"configs/robots/lift_ur5.yaml", "configs/robots/examples/tiago.yaml"}) {
    const auto model = test::load_model(file);
    EXPECT_EQ(model->joints[0].name, "torso_lift_joint");
    EXPECT_EQ(model->joints[0].type, JointType::kPrismatic);
  }
}

TEST(RobotFile, ContinuousJointsHaveNoLimits) {
  const auto model = test::load_model("tests/data/robots/pr2_right_arm.yaml");
  EXPECT_EQ(model->joints[4].name, "r_forearm_roll_joint");
  EXPECT_EQ(model->joints[4].type, JointType::kContinuous);
  EXPECT_TRUE(std::isinf(model->joints[4].lower) && std::isinf(model->joints[4].upper));
  const Link& torso = model->links[static_cast<std::size_t>(model->find_link("torso_lift_link"))];
  EXPECT_EQ(torso.held, 0.16825);
}

// A path keeps as little of its own distance as its start has: a pair that nothing moves would count for all others.
TEST_P(ShippedRobot, HasNoSelfPairOfConstantDistance) {
  const config::LoadedRobot robot = config::load_robot(test::source_path(GetParam()));
  const RobotModel& model = *robot.model;
  Kinematics kinematics(robot.model);
  std::mt19937 engine(5);
  std::vector<double> least(model.self_pairs.size(), 1e9), most(model.self_pairs.size(), -1e9);
  for (int sample = 0; sample < 40; ++sample) {
    VectorX q(model.num_joints());
    for (int i = 0; i < q.size(); ++i) {
      const auto [lower, upper] = drawn_range(model.joint(i));
      q[i] = std::uniform_real_distribution(lower, upper)(engine);
    }
    kinematics.update(Vector3::Zero(), q);
    for (std::size_t k = 0; k < least.size(); ++k) {
      const CollisionShape& a = model.shape(model.self_pairs[k].first);
      const CollisionShape& b = model.shape(model.self_pairs[k].second);
      const double d = shape_distance(a.shape, kinematics.X_WS(a), b.shape, kinematics.X_WS(b)).d;
      least[k] = std::min(least[k], d);
      most[k] = std::max(most[k], d);
    }
  }
  for (std::size_t k = 0; k < least.size(); ++k) {
    if (!model.self_pairs[k].row) continue;
    EXPECT_GT(most[k] - least[k], 1e-3) << model.shape(model.self_pairs[k].first).name << " - "
                                        << model.shape(model.self_pairs[k].second).name << ": " << least[k] << " m";
  }
}

// link1 and link3 of a Panda are never further apart than 26 mm, so that the pair says nothing.
TEST(RobotFile, AutoLeavesOutPairsThatAreAlwaysClose) {
  const auto model = test::load_model("configs/robots/panda.yaml");
  const auto has_pair = [&](const char* a, const char* b) {
    for (const SelfPair& pair : model->self_pairs) {
      const std::string& x = model->shapes[static_cast<std::size_t>(pair.first)].name;
      const std::string& y = model->shapes[static_cast<std::size_t>(pair.second)].name;
      if ((x == a && y == b) || (x == b && y == a)) return true;
    }
    return false;
  };
  EXPECT_FALSE(has_pair("panda_link1", "panda_link3"));
  EXPECT_FALSE(has_pair("panda_link1", "panda_link2"));  // adjacent
  EXPECT_TRUE(has_pair("panda_link1", "panda_hand"));
  EXPECT_TRUE(has_pair("panda_link0", "panda_hand/2"));
}

// A sphere slides past a column, beside it in a tenth of its way.
class PassingPair : public testing::Test {
 protected:
  std::shared_ptr<const RobotModel> passing(double gap, const std::string& collision = "") {
    scratch_.write("passing.urdf", R"(<robot name="passing"><link name="root"><collision><geometry>
  <cylinder radius="0.1" length="0.4"/></geometry></collision></link><link name="carriage"/><link name="ball">
  <collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<joint name="turn" type="revolute"><parent link="root"/><child link="carriage"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" velocity="1" effort="80"/></joint>
<joint name="slide" type="prismatic"><parent link="carriage"/><child link="ball"/><origin xyz=")" +
                                       std::to_string(0.15 + gap) + R"( 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" velocity="1" effort="80"/></joint></robot>)");
    return config::load_robot(scratch_.write("passing.yaml", "urdf: passing.urdf\narm: {tip: ball, ready: [0, 1]}\n" +
                                                                 ("collision: {" + collision + "from: urdf}\n")))
        .model;
  }

  test::Scratch scratch_;
};

// Such a pair cannot touch: a row would only hold what passes, but its contacts still count.
TEST_F(PassingPair, HasNoRowBeyondTheStopDistance) {
  const auto apart = passing(0.012), within = passing(0.008), wider = passing(0.012, "self_stop: 0.013, ");
  for (const auto& model : {apart, within, wider}) ASSERT_EQ(model->self_pairs.size(), 1U);
  EXPECT_FALSE(apart->self_pairs[0].row);
  EXPECT_TRUE(within->self_pairs[0].row);
  EXPECT_TRUE(wider->self_pairs[0].row);
  EXPECT_TRUE(passing(0.03)->self_pairs[0].row);
}

}  // namespace
}  // namespace moma
