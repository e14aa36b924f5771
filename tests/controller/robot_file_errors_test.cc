// Every way to get a robot file wrong has its own message, at its place.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "controller/config/robot_file.h"
#include "tests/support/robots.h"
#include "tests/support/scratch.h"

namespace moma {
namespace {

// A small arm: lift (prismatic), turn (revolute), spin (continuous), and a finger that mimics another.
const char* const kUrdf = R"(<?xml version="1.0"?>
<robot name="small">
  <link name="root"/>
  <link name="lifted"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="turned"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="tip"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="finger1"/>
  <link name="finger2"/>
  <joint name="lift" type="prismatic">
    <parent link="root"/><child link="lifted"/><axis xyz="0 0 1"/>LIFT_LIMIT
  </joint>
  <joint name="turn" type="revolute">
    <parent link="lifted"/><child link="turned"/><origin xyz="0.2 0 0"/><axis xyz="0 0 2"/>
    <limit lower="-1" upper="2" velocity="1.5" effort="10"/>
  </joint>
  <joint name="spin" type="continuous"><parent link="turned"/><child link="tip"/><axis xyz="1 0 0"/>SPIN_LIMIT</joint>
  <joint name="grip1" type="prismatic"><parent link="tip"/><child link="finger1"/><axis xyz="0 1 0"/>
    <limit lower="0.01" upper="0.04" velocity="1" effort="1"/></joint>
  <joint name="grip2" type="prismatic"><parent link="tip"/><child link="finger2"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/><mimic joint="grip1" multiplier="-2" offset="0.5"/></joint>
</robot>
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string urdf(const std::string& lift = R"(<limit lower="0" upper="0.4" velocity="0.1" effort="500"/>)",
                 const std::string& spin = R"(<limit velocity="3" effort="2"/>)") {
  return replaced(replaced(kUrdf, "LIFT_LIMIT", lift), "SPIN_LIMIT", spin);
}

const char* const kRobot = R"(urdf: small.urdf
base:
  type: differential
  max_linear: 1
  max_angular: 2
  wheels: {radius: 0.1, separation: 0.4}
  footprint: {shape: box, size: [0.4, 0.4, 0.1], position: [0, 0, 0.1], mass: 20}
arm:
  tip: tip
  ready: [0.1, 0.2, 0.3]
collision:
  shapes:
    - {link: tip, shape: sphere, size: 0.05, position: [0.3, 0, 0.5]}
)";

class RobotFileErrors : public testing::Test {
 protected:
  void SetUp() override { scratch_.write("small.urdf", urdf()); }

  config::LoadedRobot load(const std::string& yaml) { return config::load_robot(scratch_.write("robot.yaml", yaml)); }

  // The message that loading `yaml` fails with; empty where it does not fail.
  std::string message(const std::string& yaml) {
    try {
      load(yaml);
    } catch (const config::ConfigError& e) {
      return e.what();
    }
    return "";
  }

  void expect(const std::string& yaml, const std::vector<std::string>& parts) {
    const std::string text = message(yaml);
    for (const std::string& part : parts)
      EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' in: " << text;
  }

  void expect_change(const std::string& from, const std::string& to, const std::vector<std::string>& parts) {
    expect(replaced(kRobot, from, to), parts);
  }

  void expect_urdf(const std::string& text, const std::vector<std::string>& parts) {
    scratch_.write("small.urdf", text);
    expect(kRobot, parts);
    scratch_.write("small.urdf", urdf());
  }

