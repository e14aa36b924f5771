#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "controller/model/urdf.h"

namespace moma {
namespace {

namespace fs = std::filesystem;

// Everything in the package example-robot-data that is a URDF at all can be read.
TEST(Urdf, ReadsEveryRobotOfTheCollection) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& python : fs::directory_iterator(fs::path(MOMA_SOURCE_DIR) / ".venv/lib", error)) {
    const fs::path robots = python.path() / "site-packages/cmeel.prefix/share/example-robot-data/robots";
    for (const auto& entry : fs::recursive_directory_iterator(robots, error))
      if (entry.path().extension() == ".urdf") files.push_back(entry.path());
  }
  ASSERT_GT(files.size(), 60U) << "scripts/setup.sh fetches example-robot-data";
  std::sort(files.begin(), files.end());
  int read = 0;
  for (const fs::path& file : files) {
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    if (file.filename() == "ur3.urdf") {  // a xacro template without a single link
      EXPECT_THROW(read_urdf(text.str()), UrdfError);
      continue;
    }
    try {
      // so101.urdf has an <origin> in a link, which no reader knows.
      const bool lenient = file.filename() == "so101.urdf";
      const UrdfTree tree = read_urdf(text.str(), lenient ? UrdfReading::kLenient : UrdfReading::kStrict);
      EXPECT_EQ(tree.left_out.size(), lenient ? 1U : 0U);
      EXPECT_FALSE(tree.links.empty());
      for (std::size_t i = 0; i < tree.links.size(); ++i) EXPECT_LT(tree.links[i].parent, static_cast<int>(i));
      ++read;
    } catch (const UrdfError& e) {
      ADD_FAILURE() << file << ": " << e.what();
    }
  }
  EXPECT_GT(read, 60);
}

const char* const kText = R"(<robot name="two">
  <material name="steel"><color rgba="oops"/></material>
  <link name="a"><visual><geometry><mesh/></geometry></visual></link>
  <link name="b">
    <inertial><origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><mass value="2"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="3"/></inertial>
    <collision><origin xyz="0 0 1"/><geometry><cylinder radius="0.1" length="0.4"/></geometry></collision>
    <collision><geometry><mesh filename="package://x/y.stl" scale="2 2 2"/></geometry></collision>
  </link>
  <joint name="j" type="revolute">
    <parent link="a"/><child link="b"/><origin xyz="1 2 3"/><axis xyz="3 0 4"/><limit velocity="2"/>
  </joint>
  <transmission name="t"><joint name="j"/></transmission>
</robot>)";

TEST(Urdf, TakesWhatIsThereAndNoMore) {
  const UrdfTree tree = read_urdf(kText);  // broken visuals and materials do not matter
  EXPECT_EQ(tree.name, "two");
  ASSERT_EQ(tree.links.size(), 2U);
  const UrdfLink& b = tree.links[1];
  EXPECT_EQ(b.joint.X_PJ.translation(), Vector3(1, 2, 3));
  EXPECT_LT((b.joint.axis - Vector3(0.6, 0, 0.8)).norm(), 1e-15);
  EXPECT_FALSE(b.joint.lower || b.joint.upper || b.joint.effort);
  EXPECT_EQ(b.joint.velocity, 2.0);
  ASSERT_TRUE(b.inertial.has_value());
  EXPECT_EQ(b.inertial->com_L, Vector3(0.1, 0.2, 0.3));
  EXPECT_LT((b.inertial->I_C.diagonal() - Vector3(2, 1, 3)).norm(), 1e-12);  // turned a quarter about z
  ASSERT_EQ(b.collision.size(), 2U);
  EXPECT_EQ(b.collision[0].shape.kind, ShapeKind::kCylinder);
  EXPECT_EQ(b.collision[0].shape.size, Vector3(0.1, 0.4, 0));
  EXPECT_EQ(b.collision[1].mesh, "package://x/y.stl");
  EXPECT_EQ(b.collision[1].scale, Vector3(2, 2, 2));
}

