#include "controller/config/mesh_hull.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "controller/config/convex_hull.h"
#include "controller/config/robot_file.h"
#include "controller/config/urdf_collision.h"
#include "tests/support/scratch.h"

namespace moma {
namespace {

// Nothing below asks the code under test how far anything is: bodies are compared by their support functions, of which
// the greatest difference is the Hausdorff distance of convex bodies.
double support(const std::vector<Vector3>& points, const Vector3& n) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Vector3& p : points) most = std::max(most, n.dot(p));
  return most;
}

std::vector<Vector3> directions(int count) {
  std::vector<Vector3> all;
  for (int k = 0; k < count; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / count;
    const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0)) * k;
    all.emplace_back(std::sqrt(1.0 - z * z) * std::cos(turn), std::sqrt(1.0 - z * z) * std::sin(turn), z);
  }
  return all;
}

std::vector<Vector3> corners_of(const config::MeshSolid& solid) {
  std::vector<Vector3> corners;
  if (solid.shape.hull) {
    corners = solid.shape.hull->vertices;
  } else {
    for (int i = 0; i < 8; ++i)
      corners.push_back(0.5 * Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(solid.shape.size));
  }
  for (Vector3& p : corners) p = solid.X_MS * p;
  return corners;
}

struct Reach {
  double out = -1.0;  ///< greatest support of the solid beyond that of the points [m]
  double in = 1.0;    ///< least; below 0 where a point is outside
};

Reach reach_of(const config::MeshSolid& solid, const std::vector<Vector3>& points) {
  const std::vector<Vector3> corners = corners_of(solid);
  std::vector<Vector3> all = directions(1000);
  // Uncovered points show first in the directions of the solid's own faces.
  if (solid.shape.hull) {
    for (const Eigen::Vector3i& t : solid.shape.hull->triangles) {
      const auto at = [&](int i) { return corners[static_cast<std::size_t>(t[i])]; };
      const Vector3 area = (at(1) - at(0)).cross(at(2) - at(0));
      if (area.norm() > 1e-9) all.push_back(area.normalized());
    }
  }
  Reach reach;
  for (const Vector3& n : all) {
    const double beyond = support(corners, n) - support(points, n);
    reach.out = std::max(reach.out, beyond);
    reach.in = std::min(reach.in, beyond);
  }
  return reach;
}

class Arms : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Packages, Arms,
                         testing::Values("panda_description/urdf/panda.urdf", "ur_description/urdf/ur3_robot.urdf",
                                         "ur_description/urdf/ur5_robot.urdf", "ur_description/urdf/ur10_robot.urdf",
                                         "kinova_description/robots/kinova.urdf", "xarm_description/urdf/xarm7.urdf",
                                         "z1_description/urdf/z1.urdf", "so_arm_description/urdf/so100.urdf",
                                         "so_arm_description/urdf/so101.urdf", "tiago_description/robots/tiago.urdf",
                                         "pr2_description/urdf/pr2.urdf", "baxter_description/urdf/baxter.urdf"),
                         [](const auto& arm) { return std::filesystem::path(arm.param).stem().string(); });

TEST_P(Arms, HullsContainTheirMeshesAndReachOutByThreeMillimetresAtMost) {
  const test::Scratch scratch;
  const auto file = scratch.write("arm.yaml", "include: " + std::string(MOMA_SOURCE_DIR) +
                                                  "/configs/robots/examples/panda.yaml\n"
                                                  "lenient: true\nurdf: package://example-robot-data/robots/" +
                                                  GetParam() + "\n");
  int hulls = 0;
  std::set<std::string> seen;
  for (const config::UrdfCollision& element : config::load_urdf_collision(file)) {
    if (element.mesh.empty() || !seen.insert(element.mesh).second) continue;
    const config::MeshSolid solid = config::point_solid(element.surface.vertices);
    EXPECT_FALSE(solid.flat) << element.mesh;
    EXPECT_TRUE(config::is_hull(*solid.shape.hull)) << element.mesh;  // or a frozen world would refuse it
    const Reach reach = reach_of(solid, element.surface.vertices);
    EXPECT_LE(reach.out, 3e-3) << element.mesh;
    EXPECT_GE(reach.in, -1e-8) << element.mesh;
    EXPECT_LE(reach.out, solid.excess + 1e-8) << element.mesh << ": more than it says";
    EXPECT_GE(1.2 * reach.out, solid.excess - 1e-6) << element.mesh << ": less than it says";
    ++hulls;
  }
  EXPECT_GE(hulls, 2);
}

