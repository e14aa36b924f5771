#include "controller/model/urdf.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace moma::test {
namespace {

TEST(UrdfVisual, PlacesColoursAndMeshesAsTheFileHasThem) {
  std::ifstream in(MOMA_SOURCE_DIR "/tests/data/looks/cart.urdf");
  std::ostringstream text;
  text << in.rdbuf();
  const std::vector<UrdfVisual> visuals = read_urdf_visuals(text.str());
  ASSERT_EQ(visuals.size(), 3u) << "and no collision element";
  EXPECT_EQ(visuals[0].link, "chassis");
  EXPECT_EQ(visuals[0].geometry.mesh, "wedge.stl");
  EXPECT_EQ(visuals[0].geometry.scale, Vector3(2, 1, 1));
  EXPECT_NEAR((visuals[0].geometry.X_LS.linear() * Vector3::UnitX() - Vector3::UnitY()).norm(), 0.0, 1e-12);
  EXPECT_EQ(visuals[0].geometry.X_LS.translation(), Vector3(0, 0, 0.1));
  ASSERT_TRUE(visuals[0].colour.has_value()) << "by name";
  EXPECT_EQ(*visuals[0].colour, Vector3(1, 0.5, 0));
  EXPECT_EQ(visuals[1].geometry.mesh, "");
  EXPECT_EQ(visuals[1].geometry.shape.kind, ShapeKind::kBox);
  EXPECT_FALSE(visuals[1].colour.has_value());
  EXPECT_EQ(visuals[2].link, "arm");
  ASSERT_TRUE(visuals[2].colour.has_value()) << "its own";
  EXPECT_EQ(*visuals[2].colour, Vector3(0.2, 0.4, 0.6));
}

TEST(UrdfVisual, RefusesWhatIsNoUrdfAndLeavesOutWhatIsNoShape) {
  EXPECT_THROW(read_urdf_visuals("<robot"), UrdfError);
  EXPECT_TRUE(read_urdf_visuals(R"(<robot name="a"><link name="b"/></robot>)").empty());
  const auto of = [](const std::string& size) {
    return read_urdf_visuals(R"(<robot name="a"><link name="b"><visual><geometry><box size=")" + size +
                             R"("/></geometry></visual></link></robot>)");
  };
  EXPECT_EQ(of("1 2 3").size(), 1u);
  EXPECT_EQ(of("1 -2 3").size(), 0u);
}

}  // namespace
}  // namespace moma::test