TEST(Urdf, RefusesASecondRobotAndTheBasesName) {
  const std::string good = R"(<robot name="r"><link name="a"/></robot>)";
  EXPECT_EQ(read_urdf(good).links.size(), 1U);
  const auto refused = [](const std::string& text) -> std::string {
    try {
      read_urdf(text);
    } catch (const UrdfError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_NE(refused(good + "<robot name=\"z\"/>").find("after </robot> stands <robot>"), std::string::npos);
  EXPECT_NE(refused(R"(<robot name="r"><link name="@base"/></robot>)").find("is called @base"), std::string::npos);
}

// Cut off anywhere, or with any one byte changed, a URDF is read or refused, and nothing else.
TEST(Urdf, DamageIsRefusedOrHarmless) {
  const std::string text = kText;
  for (std::size_t i = 0; i < text.size(); i += 7) {
    std::string changed = text;
    changed[i] = static_cast<char>("<>/\"0\n\xff-"[i % 8]);
    for (const std::string& damaged : {text.substr(0, i), changed}) {
      try {
        const UrdfTree tree = read_urdf(damaged);
        EXPECT_FALSE(tree.links.empty());
      } catch (const UrdfError& e) {
        EXPECT_STRNE(e.what(), "");
      }
    }
  }
}

// b has a sphere and a mass besides; nothing of it may go with what is not understood.
UrdfTree read_b(const char* in_b, UrdfReading reading) {
  return read_urdf(std::string("<robot name='r'><link name='a'/><link name='b'>\n") + in_b +
                       "\n<collision><geometry><sphere radius='0.2'/></geometry></collision></link>"
                       "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint></robot>",
                   reading);
}

TEST(Urdf, WhatIsNotUnderstoodIsAnErrorAndNeverDroppedInSilence) {
  const char* const kMass = "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
  const std::string bad_mass = std::string("<inertial><mass value='x'/>") + kMass;
  const std::string negative = std::string("<inertial><mass value='-1'/>") + kMass;
  const std::string no_mass = std::string("<inertial>") + kMass;
  const std::string comma =
      "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1,5'/></inertial>";
  const std::string twice = std::string("<inertial><mass value='1'/>") + kMass + "<inertial><mass value='1'/>" + kMass;
  const auto shape = [](const std::string& geometry) {
    return "<collision><geometry>" + geometry + "</geometry></collision>";
  };
  const std::vector<std::pair<std::string, std::string>> shapes = {
      {"<sphere radius='abc'/>", "sphere radius=\"abc\" is not understood; expected a number"},
      {"<sphere radius='0,5'/>", "sphere radius=\"0,5\""},
      {"<sphere radius='0x1p3'/>", "sphere radius"},
      {"<sphere radius='inf'/>", "sphere radius"},
      {"<sphere radius='1 2'/>", "sphere radius"},
      {"<sphere radius='-1'/>", "every size must be above 0"},
      {"<sphere radius='1e-320'/>", "every size must be above 0"},
      {"<sphere/>", "sphere radius is missing"},
      {"<box size='1 1'/>", "expected 3 numbers"},
      {"<box size='1,1,1'/>", "expected 3 numbers"},
      {"<cylinder radius='1'/>", "cylinder length is missing"},
      {"<mesh/>", "mesh filename is missing"},
      {"<mesh filename=''/>", "mesh filename is missing"},
      {"<mesh filename='m.stl' scale='nan 1 1'/>", "mesh scale"},
      {"<mesh filename='m.stl' scale='1 1'/>", "mesh scale"},
      {"<mesh filename='m.stl' sclae='1 1 1'/>", "the attribute 'sclae' of <mesh>"},
      {"<capsule radius='1' length='1'/>", "<capsule> is not understood; expected box, cylinder, sphere or mesh"},
      {"", "<geometry> holds no shape"},
      {"<box size='1 1 1'/><sphere radius='0.2'/>", "more than one shape"},
      {"<xacro:hand/>", "<xacro:hand> is not understood"},
  };
  std::vector<std::pair<std::string, std::string>> cases = {
      {"<collision/>", "collision 1: there is no <geometry>"},
      {"<colision><geometry><box size='1 1 1'/></geometry></colision>", "<colision> is not understood"},
      {"<collision><orgin xyz='0 0 1'/><geometry><box size='1 1 1'/></geometry></collision>", "<orgin>"},
      {"<collision><origin xyz='0 0'/><geometry><box size='1 1 1'/></geometry></collision>", "origin xyz=\"0 0\""},
      {"<collision><origin rpy='0 0 a'/><geometry><box size='1 1 1'/></geometry></collision>", "origin rpy"},
      {bad_mass, "link b, inertial: mass value=\"x\""},
      {negative, "the mass must not be negative"},
      {no_mass, "there is no <mass>"},
      {comma, "inertia izz=\"1,5\""},
      {twice, "a second <inertial>"},
      {"<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0.1' izz='1' izy='0.2'/></inertial>",
       "izy differs from iyz"},
  };
  for (const auto& [geometry, words] : shapes) cases.emplace_back(shape(geometry), words);
  for (const auto& [inside, words] : cases) {
    try {
      read_b(inside.c_str(), UrdfReading::kStrict);
      ADD_FAILURE() << "accepted: " << inside;
    } catch (const UrdfError& e) {
      const std::string message = e.what();
      EXPECT_NE(message.find("line 2: link b"), std::string::npos) << message;
      EXPECT_NE(message.find(words), std::string::npos) << message;
      EXPECT_NE(message.find("--lenient"), std::string::npos) << message;
    }
    const UrdfTree tree = read_b(inside.c_str(), UrdfReading::kLenient);
    ASSERT_GE(tree.left_out.size(), 1U) << inside;
    EXPECT_NE(tree.left_out[0].find(words), std::string::npos) << tree.left_out[0];
    ASSERT_EQ(tree.links[1].collision.size(), 1U) << inside;
    EXPECT_EQ(tree.links[1].collision[0].shape.size.x(), 0.2);
    EXPECT_EQ(tree.links[1].inertial.has_value(), words == "a second <inertial>") << inside;
  }
  const UrdfTree good = read_b(
      "<inertial><mass value='+2e0'/><inertia ixx='1' ixy='0.1' ixz='0' iyy='1' iyz='0' izz='1' iyx='0.10'/>"
      "</inertial><collision><geometry><mesh filename='m.stl' scale='-1 1 1'/></geometry>"
      "<drake:proximity/><surface><friction><ode><mu>1</mu></ode></friction></surface></collision>",
      UrdfReading::kStrict);
  EXPECT_EQ(good.links[1].inertial->mass, 2.0);
  EXPECT_EQ(good.links[1].collision.size(), 2U);
}

TEST(Urdf, JointsToo) {
  const auto message = [](const std::string& in_joint) -> std::string {
    try {
      read_urdf(
          "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='revolute'><parent link='a'/>"
          "<child link='b'/>" +
          in_joint + "</joint></robot>");
    } catch (const UrdfError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message("<axis xyz='0 0 1'/><limit lower='0' upper='1' velocity='1' effort='1'/>"), "accepted");
  EXPECT_NE(message("<orgin xyz='0 0 1'/>").find("joint j: <orgin> is not understood"), std::string::npos);
  EXPECT_NE(message("<limit lover='-1' upper='1'/>").find("the attribute 'lover' of <limit>"), std::string::npos);
  EXPECT_NE(message("<axis xyz='0 0 1'/><axis xyz='0 1 0'/>").find("a second <axis>"), std::string::npos);
}

TEST(Urdf, HasLimits) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      read_urdf(text);
    } catch (const UrdfError& e) {
      return e.what();
    }
    return "accepted";
  };
  std::string links = "<robot name='r'><link name='l0'/>";
  for (int i = 1; i < 1100; ++i) {
    links += "<link name='l" + std::to_string(i) + "'/><joint name='j" + std::to_string(i) +
             "' type='fixed'><parent link='l0'/><child link='l" + std::to_string(i) + "'/></joint>";
  }
  EXPECT_NE(message(links + "</robot>").find("more than 1000 links"), std::string::npos);
  std::string shapes = "<robot name='r'><link name='a'>";
  for (int i = 0; i < 257; ++i) shapes += "<collision><geometry><sphere radius='1'/></geometry></collision>";
  EXPECT_NE(message(shapes + "</link></robot>").find("more than 256 collision elements"), std::string::npos);
  std::string deep = "<robot name='r'>";
  for (int i = 0; i < 50'000; ++i) deep += "<a b='/>'>";
  EXPECT_NE(message(deep).find("nested more than 200 deep"), std::string::npos);
}

// Said before urdfdom sees them, which would never free them.
TEST(Urdf, LoopsAreRefused) {
  const auto message = [](const std::vector<std::pair<std::string, std::string>>& joints) -> std::string {
    std::string text = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><link name='d'/>";
    for (const auto& [parent, child] : joints)
      text += "<joint name='" + parent + child + "' type='fixed'><parent link='" + parent + "'/><child link='" + child +
              "'/></joint>";
    try {
      read_urdf(text + "</robot>");
    } catch (const UrdfError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({{"d", "c"}, {"c", "b"}, {"b", "a"}}), "accepted");
  const std::string loop = " hangs on itself, by joints that form a loop";
  EXPECT_EQ(message({{"a", "a"}}), "link a" + loop);
  EXPECT_EQ(message({{"a", "b"}, {"b", "a"}, {"c", "d"}}), "link a" + loop);
  EXPECT_EQ(message({{"b", "c"}, {"c", "d"}, {"d", "b"}, {"b", "a"}}), "link b" + loop);  // a only hangs on it
}

TEST(Urdf, XacroIsHintedAt) {
  try {
    read_urdf("<robot name='a'><xacro:include filename='b'/></robot>");
    FAIL();
  } catch (const UrdfError& e) {
    EXPECT_NE(std::string(e.what()).find("expand it with xacro first"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace moma
