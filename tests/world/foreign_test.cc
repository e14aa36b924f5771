// Problems of other programs as worlds.
#include "world/scenario/foreign.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controller/config/node.h"
#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "tests/support/scratch.h"
#include "tests/world/support.h"
#include "world/world_json.h"

namespace moma {
namespace {

using test::robot;

constexpr const char* kScene = R"(name: kitchen
robot_state:
  attached_collision_objects:
    - link_name: panda_hand
      object:
        header: {frame_id: panda_hand}
        id: cup
        pose: {position: [0, 0, 0.1], orientation: [0, 0, 0, 1]}
        primitives: [{type: cylinder, dimensions: [0.1, 0.03]}]
        primitive_poses: [{position: [0, 0.01, 0], orientation: [0.70710678, 0, 0, 0.70710678]}]
      touch_links: [panda_hand, panda_link6, gripper_pad]
world:
  collision_objects:
    - header: {frame_id: panda_link0}
      id: table
      primitives: [{type: box, dimensions: [0.8, 1.2, 0.05]}]
      primitive_poses: [{position: [0.6, 0, 0.3], orientation: [0, 0, 0.70710678, 0.70710678]}]
    - header: {frame_id: world}
      id: can
      pose: {position: {x: 0.5, y: 0.1, z: 0.4}, orientation: {x: 0, y: 0, z: 0, w: 1}}
      primitives: [{type: 3, dimensions: [0.12, 0.03]}, {type: sphere, dimensions: [0.05]}]
      primitive_poses:
        - {position: [0, 0, 0], orientation: [0, 0, 0, 1]}
        - {position: {x: 0, y: 0, z: 0.2}, orientation: {x: 0, y: 0, z: 0, w: 1}}
    - id: wall
      planes: [{coef: [-1, 0, 0, 0.9]}]
      plane_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]
    - id: mug
      meshes: [{vertices: [{x: 0, y: 0, z: 0}, {x: 0.1, y: 0, z: 0}, {x: 0, y: 0.2, z: 0}, {x: 0, y: 0, z: 0.3}],
                triangles: [{vertex_indices: [0, 1, 2]}]}]
      mesh_poses: [{position: [0.4, -0.3, 0.5], orientation: [0, 0, 0, 1]}]
)";

constexpr const char* kRequest = R"(group_name: arm
start_state:
  joint_state:
    name: [panda_joint2, panda_joint1]
    position: [-0.5, 0.3]
goal_constraints:
  - joint_constraints:
      - {joint_name: panda_joint7, position: 0.7}
      - {joint_name: panda_joint1, position: 0.1}
      - {joint_name: panda_joint2, position: -0.2}
      - {joint_name: panda_joint3, position: 0.3}
      - {joint_name: panda_joint4, position: -1.4}
      - {joint_name: panda_joint5, position: 0.5}
      - {joint_name: panda_joint6, position: 1.6}
)";

const WorldObject& object_named(const World& world, const std::string& name) {
  for (const WorldObject& object : world.objects)
    if (object.name == name) return object;
  ADD_FAILURE() << name;
  return world.objects.front();
}

bool noted(const ForeignWorlds& found, const std::string& text) {
  for (const std::string& note : found.notes)
    if (note.find(text) != std::string::npos) return true;
  return false;
}

class Foreign : public testing::Test {
 protected:
  std::string message(const std::vector<std::filesystem::path>& files) {
    try {
      read_foreign(panda_, files);
    } catch (const config::ConfigError& e) {
      return e.what();
    }
    return "";
  }

  test::Scratch scratch_;
  std::shared_ptr<const RobotModel> panda_ = robot("panda");
};