  test::Scratch scratch_;
};

TEST_F(RobotFileErrors, TheRobotItselfIsFine) {
  const config::LoadedRobot robot = load(kRobot);
  EXPECT_EQ(robot.model->num_joints(), 3);
  EXPECT_EQ(robot.model->joints[2].type, JointType::kContinuous);
  EXPECT_EQ(robot.model->links[2].axis, Vector3::UnitZ());
  // Off the chain: 0 clipped into the limits, and what the mimicking joint makes of it.
  EXPECT_EQ(robot.model->links[static_cast<std::size_t>(robot.model->find_link("finger1"))].held, 0.01);
  EXPECT_DOUBLE_EQ(robot.model->links[static_cast<std::size_t>(robot.model->find_link("finger2"))].held, 0.48);
}

TEST_F(RobotFileErrors, Sensors) {
  const std::string robot = std::string(kRobot) + "sensors:\n";
  const config::LoadedRobot seeing = load(robot +
                                          "  - {name: mast, position: [0, 0, 1], rpy: [0, 0, 3.141592653589793]}\n"
                                          "  - {name: eye, link: tip, columns: 3, rows: 1, field_of_view: [1, 0]}\n");
  ASSERT_EQ(seeing.model->sensors.size(), 2U);
  EXPECT_EQ(seeing.model->sensors[0].link, 0);
  EXPECT_TRUE(seeing.model->sensors[0].X_LC.linear().col(0).isApprox(Vector3(-1, 0, 0), 1e-12)) << "it looks back";
  EXPECT_EQ(seeing.model->sensors[1].link, seeing.model->find_link("tip"));
  EXPECT_EQ(config::robot_from_resolved(seeing.resolved).resolved.dump(), seeing.resolved.dump());
  expect(robot + "  - {link: tip}\n", {"robot.yaml:15:5: sensors[0].name: missing"});
  expect(robot + "  - {name: ''}\n", {"sensors[0].name: found '', expected a name"});
  expect(robot + "  - {name: a}\n  - {name: a}\n", {"sensors[1].name: another sensor is called 'a'"});
  expect(robot + "  - {name: a, link: nose}\n", {"sensors[0].link: found 'nose', which is no link of the robot"});
  expect(robot + "  - {name: a, field_of_view: [0, 1]}\n", {"field_of_view: found an azimuth of 0, expected more"});
  expect(robot + "  - {name: a, field_of_view: [1, 4]}\n", {"field_of_view: found an elevation above pi"});
  expect(robot + "  - {name: a, field_of_view: [1, 0]}\n", {"rows: found 60 rows for an elevation of 0, expected 1"});
  expect(robot + "  - {name: a, columns: 9999, rows: 9999}\n",
         {"columns: found 99980001 rays", "expected at most 100000"});
  expect(robot + "  - {name: a, rate: 0}\n", {"sensors[0].rate: found '0'"});
  expect(robot + "  - {name: a, gaze: 1}\n", {"sensors[0].gaze: unknown key"});
}

TEST_F(RobotFileErrors, Places) {
  const std::string text = message(replaced(kRobot, "max_angular: 2", "max_angluar: 2"));
  EXPECT_NE(text.find("robot.yaml:3:3: base.max_angular: missing"), std::string::npos) << text;
  expect_change("  tip: tip\n", "  tip: tip\n  tipp: 3\n",
                {"robot.yaml:10:3: arm.tipp: unknown key (did you mean tip?)"});
}

TEST_F(RobotFileErrors, Urdf) {
  expect_change("urdf: small.urdf\n", "", {"robot.yaml:1:1: urdf: missing"});
  expect_change("small.urdf", "none.urdf", {"robot.yaml:1:7: urdf: no such file", "none.urdf"});
  expect_change("small.urdf", "package://nowhere/x.urdf",
                {"cannot find 'package://nowhere/x.urdf'", "MOMA_PACKAGE_PATH"});
  expect_change("small.urdf", "package://nowhere", {"is not package://NAME/PATH"});
  expect_change("urdf: small.urdf", "urdf: small.urdf\npackages: {a: gone}",
                {"packages.a: found 'gone', which is no folder"});
  expect_urdf("", {"small.urdf: not valid XML"});
  expect_urdf("<robot name='a'><link name='b'></robot>", {"not valid XML", "row 1"});
  expect_urdf("<model/>", {"there is no <robot> element"});
  expect_urdf("<robot name='a'></robot>", {"urdf"});
  expect_urdf("<robot name='a'><xacro:include filename='b'/></robot>", {"expand it with xacro first"});
  expect_urdf(replaced(urdf(), "<link name=\"root\"/>", "<link name=\"root\"/><link name=\"stray\"/>"), {"root"});
  expect_urdf(replaced(urdf(), "<parent link=\"root\"/>", "<parent link=\"finger1\"/>"), {"small.urdf"});
  expect_urdf(replaced(urdf(), "<child link=\"finger2\"/>", "<child link=\"finger1\"/>"), {"small.urdf"});
  expect_urdf(replaced(urdf(), "xyz=\"0.2 0 0\"", "xyz=\"0.2 nan 0\""), {"small.urdf"});
  expect_urdf(replaced(urdf(), "xyz=\"0 0 2\"", "xyz=\"0 0 0\""), {"joint turn: its axis has no direction"});
  expect_urdf(replaced(urdf(), "<mass value=\"1\"/>", "<mass value=\"-1\"/>"), {"link lifted, inertial"});
  std::string deep = "<robot name='a'>";
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  expect_urdf(deep, {"nested more than"});
}

TEST_F(RobotFileErrors, LimitsTheUrdfLacks) {
  scratch_.write("small.urdf", urdf("", ""));
  expect(kRobot,
         {"arm.limits.lift: the URDF gives prismatic joint lift no lower, upper, velocity: give arm.limits.lift: "
          "{lower: ..., upper: ..., velocity: ...} in m, m/s; continuous joint spin no velocity: give "
          "arm.limits.spin: {velocity: ...} in rad/s"});
  const auto with = [&](const std::string& limits) {
    return replaced(kRobot, "  tip: tip\n", "  tip: tip\n  limits: " + limits + "\n");
  };
  expect(with("{lift: {lower: 0, upper: 1}}"),
         {"arm.limits.lift", "lift no velocity: give", "in m/s; continuous joint spin"});
  expect(with("{lift: {lower: 0, upper: 1, velocity: 1}}"),
         {"arm.limits.spin: the URDF gives continuous joint spin no velocity: give", "in rad/s"});
  const config::LoadedRobot robot = load(with("{lift: {lower: 0, upper: 1, velocity: 0.2}, spin: {velocity: 4}}"));
  EXPECT_EQ(robot.model->joints[0].upper, 1.0);
  EXPECT_EQ(robot.model->joints[0].effort, 0.0);
  std::string warnings;
  for (const std::string& warning : robot.warnings) warnings += warning + "\n";
  EXPECT_NE(warnings.find("joint lift: no effort limit is known"), std::string::npos) << warnings;
  // Limits make a continuous joint a revolute one.
  EXPECT_EQ(load(with("{lift: {lower: 0, upper: 1, velocity: 1}, spin: {velocity: 4, lower: -1, upper: 1}}"))
                .model->joints[2]
                .type,
            JointType::kRevolute);
  expect(with("{lift: {lower: 0, upper: 1, velocity: 1}, spin: {velocity: 4, lower: -1}}"), {"both lower and upper"});
  expect(with("{lift: {lower: 2, upper: 1, velocity: 1}}"), {"lower 2", "is not below upper 1"});
  expect(with("{lift: {lower: 0, upper: 1, velocity: 0}}"),
         {"arm.limits.lift.velocity: found '0', expected a number above 0"});
  expect(with("{lfit: {lower: 0}}"), {"arm.limits.lfit: the URDF has no movable joint", "did you mean lift?"});
}

TEST_F(RobotFileErrors, Arm) {
  expect_change("arm:\n  tip: tip\n  ready: [0.1, 0.2, 0.3]\n", "", {"arm: missing"});
  expect_change("tip: tip\n", "tip: tpi\n", {"arm.tip: found 'tpi', which is no link of the URDF (did you mean tip?)"});
  expect_change("tip: tip\n", "tip: root\n", {"no joint is left to control"});
  expect_change("tip: tip\n", "tip: finger2\n", {"joint grip2", "mimics grip1", "arm.locked.grip2"});
  expect_change("tip: tip\n", "tip: tip\n  locked: {turn: 0.5, spn: 1}\n",
                {"arm.locked.spn: the URDF has no movable joint", "did you mean spin?"});
  expect_change("tip: tip\n", "tip: tip\n  locked: {turn: 5}\n",
                {"arm.locked.turn: found 5, outside the joint's limits"});
  expect_change("tip: tip\n", "tip: tip\n  limits: {nonsense: {lower: 0}}\n",
                {"arm.limits.nonsense: the URDF has no movable joint"});
  expect_change("[0.1, 0.2, 0.3]", "[0.1, 0.2]", {"arm.ready: found a list of 2, expected a list of 3 numbers"});
  expect_change("[0.1, 0.2, 0.3]", "[0.1, 2.5, 0.3]", {"robot.yaml:10:16: arm.ready[1]: found 2.5", "joint turn"});
  expect_change("[0.1, 0.2, 0.3]", "[0.1, .nan, 0.3]", {"arm.ready[1]"});
  scratch_.write("small.urdf", replaced(urdf(), "type=\"revolute\"", "type=\"floating\""));
  expect(kRobot, {"the floating joint turn lies between the root and the tip"});
  scratch_.write("small.urdf", urdf());
}

TEST_F(RobotFileErrors, Base) {
  expect_change("type: differential", "type: diferential",
                {"base.type: found 'diferential'", "did you mean differential?"});
  expect_change("  max_linear: 1\n", "", {"base.max_linear: missing; expected the base's largest speed"});
  expect_change("max_linear: 1", "max_linear: -1", {"base.max_linear: found '-1', expected a number above 0"});
  expect_change("radius: 0.1", "radius: 0", {"base.wheels.radius"});
  expect_change("type: differential", "type: omnidirectional", {"base.wheels.wheelbase: missing"});
  expect_change("max_linear: 1\n", "max_linear: 1\n  max_acceleration: [1]\n", {"base.max_acceleration", "2 numbers"});
  expect_change("max_linear: 1\n", "max_linear: 1\n  mount: {position: [0, 0]}\n",
                {"base.mount.position", "3 numbers"});
  expect_change("shape: box, size: [0.4, 0.4, 0.1]", "shape: bxo, size: [1, 1, 1]",
                {"base.footprint.shape: found 'bxo'", "did you mean box?"});
  expect_change("size: [0.4, 0.4, 0.1]", "size: [0.4, 0.4]", {"base.footprint.size", "3 numbers"});
  expect_change("mass: 20", "mass: -20", {"base.footprint.mass"});
}

TEST_F(RobotFileErrors, Collision) {
  expect_change("link: tip", "link: tpi", {"collision.shapes[0].link: found 'tpi'", "did you mean tip?"});
  expect_change("size: 0.05", "size: 0", {"collision.shapes[0].size", "above 0"});
  expect_change("size: 0.05, ", "", {"collision.shapes[0].size: missing; expected the radius"});
  expect_change("shape: sphere, ", "", {"collision.shapes[0].shape: missing"});
  expect_change("position: [0.3, 0, 0.5]", "positoin: [0.3, 0, 0.5]",
                {"collision.shapes[0].positoin: unknown key (did you mean position?)"});
  expect_change("position: [0.3, 0, 0.5]", "rotation: [1, 0, 0, 0, 1, 0, 0, 0, 2]", {"no rotation matrix"});
  expect_change("collision:\n", "collision:\n  from: mesh\n", {"collision.from: found 'mesh', expected urdf"});
  expect_change("collision:\n", "collision:\n  self: [[tip, tpi]]\n",
                {"collision.self[0]", "'tpi'", "no collision shape"});
  expect_change("collision:\n", "collision:\n  self: [[tip, tip]]\n",
                {"collision.self[0]", "no controlled joint lies between"});
  expect_change("collision:\n", "collision:\n  self: [tip]\n", {"collision.self[0]: expected [link, link]"});
  expect_change("collision:\n", "collision:\n  self: always\n",
                {"collision.self: found 'always', expected auto or a list"});
  EXPECT_EQ(message(replaced(kRobot, "collision:\n", "collision:\n  self: [[\"@base\", tip]]\n")), "");
  const std::string mesh =
      "<link name=\"root\"><collision><geometry><mesh filename=\"gone.stl\"/></geometry></collision></link>";
  scratch_.write("small.urdf", replaced(urdf(), "<link name=\"root\"/>", mesh));
  expect_change("collision:\n", "collision:\n  from: urdf\n", {"collision.from: link root: no such file", "gone.stl"});
  scratch_.write("gone.stl", "solid nonsense\nendsolid\n");
  expect_change("collision:\n", "collision:\n  from: urdf\n", {"collision.from: link root: the mesh", "gone.stl"});
  scratch_.write("gone.stl", std::string(100, '\xff'));
  expect_change("collision:\n", "collision:\n  from: urdf\n", {"collision.from: link root: the mesh"});
}

// What is accepted becomes JSON in stores, which holds nothing but UTF-8.
TEST_F(RobotFileErrors, TextIsUtf8) {
  expect(replaced(kRobot, "  tip: tip", "  tip: \"t\xe9p\""), {"robot.yaml:9:10: the byte 0xe9 is not UTF-8"});
  expect("\xff\xfeu\n", {"robot.yaml:1:1: the byte 0xff is not UTF-8"});
  expect(std::string("u\0\0\0\n\0\0\0", 8), {"robot.yaml:1:2: the byte 0x00 is no part of a text"});  // UTF-32
  expect(replaced(kRobot, "  tip: tip", "  tip: \"t\\_p\""),
         {"robot.yaml:9:8: the byte 0xa0 is not UTF-8", "from one of the escapes"});
  expect_urdf(replaced(urdf(), "<link name=\"root\"/>", "<link name=\"root\"/><!-- caf\xe9 -->"),
              {"small.urdf: line 3: the byte 0xe9 is not UTF-8"});
  const std::string numbered = replaced(urdf(), "<robot name=\"small\">", "<robot name=\"caf&#233;\">");
  const std::string declared = replaced(numbered, "version=\"1.0\"", "version=\"1.0\" encoding=\"UTF-8\"");
  expect_urdf(replaced(numbered, "<?xml version=\"1.0\"?>\n", ""), {"small.urdf: characters by number"});
  for (const std::string& text : {declared, replaced(declared, "&#233;", "\xc3\xa9")}) {
    scratch_.write("small.urdf", text);
    const config::LoadedRobot robot = load(kRobot);
    EXPECT_EQ(robot.model->name, "caf\xc3\xa9");
    EXPECT_NO_THROW((void)robot.resolved.dump());
  }
}

TEST_F(RobotFileErrors, BrokenYaml) {
  expect("urdf: [", {"robot.yaml", "not valid YAML"});
  expect("", {"urdf: missing"});
  expect("- 1\n- 2\n", {"expected a map of keys"});
  expect(std::string(kRobot) + "urdf: twice\n", {"urdf: the key is there twice"});
  EXPECT_THROW(config::load_robot(scratch_.folder() / "none.yaml"), config::ConfigError);
  EXPECT_THROW(config::load_robot(scratch_.folder()), config::ConfigError);
  EXPECT_THROW(config::robot_from_resolved(nlohmann::ordered_json::parse("[1]")), config::ConfigError);
  EXPECT_THROW(config::robot_from_resolved(nlohmann::ordered_json::object()), config::ConfigError);
}

// Cutting a resolved robot short anywhere gives an error, never a crash or a robot.
TEST_F(RobotFileErrors, DamagedResolvedRobot) {
  const nlohmann::ordered_json resolved = load(kRobot).resolved;
  for (const char* pointer : {"/urdf_text", "/base/max_linear", "/arm", "/arm/tip", "/collision/shapes/0/link"}) {
    nlohmann::ordered_json damaged = resolved;
    const nlohmann::ordered_json::json_pointer at(pointer);
    damaged.at(at.parent_pointer()).erase(at.back());
    EXPECT_THROW(config::robot_from_resolved(damaged), config::ConfigError) << pointer;
  }
  nlohmann::ordered_json damaged = resolved;
  damaged["collision"]["pairs"] = {{0, 9, true}};
  EXPECT_THROW(config::robot_from_resolved(damaged), config::ConfigError);
}

TEST_F(RobotFileErrors, MapsAndPathsInAnotherFile) {
  scratch_.write("robots/small.urdf", urdf());
  scratch_.write("robots/small.yaml", kRobot);
  const auto suite = scratch_.write("suite.yaml", "robot: robots/small.yaml\nother: robots/none.yaml\n");
  const config::Node node = config::load_yaml(suite);
  EXPECT_EQ(config::read_robot(*node.find("robot"), "robot").model->name, "small");
  try {
    config::read_robot(*node.find("other"), "other");
    FAIL();
  } catch (const config::ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("suite.yaml:2:8: other: found 'robots/none.yaml'"), std::string::npos)
        << e.what();
  }
}

