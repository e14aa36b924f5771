#include <gtest/gtest.h>

#include <map>
#include <set>

#include "controller/config/robot_file.h"
#include "controller/config/urdf_collision.h"
#include "controller/fit/fit_robot.h"
#include "fit_oracle.h"
#include "tests/support/robots.h"
#include "tests/support/scratch.h"

namespace moma {
namespace {

class FitRobots : public ::testing::TestWithParam<std::string> {};

// The block in a robot file of its own, loaded as any other, against the URDF's meshes on dense samples.
TEST_P(FitRobots, ShapesEncloseTheUrdfsGeometry) {
  const std::filesystem::path file = test::source_path(GetParam());
  const bool example = GetParam().starts_with("configs");
  const int max_shapes = example ? 3 : 1;  // the others have very many links
  const fit::RobotFit fit = fit::fit_robot(file, {max_shapes, {}});
  const test::Scratch scratch;
  std::string block;
  for (const char c : fit.collision) block += c == '\n' ? std::string("\n  ") : std::string(1, c);
  const auto written = scratch.write("fitted.yaml", "include: " + file.string() + "\ncollision:\n  " + block + "\n");
  const auto model = config::load_robot(written).model;
  EXPECT_EQ(model->shapes.size(), fit.after.shapes);
  EXPECT_EQ(model->self_pairs.size(), fit.after.pairs);
  std::map<std::string, std::vector<const CollisionShape*>> shapes;
  for (const CollisionShape& shape : model->shapes) {
    EXPECT_TRUE(shape.shape.kind != ShapeKind::kConvex && shape.shape.kind != ShapeKind::kCylinder) << shape.name;
    shapes[model->links[static_cast<std::size_t>(shape.link)].name].push_back(&shape);
  }

  const auto covered = [&](const std::string& link, const Vector3& p) {
    for (const CollisionShape* s : shapes[link])
      if (test::outside(s->shape, s->X_LS.translation(), s->X_LS.linear(), p) <= 1e-12) return true;
    return false;
  };
  std::size_t checked = 0;
  for (const config::UrdfCollision& element : config::load_urdf_collision(file)) {
    std::vector<Vector3> points;
    if (element.mesh.empty()) {
      const Vector3& s = element.shape.size;
      if (element.shape.kind != ShapeKind::kCylinder) continue;  // kept: below
      for (int i = 0; i < 400; ++i)
        for (const double end : {-0.5, 0.0, 0.5})
          points.emplace_back(s.x() * std::cos(0.1 * i), s.x() * std::sin(0.1 * i), end * s.y());
    }
    for (const Eigen::Vector3i& t : element.surface.triangles) {
      const auto at = [&](int i) { return element.surface.vertices[static_cast<std::size_t>(t[i])]; };
      for (const Vector3& p : test::points_on(at(0), at(1), at(2), 0.01)) points.push_back(p);
    }
    std::size_t out = 0;
    for (const Vector3& p : points)
      if (!covered(element.link, element.X_LS * p)) ++out;
    EXPECT_EQ(out, 0U) << element.link << " " << element.mesh << " of " << points.size();
    checked += points.size();
  }
  EXPECT_GT(checked, 10000U);

  for (const fit::LinkFit& link : fit.links) {
    EXPECT_EQ(link.error.uncovered, 0.0) << link.link;
    EXPECT_LE(link.fitted.size(), static_cast<std::size_t>(max_shapes)) << link.link;
    EXPECT_EQ(shapes[link.link].size(), link.kept.size() + link.fitted.size()) << link.link;
    if (link.fitted.empty()) continue;
    const bool moves = !shapes[link.link].front()->rigid_with_base;
    EXPECT_LT(link.error.mean_overshoot, example && moves ? 0.015 : 0.07) << link.link;
    EXPECT_LT(link.error.volume_ratio.value_or(1.0), example ? 2.0 : 2.5) << link.link;
  }
}

INSTANTIATE_TEST_SUITE_P(All, FitRobots, ::testing::ValuesIn(test::foreign_robots()),
                         [](const auto& robot) { return test::test_name(robot.param); });

// A mesh, a cylinder, boxes and a link that has shapes of its own in the file.
class FitRobot : public ::testing::Test {
 protected:
  static std::string collision(const std::string& geometry, const std::string& origin = "0 0 0") {
    return "<collision><origin xyz=\"" + origin + "\"/><geometry>" + geometry + "</geometry></collision>";
  }