TEST_F(Foreign, MoveItsMessages) {
  const ForeignWorlds found =
      read_foreign(panda_, {scratch_.write("scene.yaml", kScene), scratch_.write("request.yaml", kRequest)});
  ASSERT_EQ(found.worlds.size(), 1U);
  const World& world = found.worlds[0];
  EXPECT_EQ(world.family, "kitchen");
  ASSERT_EQ(world.objects.size(), 6U);
  Kinematics kinematics(panda_);
  kinematics.update(Vector3::Zero(), panda_->ready);
  const Isometry X_WR = kinematics.X_WL(panda_->find_link("panda_link0"));

  const WorldObject& table = object_named(world, "table");
  EXPECT_EQ(table.shape.size, Vector3(0.8, 1.2, 0.05));
  EXPECT_LT((table.X_WO.translation() - X_WR * Vector3(0.6, 0, 0.3)).norm(), 1e-9);
  EXPECT_LT((table.X_WO.linear() * Vector3::UnitX() - X_WR.linear() * Vector3::UnitY()).norm(), 1e-6);
  const WorldObject& can = object_named(world, "can/1");
  EXPECT_EQ(can.shape.kind, ShapeKind::kCylinder);
  EXPECT_EQ(can.shape.size.x(), 0.03) << "the message has the height first";
  EXPECT_EQ(can.shape.size.y(), 0.12);
  EXPECT_LT((object_named(world, "can/2").X_WO.translation() - X_WR * Vector3(0.5, 0.1, 0.6)).norm(), 1e-9);
  // The wall is where x > 0.9: its slab begins there.
  const WorldObject& wall = object_named(world, "wall");
  EXPECT_NEAR(extent_along(wall.shape, wall.X_WO, -X_WR.linear().col(0)),
              -X_WR.linear().col(0).dot(X_WR * Vector3(0.9, 0, 0)), 1e-9);
  const WorldObject& mug = object_named(world, "mug");
  ASSERT_EQ(mug.shape.kind, ShapeKind::kConvex);
  EXPECT_EQ(mug.shape.hull->vertices.size(), 4U);
  EXPECT_LT((mug.X_WO.translation() - X_WR * Vector3(0.45, -0.2, 0.65)).norm(), 1e-8);
  EXPECT_NEAR(extent_along(mug.shape, mug.X_WO, X_WR.linear().col(0)),
              X_WR.linear().col(0).dot(X_WR * Vector3(0.5, -0.3, 0.5)), 1e-8);

  // The cup moves with the hand: it is where that is at the start of the request, not at `ready`.
  ASSERT_TRUE(world.held.has_value());
  EXPECT_EQ(world.held->object, "cup");
  EXPECT_EQ(world.held->touch, (std::vector<std::string>{"panda_hand", "panda_link6"}));
  const WorldObject& cup = object_named(world, "cup");
  EXPECT_EQ(cup.shape.size.head<2>(), Vector2(0.03, 0.1));
  kinematics.update(world.start.base, world.start.q);
  const Isometry& X_WH = kinematics.X_WL(panda_->find_link("panda_hand"));
  EXPECT_LT((cup.X_WO.translation() - X_WH * Vector3(0, 0.01, 0.1)).norm(), 1e-9);
  EXPECT_LT((cup.X_WO.linear().col(2) + X_WH.linear().col(1)).norm(), 1e-6);
  EXPECT_EQ(to_json(world_from_json(to_json(world), "again")).dump(), to_json(world).dump());

  EXPECT_EQ(world.start.q[0], 0.3);
  EXPECT_EQ(world.start.q[1], -0.5);
  EXPECT_EQ(world.start.q[3], panda_->ready[3]);
  EXPECT_EQ(world.witness.q[6], 0.7);
  kinematics.update(Vector3::Zero(), world.witness.q);
  EXPECT_LT((kinematics.X_WE().matrix() - world.goal.X_WG.matrix()).norm(), 1e-12);
  for (const char* text : {"attached objects are in the hand from the start: cup",
                           "touch_links that are no links of the robot are left out: gripper_pad",
                           "meshes are the convex hulls of their vertices: mug (0.1 x 0.2 x 0.3 m, not watertight)",
                           "planes are slabs", "replaced by its root: world"})
    EXPECT_TRUE(noted(found, text)) << text;
}