TEST_F(RobotFileErrors, Packages) {
  scratch_.write("here/my_robot/urdf/small.urdf", urdf());
  const std::string uri = "package://my_robot/urdf/small.urdf";
  expect_change("small.urdf", uri, {"cannot find", "my_robot"});
  EXPECT_EQ(message(replaced(kRobot, "urdf: small.urdf", "urdf: " + uri + "\npackages: {my_robot: here/my_robot}")),
            "");
  setenv("MOMA_PACKAGE_PATH", ("/nowhere:" + (scratch_.folder() / "here").string()).c_str(), 1);
  EXPECT_EQ(message(replaced(kRobot, "small.urdf", uri)), "");
  unsetenv("MOMA_PACKAGE_PATH");
  const auto beside = scratch_.write("here/robot.yaml", replaced(kRobot, "small.urdf", uri));
  EXPECT_NO_THROW(config::load_robot(beside));
}

// A tetrahedron, and a flat triangle that has no hull.
TEST_F(RobotFileErrors, MeshesBecomeHulls) {
  const auto facet = [](const char* vertices) {
    return std::string("facet normal 0 0 1\nouter loop\n") + vertices + "endloop\nendfacet\n";
  };
  const std::string flat = facet("vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n");
  const std::string solid = flat + facet("vertex 0 0 0\nvertex 0 0 1\nvertex 1 0 0\n") +
                            facet("vertex 0 0 0\nvertex 0 1 0\nvertex 0 0 1\n") +
                            facet("vertex 1 0 0\nvertex 0 0 1\nvertex 0 1 0\n");
  scratch_.write("solid.stl", "solid a\n" + solid + "endsolid a\n");
  scratch_.write("flat.stl", "solid a\n" + flat + "endsolid a\n");
  const std::string leaning =
      facet("vertex 0 0 0\nvertex 1 0 0.3\nvertex 0 1 0.7\n") + facet("vertex 1 0 0.3\nvertex 1 1 1\nvertex 0 1 0.7\n");
  scratch_.write("leaning.stl", "solid a\n" + leaning + "endsolid a\n");
  const auto with = [&](const std::string& file) {
    scratch_.write("small.urdf",
                   replaced(urdf(), "<link name=\"root\"/>",
                            "<link name=\"root\"><collision><origin xyz=\"0 0 1\"/><geometry><mesh filename=\"" + file +
                                "\" scale=\"0.1 0.2 0.3\"/></geometry></collision></link>"));
    return load(replaced(kRobot, "collision:\n", "collision:\n  from: urdf\n"));
  };
  const config::LoadedRobot robot = with("solid.stl");
  const CollisionShape& hull = robot.model->shapes.back();
  ASSERT_EQ(hull.shape.kind, ShapeKind::kConvex);
  EXPECT_EQ(hull.shape.hull->vertices.size(), 4U);
  EXPECT_LT((hull.X_LS.translation() - Vector3(0.05, 0.1, 1.15)).norm(), 1e-6);
  EXPECT_NEAR(lowest_point(hull.shape, hull.X_LS), 1.0, 1e-6);
  const config::LoadedRobot box = with("flat.stl");
  EXPECT_EQ(box.model->shapes.back().shape.kind, ShapeKind::kBox);
  EXPECT_GE(box.model->shapes.back().shape.size.z(), 1e-3);
  EXPECT_EQ(with("leaning.stl").model->shapes.back().shape.kind, ShapeKind::kBox);
}