std::vector<Vector3> ring(int count, double radius, double z) {
  std::vector<Vector3> points;
  for (int i = 0; i < count; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / count;
    points.emplace_back(radius * std::cos(turn), radius * std::sin(turn), z);
  }
  return points;
}

// All of a fine disc's rim meets in one vertex of its hull, which coal cannot count.
TEST(MeshHull, FineDiscIsNoBox) {
  std::vector<Vector3> points = ring(1000, 0.1, 0.0);
  for (const Vector3& p : ring(1000, 0.1, 0.02)) points.push_back(p);
  const config::MeshSolid solid = config::point_solid(points);
  EXPECT_FALSE(solid.flat);
  ASSERT_TRUE(solid.shape.hull);
  const Reach reach = reach_of(solid, points);
  EXPECT_LE(reach.out, 5e-4);
  EXPECT_GE(reach.in, -1e-9);
}

TEST(MeshHull, SameBitsForTheSamePointsAtAnySize) {
  for (const double scale : {1e-2, 1.0, 1e3}) {
    std::vector<Vector3> points;
    for (const Vector3& n : directions(2500)) points.push_back(scale * n.cwiseProduct(Vector3(1.0, 0.5, 0.01)));
    for (int i = 0; i < 100; ++i) points.push_back(points.front());  // corners that occur again, as in .stl
    const config::MeshSolid solid = config::point_solid(points);
    const config::MeshSolid again = config::point_solid(points);
    ASSERT_TRUE(solid.shape.hull);
    EXPECT_EQ(solid.shape.hull->vertices, again.shape.hull->vertices);
    EXPECT_EQ(solid.shape.hull->triangles, again.shape.hull->triangles);
    EXPECT_LE(solid.shape.hull->vertices.size(), 192U);
    const Reach reach = reach_of(solid, points);
    EXPECT_LE(reach.out, 0.05 * scale);
    EXPECT_GE(reach.in, -1e-9 * scale);
    EXPECT_LE(reach.out, solid.excess + 1e-9 * scale);
  }
}

TEST(MeshHull, NeedlesAndPlatesAreEnclosed) {
  for (const Vector3& size : {Vector3(1.0, 1e-5, 1e-5), Vector3(1.0, 1.0, 1e-5), Vector3(1.0, 1e-3, 1e-5)}) {
    std::vector<Vector3> points;
    for (const Vector3& n : directions(1500)) points.push_back(Vector3(3.0, -2.0, 1.0) + n.cwiseProduct(size));
    const config::MeshSolid solid = config::point_solid(points);
    const Reach reach = reach_of(solid, points);
    EXPECT_GE(reach.in, -1e-8) << size.transpose();
    EXPECT_LE(reach.out, 0.02) << size.transpose();
  }
}

TEST(MeshHull, RobotSaysHowFarItsHullsReachOut) {
  const config::LoadedRobot robot =
      config::load_robot(std::string(MOMA_SOURCE_DIR) + "/configs/robots/examples/panda.yaml");
  int said = 0;
  for (const std::string& note : robot.notes) said += note.find(" exceeds the exact hull of ") != std::string::npos;
  EXPECT_EQ(said, 9) << "links 0 to 7 and the hand have more than 96 vertices each";
}

}  // namespace
}  // namespace moma