// An angle of two plates 0.4 m long, in both forms of a scene, and as a frozen world.
TEST_F(Foreign, MeshesBecomeConvexHulls) {
  const double outline[6][2] = {{0, 0}, {0.3, 0}, {0.3, 0.02}, {0.02, 0.02}, {0.02, 0.3}, {0, 0.3}};
  std::string vertices, triangles, text;
  for (const double y : {0.0, 0.4})
    for (const auto& p : outline) {
      const std::string numbers = fmt::format("{}, {}, {}", p[0], y, p[1]);
      vertices += (vertices.empty() ? "[" : ", [") + numbers + "]";
      text += fmt::format("{} {} {}\n", p[0], y, p[1]);
    }
  const auto triangle = [&](int a, int b, int c) {
    triangles += fmt::format("{}{{vertex_indices: [{}, {}, {}]}}", triangles.empty() ? "" : ", ", a, b, c);
    text += fmt::format("{} {} {}\n", a, b, c);
  };
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    triangle(i, i + 6, j);
    triangle(j, i + 6, j + 6);
    if (i < 1 || i > 4) continue;
    triangle(0, i, i + 1);
    triangle(6, i + 7, i + 6);
  }
  const std::string message = "world: {collision_objects: [{id: angle, meshes: [{vertices: [" + vertices +
                              "], triangles: [" + triangles +
                              "]}], mesh_poses: [{position: [0.4, -0.3, 0.5], orientation: [0, 0, 0, 1]}]}]}\n";
  const auto request = scratch_.write("request.yaml", kRequest);
  const ForeignWorlds found = read_foreign(panda_, {scratch_.write("angle.yaml", message), request});
  const World world = found.worlds.at(0);
  ASSERT_EQ(world.objects.size(), 1U);
  EXPECT_EQ(world.objects[0].name, "angle");
  // The hull's outline has 0.3^2 - 0.28^2 / 2 m^2, that of the plates 2 * 0.3 * 0.02 - 0.02^2.
  EXPECT_TRUE(noted(found, "angle (0.3 x 0.4 x 0.3 m, watertight, its hull has 4.38 times its volume)"))
      << found.notes.at(0);
  Kinematics kinematics(panda_);
  kinematics.update(Vector3::Zero(), panda_->ready);
  const Isometry X_WR = kinematics.X_WL(panda_->find_link("panda_link0"));
  const Shape ball{ShapeKind::kSphere, Vector3(0.05, 0, 0), nullptr};
  const auto gap = [&](const World& of, const Vector3& p) {
    Isometry X = Isometry::Identity();
    X.translation() = X_WR * p;
    double least = 1e9;
    for (const WorldObject& object : of.objects)
      least = std::min(least, shape_distance(ball, X, object.shape, object.X_WO).d);
    return least;
  };
  // Beyond the slope x + z = 0.32 of the hull, above the plates, and off their end.
  EXPECT_NEAR(gap(world, {0.7, -0.1, 0.8}), 0.28 / std::sqrt(2.0) - 0.05, 1e-6);
  EXPECT_NEAR(gap(world, {0.41, -0.1, 0.9}), 0.1 - 0.05, 1e-6);
  EXPECT_NEAR(gap(world, {0.45, 0.4, 0.55}), 0.3 - 0.05, 1e-6);
  EXPECT_LT(gap(world, {0.5, -0.1, 0.6}), 0.0);

  // Back from its file: the same bits, and the same body without the hull's triangles.
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(to_json(world).dump());
  const World again = world_from_json(json, "angle");
  EXPECT_EQ(to_json(again).dump(), json.dump());
  for (auto& object : json["objects"]) object.erase("triangles");
  EXPECT_NEAR(gap(world_from_json(json, "angle"), {0.7, -0.1, 0.8}), gap(world, {0.7, -0.1, 0.8}), 1e-6);
  const auto refused = [](nlohmann::ordered_json changed, const char* key, const nlohmann::ordered_json& value) {
    changed["objects"][0][key] = value;
    EXPECT_THROW(world_from_json(changed, "angle"), config::ConfigError) << value.dump();
  };
  json["objects"][0]["vertices"] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const nlohmann::ordered_json tetrahedron = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  json["objects"][0]["triangles"] = tetrahedron;
  EXPECT_EQ(world_from_json(json, "angle").objects[0].shape.hull->triangles.size(), 4U);
  refused(json, "triangles", {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});            // inside out
  refused(json, "triangles", {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {0, 3, 2}});            // open
  refused(json, "triangles", {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}});            // none
  refused(json, "vertices", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 2, 2}});  // one that no triangle uses
  json["objects"][0].erase("triangles");
  json["objects"][0]["vertices"] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_THROW(world_from_json(json, "angle"), config::ConfigError) << "a hull without volume";

  const auto scene =
      scratch_.write("angle.scene", "shop\n* angle\n1\nmesh\n12 20\n" + text + "0.4 -0.3 0.5\n0 0 0 1\n0 0 0 0\n.\n");
  EXPECT_EQ(to_json(read_foreign(panda_, {scene, request}).worlds.at(0))["objects"].dump(),
            to_json(world)["objects"].dump());
  std::string bad = message;
  bad.replace(bad.find("[0, 6, 1]"), 9, "[0, 6, 12]");
  EXPECT_NE(this->message({scratch_.write("bad.yaml", bad), request}).find("vertex_indices"), std::string::npos);
}