// A ball of 30 x 15 points becomes a smaller hull that still has every one of them inside, and is hardly larger.
TEST_F(RobotFileErrors, AnArmWithoutShapesHasToBeMeant) {
  const std::string block =
      "collision:\n  shapes:\n    - {link: tip, shape: sphere, size: 0.05, position: [0.3, 0, 0.5]}\n";
  const std::vector<std::string> way_out = {"collision", "--fit-shapes", "`shapes: []`"};
  expect_change(block, "", way_out);
  expect_change(block, "collision: {self: []}\n", way_out);
  expect_change(block, "collision: {from: urdf}\n", {"the URDF has no collision geometry", "--fit-shapes"});
  expect_change("link: tip", "link: \"@base\"", way_out);
  expect_change("link: tip", "link: root", way_out);
  for (const char* meant : {"collision: {shapes: []}\n", "collision: {shapes: [], from: urdf}\n"}) {
    const config::LoadedRobot robot = load(replaced(kRobot, block, meant));
    EXPECT_EQ(robot.model->shapes.size(), 1U) << "the footprint";
    ASSERT_FALSE(robot.warnings.empty());
    EXPECT_NE(robot.warnings.front().find("nothing it does can be a collision"), std::string::npos);
    config::robot_from_resolved(robot.resolved);
  }
  // Stores have robots of before.
  nlohmann::ordered_json resolved = load(kRobot).resolved;
  resolved["collision"]["shapes"][0]["link"] = "@base";
  resolved["collision"]["pairs"] = nlohmann::ordered_json::array();
  EXPECT_NO_THROW(config::robot_from_resolved(resolved));
}

