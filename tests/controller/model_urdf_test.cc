#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

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
      const UrdfTree tree = read_urdf(text.str());
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