TEST_F(Foreign, MoveItsTextInBothVersions) {
  const std::string shape = "box\n0.1 0.2 0.3\n0.5 0 0.4\n0 0 0 1\n0 0 0 0\n";
  const auto old_text = scratch_.write("old.scene", "shop\n* crate\n1\n" + shape + ".\n");
  const auto new_text = scratch_.write("new.scene", "shop\n* crate\n0 0 0.1\n0 0 0 1\n1\n" + shape +
                                                        "1\nhandle\n0 0 0\n0 0 0 1\n* ball\n0 0 0\n0 0 0 1\n1\n"
                                                        "sphere\n0.2\n1 1 1\n0 0 0 1\n0 0 0 0\n0\n.\n");
  const auto request = scratch_.write("request.yaml", kRequest);
  const World before = read_foreign(panda_, {old_text, request}).worlds.at(0);
  const World now = read_foreign(panda_, {new_text, request}).worlds.at(0);
  ASSERT_EQ(before.objects.size(), 1U);
  ASSERT_EQ(now.objects.size(), 2U);
  EXPECT_EQ(before.objects[0].shape.size, Vector3(0.1, 0.2, 0.3));
  EXPECT_NEAR((now.objects[0].X_WO.translation() - before.objects[0].X_WO.translation()).norm(), 0.1, 1e-12);
  EXPECT_EQ(object_named(now, "ball").shape.size.x(), 0.2);
}

TEST_F(Foreign, FoldersVampAndScenesOfBoxes) {
  for (const char* number : {"0001", "0002"}) {
    scratch_.write(
        std::string("box_panda/scene") + number + ".yaml",
        "world: {collision_objects: [{id: a" + std::string(number) +
            ", primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [1, 0, 0]}]}]}\n");
    scratch_.write(std::string("box_panda/request") + number + ".yaml", kRequest);
  }
  const ForeignWorlds folder = read_foreign(panda_, {scratch_.folder() / "box_panda"});
  ASSERT_EQ(folder.worlds.size(), 2U);
  EXPECT_EQ(folder.worlds[1].family, "box_panda");
  EXPECT_EQ(folder.worlds[1].index, 1U);
  EXPECT_EQ(folder.worlds[1].objects.at(0).name, "a0002");

  const std::string joints = R"(["panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4", "panda_joint5",
    "panda_joint6", "panda_joint7"])";
  const auto vamp = scratch_.write("problems.json", R"({"robot": "panda", "joints": )" + joints + R"(,
    "problems": {"cage": [{"index": 1, "valid": true, "start": [0, -0.8, 0, -2.3, 0, 1.5, 0.8],
      "goals": [[0.1, -0.2, 0.3, -1.4, 0.5, 1.6, 0.7]], "sphere": [], "cylinder": [{"name": "rod", "radius": 0.02, "length": 0.5,
      "position": [0.5, 0, 0.5], "orientation_euler_xyz": [0, 0, 0], "orientation_quat_xyzw": [0, 0, 0, 1]}],
      "box": [{"name": "lid", "half_extents": [0.1, 0.2, 0.3], "position": [0.7, 0, 0.2],
      "orientation_quat_xyzw": [0, 0, 0, 1]}]}]}})");
  const World cage = read_foreign(panda_, {vamp}).worlds.at(0);
  EXPECT_EQ(cage.family, "cage");
  EXPECT_EQ(object_named(cage, "lid").shape.size, Vector3(0.2, 0.4, 0.6));
  EXPECT_EQ(object_named(cage, "rod").shape.size.head<2>(), Vector2(0.02, 0.5));
  EXPECT_EQ(cage.start.q[1], -0.8);

  const auto own = scratch_.write("own.yaml", "joints: " + joints + R"(
scenes:
  shelf:
    base: [0, 0, 0]
    boxes: {board: {size: [0.4, 0.3, 0.02], center: [0.1, 0.7, 0.5]}}
    configurations: [[0, 0, 0, -1, 0, 1, 0], [0.1, 0, 0, -1, 0, 1, 0], [0.2, 0, 0, -1, 0, 1, 0]]
)");
  EXPECT_EQ(read_foreign(panda_, {own}).worlds.size(), 3U);
}