TEST_F(RobotFileErrors, LargeHullsAreSimplifiedOutwards) {
  std::vector<Vector3> points;
  for (int i = 0; i < 15; ++i) {
    for (int j = 0; j < 30; ++j) {
      const double polar = 3.14159265 * (i + 0.5) / 15.0;
      const double turn = 6.2831853 * j / 30.0;
      points.emplace_back(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
    }
  }
  std::string stl = "solid ball\n";
  for (std::size_t i = 0; i + 2 < points.size(); ++i) {  // any triangles will do: the hull is of the points
    stl += "facet normal 0 0 1\nouter loop\n";
    for (std::size_t k = i; k < i + 3; ++k) {
      stl += "vertex " + std::to_string(points[k].x()) + " " + std::to_string(points[k].y()) + " " +
             std::to_string(points[k].z()) + "\n";
    }
    stl += "endloop\nendfacet\n";
  }
  scratch_.write("ball.stl", stl + "endsolid ball\n");
  scratch_.write("small.urdf",
                 replaced(urdf(), "<link name=\"root\"/>",
                          "<link name=\"root\"><collision><geometry><mesh filename=\"ball.stl\"/></geometry>"
                          "</collision></link>"));
  const config::LoadedRobot robot = load(replaced(kRobot, "collision:\n", "collision:\n  from: urdf\n"));
  const CollisionShape& shape = robot.model->shapes.back();
  ASSERT_TRUE(shape.shape.hull);
  EXPECT_LE(shape.shape.hull->vertices.size(), 192U);
  EXPECT_GE(shape.shape.hull->vertices.size(), 60U);
  const auto& vertices = shape.shape.hull->vertices;
  double outmost = -1.0;
  for (const Eigen::Vector3i& t : shape.shape.hull->triangles) {
    const Vector3& a = vertices[static_cast<std::size_t>(t[0])];
    const Vector3 n =
        (vertices[static_cast<std::size_t>(t[1])] - a).cross(vertices[static_cast<std::size_t>(t[2])] - a).normalized();
    for (const Vector3& p : points) outmost = std::max(outmost, n.dot(shape.X_LS.inverse() * p - a));
  }
  EXPECT_LT(outmost, 1e-5);  // the file has six digits
  EXPECT_LT(bounding_radius(shape.shape), 1.03);
}

}  // namespace
}  // namespace moma