  std::filesystem::path robot(const std::string& arm, const std::string& hand, const std::string& yaml) {
    scratch_.write("small.urdf", "<robot name=\"small\"><link name=\"root\"/><link name=\"arm\">" + arm +
                                     "</link><link name=\"hand\">" + hand + R"(</link>
<joint name="turn" type="revolute"><parent link="root"/><child link="arm"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" velocity="1.5" effort="80"/></joint>
<joint name="bend" type="revolute"><parent link="arm"/><child link="hand"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="1" velocity="1.5" effort="80"/></joint></robot>)");
    return scratch_.write("small.yaml", "urdf: small.urdf\narm: {tip: hand}\n" + yaml);
  }

  static std::string refused(const std::filesystem::path& file) {
    try {
      fit::fit_robot(file, {});
    } catch (const config::ConfigError& e) {
      return e.what();
    }
    return "nothing";
  }

  test::Scratch scratch_;
};

TEST_F(FitRobot, KeepsWhatIsSimpleAlready) {
  const auto file = robot(collision("<box size=\"0.1 0.2 0.3\"/>", "0.1 0 0") + collision("<sphere radius=\"0.05\"/>"),
                          collision("<cylinder radius=\"0.02\" length=\"0.3\"/>") + collision("<box size=\"1 1 1\"/>"),
                          "collision: {from: urdf, self: [[arm/2, hand]], self_stop: 0.02}\n");
  const fit::RobotFit fit = fit::fit_robot(file, {});
  ASSERT_EQ(fit.links.size(), 2U);
  EXPECT_TRUE(fit.links[0].fitted.empty());
  ASSERT_EQ(fit.links[0].kept.size(), 2U);
  EXPECT_EQ(fit.links[0].kept[0].solid.shape.size, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(fit.links[0].kept[0].position, Vector3(0.1, 0, 0));
  EXPECT_EQ(fit.links[0].had, "sphere, box");
  ASSERT_EQ(fit.links[1].fitted.size(), 1U);
  EXPECT_EQ(fit.links[1].fitted[0].solid.shape.kind, ShapeKind::kCapsule);
  EXPECT_EQ(fit.links[1].fitted[0].rpy, Vector3::Zero());
  EXPECT_NE(fit.collision.find("self: [[arm, hand]]\nself_stop: 0.02\n"), std::string::npos) << fit.collision;
}

TEST_F(FitRobot, LeavesShapesOfTheFileAlone) {
  const auto file = robot(collision("<cylinder radius=\"0.1\" length=\"0.1\"/>"),
                          collision("<cylinder radius=\"0.02\" length=\"0.3\"/>"),
                          "collision: {shapes: [{link: arm, shape: cylinder, size: [0.1, 0.1]}], from: urdf}\n");
  const fit::RobotFit fit = fit::fit_robot(file, {});
  ASSERT_EQ(fit.links.size(), 1U);
  EXPECT_EQ(fit.links[0].link, "hand");
  EXPECT_EQ(fit.own, std::vector<std::string>{"arm"});
  EXPECT_NE(fit.collision.find("{link: arm, shape: cylinder, size: [0.1, 0.1]}"), std::string::npos) << fit.collision;
}

// A flat round body: a box where it stands, something round where it drives.
TEST_F(FitRobot, ABaseThatTurnsGetsNoCorners) {
  const auto kind = [&](const std::string& base) {
    scratch_.write("round.urdf", "<robot name=\"round\"><link name=\"root\">" +
                                     collision("<cylinder radius=\"0.25\" length=\"0.3\"/>") +
                                     "</link><link name=\"arm\">" + collision("<sphere radius=\"0.05\"/>", "0 0 0.4") +
                                     R"(</link>
<joint name="turn" type="revolute"><parent link="root"/><child link="arm"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" velocity="1.5" effort="80"/></joint></robot>)");
    const auto file = scratch_.write("round.yaml", "urdf: round.urdf\narm: {tip: arm}\nbase: " + base + "\n");
    return fit::fit_robot(file, {1, {}}).links.at(0).fitted.at(0).solid.shape.kind;
  };
  EXPECT_EQ(kind("{type: fixed}"), ShapeKind::kBox);
  EXPECT_NE(kind("{type: omnidirectional, max_linear: 1, max_angular: 1, wheels: {radius: 0.1, separation: 0.4, "
                 "wheelbase: 0.4}}"),
            ShapeKind::kBox);
}

TEST_F(FitRobot, NeedsNoCollisionInTheFile) {
  const auto file = robot(collision("<cylinder radius=\"0.1\" length=\"0.1\"/>"), "", "");
  const fit::RobotFit fit = fit::fit_robot(file, {});
  EXPECT_EQ(fit.before.shapes, 0U);
  EXPECT_EQ(fit.after.shapes, fit.links.at(0).fitted.size());
}

TEST_F(FitRobot, EqualGeometryIsFittedOnceAndProgressIsTold) {
  const std::string cone = collision("<cylinder radius=\"0.02\" length=\"0.3\"/>") +
                           collision("<cylinder radius=\"0.1\" length=\"0.1\"/>", "0.1 0 0");
  std::string told;
  const auto tell = [&](const std::string& link, std::size_t number, std::size_t links) {
    told += link + " " + std::to_string(number) + "/" + std::to_string(links) + " ";
  };
  const fit::RobotFit same = fit::fit_robot(robot(cone, cone, "collision: {from: urdf}\n"), {}, tell);
  EXPECT_EQ(told, "arm 1/2 hand 2/2 ");
  ASSERT_EQ(same.links.size(), 2U);
  EXPECT_EQ(same.links[0].like, "");
  EXPECT_EQ(same.links[1].like, "arm");
  ASSERT_EQ(same.links[1].fitted.size(), same.links[0].fitted.size());
  for (std::size_t i = 0; i < same.links[0].fitted.size(); ++i) {
    EXPECT_EQ(same.links[1].fitted[i].solid.shape.size, same.links[0].fitted[i].solid.shape.size);
    EXPECT_EQ(same.links[1].fitted[i].position, same.links[0].fitted[i].position);
  }
  // A little further away is other geometry.
  const std::string moved = collision("<cylinder radius=\"0.02\" length=\"0.3\"/>") +
                            collision("<cylinder radius=\"0.1\" length=\"0.1\"/>", "0.1001 0 0");
  const fit::RobotFit other = fit::fit_robot(robot(cone, moved, "collision: {from: urdf}\n"), {});
  EXPECT_EQ(other.links.at(1).like, "");
}

TEST_F(FitRobot, SaysWhatIsMissing) {
  std::string why = refused(robot("", "", ""));
  EXPECT_NE(why.find("small.yaml:1:7: urdf: the URDF has no collision geometry"), std::string::npos) << why;
  why = refused(
      robot("", collision("<box size=\"1 1 1\"/>"), "collision: {shapes: [{link: hand, shape: sphere, size: 0.1}]}\n"));
  EXPECT_NE(why.find("nothing to fit"), std::string::npos) << why;
  why = refused(robot(collision("<mesh filename=\"gone.stl\"/>"), "", ""));
  EXPECT_NE(why.find("small.yaml:1:7: urdf: link arm: "), std::string::npos) << why;
  EXPECT_NE(why.find("gone.stl"), std::string::npos) << why;
  scratch_.write("bad.stl", "solid x\nthis is no mesh\n");
  why = refused(robot(collision("<mesh filename=\"bad.stl\"/>"), "", ""));
  EXPECT_NE(why.find("urdf: link arm: the mesh"), std::string::npos) << why;
  why = refused(scratch_.folder() / "nowhere.yaml");
  EXPECT_NE(why.find("nowhere.yaml"), std::string::npos) << why;
}

// Touching at `ready` is counted by links, with the shapes as they are.
TEST_F(FitRobot, CountsLinksInTouch) {
  scratch_.write("three.urdf", "<robot name=\"three\"><link name=\"root\">" +
                                   collision("<cylinder radius=\"0.1\" length=\"0.02\"/>") +
                                   "</link><link name=\"arm\"/><link name=\"hand\">" +
                                   collision("<box size=\"0.1 0.1 0.1\"/>") + R"(</link>
<joint name="turn" type="revolute"><parent link="root"/><child link="arm"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" velocity="1.5" effort="80"/></joint>
<joint name="bend" type="revolute"><parent link="arm"/><child link="hand"/><origin xyz="0.14 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" velocity="1.5" effort="80"/></joint></robot>)");
  const auto file = scratch_.write("three.yaml", "urdf: three.urdf\narm: {tip: hand}\ncollision: {from: urdf}\n");
  const fit::RobotFit fit = fit::fit_robot(file, {1, {true, false, false}});
  ASSERT_EQ(fit.before.touching.size(), 1U);  // 0.1 + 0.05 > 0.14
  EXPECT_EQ(fit.before.touching[0].first, "root");
  EXPECT_EQ(fit.before.touching[0].second, "hand");
  EXPECT_EQ(fit.after.touching, fit.before.touching);
}

}  // namespace
}  // namespace moma