TEST_F(Foreign, CountsStartsInTouch) {
  const auto problem = [](const std::string& start, const std::string& box) {
    return R"({"start": )" + start +
           R"(, "goals": [[0.1, -0.2, 0.3, -1.4, 0.5, 1.6, 0.7]], "sphere": [], "cylinder": [],
      "box": [{"name": "lid", "half_extents": [0.1, 0.1, 0.1], "position": )" +
           box + R"(, "orientation_quat_xyzw": [0, 0, 0, 1]}]})";
  };
  const std::string clear = "[0, -0.8, 0, -2.3, 0, 1.5, 0.8]", folded = "[0, 1.7, 0, -3.05, 0, 0.2, 0]";
  const auto vamp =
      scratch_.write("problems.json", R"({"robot": "panda", "joints": ["panda_joint1", "panda_joint2", "panda_joint3",
    "panda_joint4", "panda_joint5", "panda_joint6", "panda_joint7"], "problems": {"three": [)" +
                                          problem(clear, "[-1, 0, 0.5]") + ", " + problem(clear, "[0.35, 0, 0.55]") +
                                          ", " + problem(folded, "[-1, 0, 0.5]") + "]}}");
  const ForeignWorlds found = read_foreign(panda_, {vamp});
  EXPECT_TRUE(noted(found, "2 of 3 starts are in touch, so that their trials collide at once: "));
  EXPECT_TRUE(noted(found, "panda_hand - lid"));
  EXPECT_TRUE(noted(found, "panda_link0 - panda_link6"));
}

// An object attached by its name alone stands in the scene; a request's attached objects go before the scene's.
TEST_F(Foreign, AttachedObjectsOfScenesAndRequestsAreOneInTheHand) {
  const std::string scene =
      "world: {collision_objects: [{id: jug, primitives: [{type: box, dimensions: [0.1, 0.1, 0.2]}, {type: sphere, "
      "dimensions: [0.06]}], primitive_poses: [{position: [0.5, 0, 0.4]}, {position: [0.5, 0, 0.5]}]}, "
      "{id: jugs, primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{position: [0, 0.7, 0.4]}]}]}\n";
  const std::string attached =
      "start_state: {attached_collision_objects: [{link_name: panda_hand, object: {id: jug}}, {link_name: panda_hand, "
      "object: {id: old, operation: 1}}]}\n";
  std::string request = kRequest;
  request = attached + request.substr(request.find("goal_constraints"));
  const ForeignWorlds found =
      read_foreign(panda_, {scratch_.write("scene.yaml", scene), scratch_.write("request.yaml", request)});
  const World& world = found.worlds.at(0);
  ASSERT_TRUE(world.held.has_value());
  EXPECT_EQ(world.held->object, "jug");
  ASSERT_EQ(world.objects.size(), 2U) << "both of its shapes are in the hand";
  EXPECT_TRUE(noted(found, "attached shapes are held as one convex hull: jug (2)"));
  const WorldObject& jug = object_named(world, "jug");
  Kinematics kinematics(panda_);
  kinematics.update(Vector3::Zero(), panda_->ready);
  const Isometry X_RW = kinematics.X_WL(panda_->find_link("panda_link0")).inverse();
  const auto reach = [&](const Vector3& direction) { return extent_along(jug.shape, X_RW * jug.X_WO, direction); };
  for (const auto& [direction, expected] :
       {std::pair(Vector3(1, 0, 0), 0.56), std::pair(Vector3(0, 1, 0), 0.06), std::pair(Vector3(0, 0, 1), 0.56),
        std::pair(Vector3(0, 0, -1), -0.3), std::pair(Vector3(0.6, 0, 0.8), 0.76)}) {
    EXPECT_GE(reach(direction), expected - 1e-9) << direction.transpose();
    EXPECT_LE(reach(direction), expected + 0.004) << direction.transpose();
  }
  EXPECT_EQ(world.difficulty.objects, 2);
}

TEST_F(Foreign, SaysWhatIsWrong) {
  const auto says = [&](const std::vector<std::filesystem::path>& files, const std::string& text) {
    EXPECT_NE(message(files).find(text), std::string::npos) << text << "\n" << message(files);
  };
  const auto scene = scratch_.write("scene.yaml", kScene);
  const auto request = scratch_.write("request.yaml", kRequest);
  says({scene}, "found 1 planning scenes and 0 requests");
  says({scene, scene, request}, "found 2 planning scenes and 1 requests");
  says({scratch_.write("a.yaml", "a: 1\n")}, "a.yaml:1:1: expected a planning scene");
  std::string text = kScene;
  text.replace(text.find("type: sphere"), 12, "type: helix");
  says({scratch_.write("b.yaml", text), request}, "b.yaml:21:");
  text = kRequest;
  text.erase(text.find("      - {joint_name: panda_joint4"), 50);
  says({scene, scratch_.write("c.yaml", text)}, "panda_joint4");
  says({scene, scratch_.write("d.yaml", "goal_constraints: [{position_constraints: []}]\n")},
       "expected joint_constraints");
  const auto held = [&](const std::string& from, const std::string& to) {
    std::string changed = kScene;
    changed.replace(changed.find(from), from.size(), to);
    return std::vector<std::filesystem::path>{scratch_.write("held.yaml", changed), request};
  };
  says(held("link_name: panda_hand", "link_name: elbow"), "held.yaml:4:18: link_name: robot panda has no link 'elbow'");
  says(held("link_name: panda_hand", "link_name: panda_link4"), "the object cup is attached to panda_link4");
  says(held("id: cup", "name: cup"), "held.yaml:6:");
  says(held("primitives: [{type: cylinder, dimensions: [0.1, 0.03]}]", "a: 1"), "cup has 0 primitives and 1 poses");
  says({scratch_.write(
            "f.yaml",
            "world: {}\nrobot_state: {attached_collision_objects: [{link_name: panda_hand, object: {id: x}}]}\n"),
        request},
       "f.yaml:2:");
  says({scratch_.write("e.scene", "shop\n* crate\n1\nbox\n0.1 0.2\n"), request}, "e.scene:5:1: found '0.1 0.2'");
  says({scratch_.write("h.scene", "shop\n* crate\n1\nbox\n0.1 0.2 0\n"), request}, "h.scene:5:1: found '0.1 0.2 0'");
  says({scratch_.write("f.scene", "shop\n* crate\n1\nbox\n"), request}, "f.scene:4:1: ends where");
  says({scratch_.write("g.yaml",
                       "world: {collision_objects: [{id: a, primitives: [{type: box, dimensions: [1, 1]}]}]}\n"),
        request},
       "g.yaml:1:");
}

}  // namespace
}  // namespace moma
