#include "world/scenario/worlds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include "controller/step.h"
#include "tests/support/scratch.h"
#include "tests/world/support.h"
#include "tests/world/world_proof.h"
#include "world/scenario/family.h"
#include "world/world_json.h"

namespace moma {
namespace {

using test::robot;
using test::worlds;

std::vector<std::string> make_all(const Worlds& source, const std::shared_ptr<const RobotModel>& model, int count,
                                  int threads) {
  std::vector<std::string> out(static_cast<std::size_t>(count));
  std::vector<std::thread> pool;
  for (int t = 0; t < threads; ++t) {
    pool.emplace_back([&, t] {
      for (int i = count - 1 - t; i >= 0; i -= threads)  // backwards: order must not matter
        out[static_cast<std::size_t>(i)] = to_json(source.make(model, static_cast<std::uint64_t>(i))).dump();
    });
  }
  for (std::thread& thread : pool) thread.join();
  return out;
}

const WorldObject& named(const World& world, const std::string& name) {
  for (const WorldObject& object : world.objects)
    if (object.name == name) return object;
  throw std::runtime_error("no object " + name);
}

/// Where the goal is in the axes of an object, from its centre.
Vector3 goal_in(const World& world, const WorldObject& object) {
  return object.X_WO.inverse() * world.goal.X_WG.translation();
}

TEST(Worlds, TheGoalLiesOnTheTable) {
  const Worlds source = worlds("families: {table: {}}");
  const auto model = robot("frankie");
  for (std::uint64_t i = 0; i < 50; ++i) {
    const World world = source.make(model, i);
    const WorldObject& top = named(world, "table_top");
    const Vector3 p = goal_in(world, top);
    EXPECT_LT(std::abs(p.x()), 0.5 * top.shape.size.x());
    EXPECT_LT(std::abs(p.y()), 0.5 * top.shape.size.y());
    EXPECT_GT(p.z(), 0.0);
    EXPECT_LT(p.z(), 0.25);
    // The robot is at the near side: the nearer edge in x is the one towards its base.
    const Vector3 base(world.witness.base.x(), world.witness.base.y(), top.X_WO.translation().z());
    EXPECT_LT((top.X_WO.inverse() * base).x(), 0.0);
  }
}

TEST(Worlds, TheRobotStandsOnTheDesk) {
  const Worlds source = worlds("families: {desk: {items: 3}}");
  const auto model = test::panda_at(0.75);
  const Kinematics at_ready(model);
  double lowest = 1.0;  // of what stands on the table
  for (const CollisionShape& shape : model->shapes)
    if (shape.rigid_with_base) lowest = std::min(lowest, lowest_point(shape.shape, at_ready.X_WS(shape)));
  for (std::uint64_t i = 0; i < 60; ++i) {
    const World world = source.make(model, i);
    test::WorldProof(model).check(world, source.clearance(), 0.0, 1.0);
    const WorldObject& top = named(world, "table_top");
    const double height = top.X_WO.translation().z() + 0.5 * top.shape.size.z();
    EXPECT_NEAR(height, lowest - 0.06, 1e-9) << "the plate under the robot";
    EXPECT_GT(world.goal.X_WG.translation().z(), height + 0.05);
    const Vector3 foot = top.X_WO.inverse() * Vector3(0.0, 0.0, height);
    EXPECT_LT(std::abs(foot.x()), 0.5 * top.shape.size.x()) << "the robot is over the table";
    EXPECT_LT(std::abs(foot.y()), 0.5 * top.shape.size.y());
    for (const char* item : {"item1", "item2", "item3"}) {
      const WorldObject& thing = named(world, item);
      EXPECT_NEAR(lowest_point(thing.shape, thing.X_WO), height, 1e-9) << item;
    }
    EXPECT_EQ(world.objects.size(), 8u) << "top, four legs, three things";
  }
}

TEST(Worlds, ADeskIsForRobotsThatStandHighEnough) {
  const Worlds source = worlds("tries: 10\nfamilies: {desk: {}}");
  const auto why = [&](const std::shared_ptr<const RobotModel>& model) -> std::string {
    try {
      source.make(model, 0);
      return "made";
    } catch (const GenerationError& error) {
      return error.what();
    }
  };
  EXPECT_NE(why(robot("frankie")).find("it cannot stand on a table"), std::string::npos) << why(robot("frankie"));
  EXPECT_NE(why(test::panda_at(0.0)).find("base.mount.position says how high"), std::string::npos)
      << why(test::panda_at(0.0));
  EXPECT_EQ(why(test::panda_at(0.75)), "made");
}

TEST(Worlds, TheGoalLiesInTheShelf) {
  const Worlds source = worlds("families: {shelf: {}}");
  const auto model = robot("frankie");
  for (std::uint64_t i = 0; i < 50; ++i) {
    const World world = source.make(model, i);
    const Vector3 in_back = goal_in(world, named(world, "shelf_back"));
    EXPECT_LT(in_back.x(), 0.0) << "before the back";
    EXPECT_GT(in_back.x(), -0.45);
    EXPECT_LT(goal_in(world, named(world, "shelf_left")).y(), 0.0);
    EXPECT_GT(goal_in(world, named(world, "shelf_right")).y(), 0.0);
    int below = 0, above = 0;
    for (const WorldObject& object : world.objects) {
      if (object.name.rfind("shelf_board", 0) != 0) continue;
      (goal_in(world, object).z() > 0.0 ? below : above) += 1;
    }
    EXPECT_GE(below, 1);
    EXPECT_GE(above, 1);
  }
}

TEST(Worlds, TheGoalLiesBehindTheDoor) {
  const Worlds source = worlds("families: {doorway: {}}");
  const auto model = robot("frankie");
  for (std::uint64_t i = 0; i < 50; ++i) {
    const World world = source.make(model, i);
    const WorldObject& wall = named(world, "wall_left");
    const Vector3 start = wall.X_WO.inverse() * Vector3(world.start.base.x(), world.start.base.y(), 1.0);
    EXPECT_LT(start.x(), 0.0);
    EXPECT_GT(goal_in(world, wall).x(), 0.0);
  }
  try {
    source.make(robot("panda"), 0);
    FAIL() << "a fixed base in a doorway";
  } catch (const GenerationError& error) {
    EXPECT_NE(std::string(error.what()).find("fixed base"), std::string::npos) << error.what();
  }
}

// Points within 0.85 m of a door, along its passage, lie in no table and in no shelf.
TEST(Worlds, TheFurnitureOfAHomeLeavesItsDoorsFree) {
  const Worlds source = worlds("families: {home: {doors: 2}}");
  const auto model = robot("frankie");
  for (std::uint64_t i = 0; i < 30; ++i) {
    const World world = source.make(model, i);
    for (const std::string wall : {"wall1", "wall2"}) {
      const WorldObject &left = named(world, wall + "_left"), &right = named(world, wall + "_right");
      const Vector3 along = left.X_WO.linear().col(0), across = left.X_WO.linear().col(1);
      const Vector3 a = left.X_WO.translation() - 0.5 * left.shape.size.y() * across;
      const Vector3 b = right.X_WO.translation() + 0.5 * right.shape.size.y() * across;
      for (int k = 0; k < 400; ++k) {
        const Vector3 p = b + (k % 20 + 0.5) / 20.0 * (a - b) + 0.85 * ((k / 20) / 9.5 - 1.0) * along;
        for (const WorldObject& object : world.objects) {
          if (object.name.find("table") == std::string::npos && object.name.find("shelf") == std::string::npos)
            continue;
          const Vector3 in = (object.X_WO.inverse() * p).cwiseAbs() - 0.5 * object.shape.size;
          EXPECT_GT(in.head<2>().maxCoeff(), 0.0) << object.name << " in the door of " << wall << ", world " << i;
        }
      }
    }
  }
}

TEST(Worlds, TrackedGoalsMoveAndKeepEveryBitInTheirFile) {
  const Worlds source = worlds("families: {tracking: {}}");
  std::set<std::size_t> kinds;
  for (const char* name : {"frankie", "panda"}) {
    const auto model = robot(name);
    for (std::uint64_t i = 0; i < 20; ++i) {
      const World a = source.make(model, i);
      kinds.insert(a.goal.motion.index());
      EXPECT_GT(goal_state(a, 1.0).V_WG_W.norm(), 0.01);
      EXPECT_LT((goal_state(a, 0.0).X_WG.matrix() - a.goal.X_WG.matrix()).norm(), 1e-12);
      const World b = world_from_json(nlohmann::ordered_json::parse(to_json(a).dump()), "test");
      for (const double t : {0.0, 0.7, 12.3, 59.0, 100.0}) {
        EXPECT_EQ(goal_state(a, t).X_WG.matrix(), goal_state(b, t).X_WG.matrix());
        EXPECT_EQ(goal_state(a, t).V_WG_W, goal_state(b, t).V_WG_W);
      }
    }
  }
  EXPECT_EQ(kinds.size(), 3u) << "path, circle and spline";
}

TEST(Worlds, AreTheSameForAnyThreadsAndOrder) {
  const auto model = robot("frankie");
  const Worlds source = worlds(
      "seed: 3\nfamilies: {open: {weight: 1}, clutter: {weight: 2}, moving: {weight: 1}, table: {}, shelf: {}, "
      "tracking: {weight: 0.5}}");
  EXPECT_EQ(make_all(source, model, 60, 1), make_all(source, model, 60, 4));
}

TEST(Worlds, AFamilyOfWeightZeroChangesNothing) {
  const auto model = robot("frankie");
  const Worlds a = worlds("families: {open: {weight: 1}, clutter: {weight: 1}}");
  const Worlds b = worlds("families: {moving: {weight: 0}, open: {weight: 1}, clutter: {weight: 1}}");
  EXPECT_EQ(make_all(a, model, 30, 1), make_all(b, model, 30, 1));
  for (std::uint64_t i = 0; i < 30; ++i) EXPECT_EQ(a.identity(i), b.identity(i));
}

TEST(Worlds, SeedsDiffer) {
  const auto model = robot("frankie");
  EXPECT_NE(to_json(worlds("seed: 1\nfamilies: {open: {}}").make(model, 0)).dump(),
            to_json(worlds("seed: 2\nfamilies: {open: {}}").make(model, 0)).dump());
}

TEST(Worlds, MovingObjectsLeaveStartAndWitnessClear) {
  const auto model = robot("frankie");
  const Worlds source = worlds("seed: 9\nfamilies: {moving: {weight: 1}}");
  Kinematics kinematics(model);
  for (std::uint64_t i = 0; i < 20; ++i) {
    const World world = source.make(model, i);
    std::vector<ObjectState> states(world.objects.size());
    for (double t = 0.0; t <= 60.0; t += 0.25) {
      object_states(world, t, states);
      for (const Configuration* c : {&world.start, &world.witness}) {
        kinematics.update(c->base, c->q);
        for (const CollisionShape& shape : model->shapes)
          for (std::size_t k = 0; k < states.size(); ++k)
            ASSERT_GT(shape_distance(shape.shape, kinematics.X_WS(shape), world.objects[k].shape, states[k].X_WO).d,
                      0.049)
                << "world " << i << " at " << t;
      }
    }
  }
}

TEST(Worlds, StartRoomIsEmptyWhenTheRobotStarts) {
  const auto model = robot("frankie");
  const Worlds with = worlds("seed: 9\nstart_room: 0.4\nfamilies: {clutter: {}, table: {}, doorway: {}, moving: {}}");
  const Worlds without = worlds("seed: 9\nfamilies: {clutter: {}, table: {}, doorway: {}, moving: {}}");
  EXPECT_NE(with.identity(0), without.identity(0));
  EXPECT_EQ(without.identity(0).count("start_room"), 0U) << "keys of worlds without it stay";
  const auto least = [&](const World& world) {
    Kinematics kinematics(model);
    kinematics.update(world.start.base, world.start.q);
    std::vector<ObjectState> states(world.objects.size());
    object_states(world, 0.0, states);
    double d = 1e9;
    for (const CollisionShape& shape : model->shapes)
      for (std::size_t k = 0; k < states.size(); ++k)
        d = std::min(d, shape_distance(shape.shape, kinematics.X_WS(shape), world.objects[k].shape, states[k].X_WO).d);
    return d;
  };
  int nearer = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    EXPECT_GT(least(with.make(model, i)), 0.399) << "world " << i;
    nearer += least(without.make(model, i)) < 0.4 ? 1 : 0;
  }
  EXPECT_GT(nearer, 2);
}

TEST(Worlds, MovingObjectsDoCrossTheWay) {
  const auto model = robot("frankie");
  const Worlds source = worlds("seed: 9\nfamilies: {moving: {crossing: 1, objects: 1}}");
  int crossings = 0;
  for (std::uint64_t i = 0; i < 50; ++i) {
    const World world = source.make(model, i);
    const Vector3 goal = world.goal.X_WG.translation();
    const Vector2 way = goal.head<2>();
    const auto side = [&](double t) {
      const Vector3 p = evaluate(world.objects[0].motion, world.objects[0].X_WO, t).X.translation();
      return way.x() * p.y() - way.y() * p.x();
    };
    crossings += side(0.0) * side(60.0) < 0.0;
  }
  EXPECT_EQ(crossings, 50);
}

TEST(Worlds, FileKeepsEveryBit) {
  const auto model = robot("frankie");
  const Worlds source = worlds("seed: 4\nfamilies: {clutter: {}, moving: {}}");
  for (std::uint64_t i = 0; i < 40; ++i) {
    const World a = source.make(model, i);
    const std::string text = to_json(a).dump();
    const World b = world_from_json(nlohmann::ordered_json::parse(text), "test");
    EXPECT_EQ(to_json(b).dump(), text);
    EXPECT_EQ(a.goal.X_WG.matrix(), b.goal.X_WG.matrix());
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t k = 0; k < a.objects.size(); ++k) {
      EXPECT_EQ(a.objects[k].X_WO.matrix(), b.objects[k].X_WO.matrix());
      EXPECT_EQ(evaluate(a.objects[k].motion, a.objects[k].X_WO, 1.3).X.matrix(),
                evaluate(b.objects[k].motion, b.objects[k].X_WO, 1.3).X.matrix());
    }
    EXPECT_EQ(a.start.q, b.start.q);
    EXPECT_EQ(a.witness.base, b.witness.base);
  }
}

TEST(Worlds, SeveralGoalsKeepEveryBitInTheirFile) {
  const auto model = robot("frankie");
  const Worlds source = worlds("seed: 4\nfamilies: {sequence: {on_the_move: true, goals: 3}}");
  World a = source.make(model, 1);
  ASSERT_EQ(a.further.size(), 2u);
  EXPECT_FALSE(a.goal.stop);
  EXPECT_FALSE(a.further[0].stop);
  EXPECT_TRUE(a.further[1].stop);
  a.further[0].free << 0, 0, 1, 1, 0, 0;
  const nlohmann::ordered_json json = to_json(a);
  EXPECT_EQ(json["goals"][1]["free"], nlohmann::json({"rz", "x"}));
  const World b = world_from_json(json, "test");
  EXPECT_EQ(to_json(b), json);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(goal_of(a, i).X_WG.matrix(), goal_of(b, i).X_WG.matrix());
    EXPECT_EQ(goal_of(a, i).stop, goal_of(b, i).stop);
    EXPECT_EQ(goal_of(a, i).free, goal_of(b, i).free);
  }
}

// The axis is vertical at the start; the witness reaches the goal and tilts it by no more than its share.
TEST(Worlds, UprightToolsStandAtStartAndGoal) {
  for (const char* name : {"frankie", "panda", "lift_ur5"}) {
    const auto model = robot(name);
    const Worlds source = worlds("seed: 4\nfamilies: {upright: {angle: 0.2, at_goal: {uniform: [0, 0.5]}}}");
    Kinematics kinematics(model);
    for (std::uint64_t i = 0; i < 12; ++i) {
      const World a = source.make(model, i);
      ASSERT_TRUE(a.upright.has_value());
      EXPECT_EQ(a.upright->angle, 0.2);
      kinematics.update(a.start.base, a.start.q);
      EXPECT_NEAR((kinematics.X_WE().linear() * a.upright->axis).z(), 1.0, 1e-12);
      EXPECT_GE((a.goal.X_WG.linear() * a.upright->axis).z(), std::cos(0.1 + 1.1e-3));
      const nlohmann::ordered_json json = to_json(a);
      const World b = world_from_json(json, "test");
      EXPECT_EQ(to_json(b), json);
      EXPECT_EQ(a.upright, b.upright);
    }
  }
  EXPECT_FALSE(to_json(worlds("seed: 4\nfamilies: {clutter: {}}").make(robot("frankie"), 0)).contains("upright"));
}

// The hand at the object, lifted, and at the place: the object stands on its block, `clearance` from the hand, upright
// wherever it is held, and `drop` above the other block.
TEST(Worlds, PickAndPlaceTakesFromABlockAndLeavesOnAnother) {
  for (const char* name : {"frankie", "panda"}) {
    const auto model = robot(name);
    const Worlds source = worlds("seed: 4\nfamilies: {pick-place: {clearance: 0.03, drop: 0.01, lift: 0.1}}");
    for (std::uint64_t i = 0; i < 8; ++i) {
      const World a = source.make(model, i);
      ASSERT_EQ(a.further.size(), 5u);
      EXPECT_EQ(a.further[0].take, "object");
      EXPECT_EQ(a.further[3].leave, "object");
      EXPECT_TRUE(carries(a));
      const WorldObject &object = a.objects[0], &from = a.objects[1], &to = a.objects[2];
      const auto at = [&](std::size_t goal) {
        return Isometry(goal_of(a, goal).X_WG * a.further[0].X_WG.inverse() * object.X_WO);
      };
      EXPECT_NEAR(shape_distance(object.shape, at(1), from.shape, from.X_WO).d, 0.0, 1e-6);
      EXPECT_NEAR(shape_distance(object.shape, at(2), from.shape, from.X_WO).d, 0.1, 1e-4);
      EXPECT_NEAR(shape_distance(object.shape, at(4), to.shape, to.X_WO).d, 0.01, 1e-3);
      for (std::size_t goal = 1; goal < 6; ++goal)
        EXPECT_GT((at(goal).linear() * object.X_WO.linear().transpose())(2, 2), std::cos(2e-3)) << goal;
      EXPECT_NEAR((a.goal.X_WG.translation() - a.further[0].X_WG.translation()).norm(), 0.1, 1e-5);
      const nlohmann::ordered_json json = to_json(a);
      const World b = world_from_json(json, "test");
      EXPECT_EQ(to_json(b), json);
      EXPECT_EQ(b.further[0].take, "object");
    }
  }
}

TEST(Worlds, TakeAndLeaveWhatIsThere) {
  nlohmann::ordered_json json =
      to_json(worlds("seed: 4\nfamilies: {pick-place: {objects: 0}}").make(robot("frankie"), 0));
  const auto error = [&](std::size_t goal, const char* key, const char* name) {
    nlohmann::ordered_json changed = json;
    changed["goals"][goal][key] = name;
    try {
      world_from_json(changed, "test");
    } catch (const std::exception& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  EXPECT_NE(error(1, "take", "cup").find("goals[1].take: no object has the name 'cup'"), std::string::npos)
      << error(1, "take", "cup");
  EXPECT_NE(error(2, "take", "from").find("already carries 'object'"), std::string::npos);
  EXPECT_NE(error(4, "leave", "to").find("goals[4].leave: 'to' is not what the hand carries (object)"),
            std::string::npos);
  EXPECT_NE(error(5, "leave", "object").find("(nothing)"), std::string::npos);
  json["goals"][1]["stop"] = false;
  EXPECT_NE(error(0, "leave", "").find("expected stop: true"), std::string::npos) << error(0, "leave", "");
  json["goals"][1]["stop"] = true;
  json["objects"][0]["motion"] = {{"kind", "linear"}, {"velocity", {0, 0, 0, 0.1, 0, 0}}};
  EXPECT_NE(error(0, "leave", "").find("'object' moves"), std::string::npos) << error(0, "leave", "");
}

TEST(Worlds, HoldWhatIsThereFromTheStart) {
  const auto model = robot("panda");
  nlohmann::ordered_json json = to_json(worlds("families: {clutter: {}}").make(model, 0));
  EXPECT_FALSE(json.contains("held")) << "worlds of before keep their bits";
  const std::string name = json["objects"][0]["name"];
  json["held"] = {{"object", name}, {"touch", {"panda_link6"}}};
  const test::Scratch folder;
  const auto error = [&](const nlohmann::ordered_json& held) {
    nlohmann::ordered_json changed = json;
    changed["held"] = held;
    try {
      worlds("frozen: " + folder.write("worlds.jsonl", changed.dump() + "\n").string()).make(model, 0);
    } catch (const std::exception& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(error(json["held"]), "none");
  const auto again = to_json(worlds("frozen: " + (folder.folder() / "worlds.jsonl").string()).make(model, 0));
  EXPECT_EQ(again["held"].dump(), json["held"].dump());
  EXPECT_EQ(to_json(world_from_json(again, "test")).dump(), again.dump());
  const auto says = [&](const nlohmann::ordered_json& held, const std::string& text) {
    EXPECT_NE(error(held).find(text), std::string::npos) << text << "\n" << error(held);
  };
  says({{"object", "cup"}}, "worlds.jsonl:1:");
  says({{"object", "cup"}}, "held.object: no object has the name 'cup'");
  says({{"touch", {"panda_link6"}}}, "held.object");
  says({{"object", name}, {"links", 1}}, "held.links");
  says({{"object", name}, {"touch", {"elbow"}}}, "world 0: held.touch: robot panda has no link 'elbow'");
  says({{"object", name},
        {"touch", {"panda_link0", "panda_link1", "panda_link2", "panda_link3", "panda_link4", "panda_link5"}}},
       "6 collision shapes at most");
  says({{"object", name}, {"touch", {"panda_hand", "panda_link7", "panda_leftfinger", "panda_link5", "panda_link6"}}},
       "none");
  json["goal"]["take"] = json["objects"][1]["name"];
  says({{"object", name}}, "already carries '" + name + "'");
  json["goal"].erase("take");
  json["objects"][0]["motion"] = {{"kind", "linear"}, {"velocity", {0, 0, 0, 0.1, 0, 0}}};
  says({{"object", name}}, "held.object: '" + name + "' moves");
}

TEST(Worlds, WithoutAGapBetweenObjectsReadBackFromValuesAsFromText) {
  const World world = worlds("families: {moving: {objects: 1}}").make(robot("frankie"), 0);
  ASSERT_TRUE(std::isnan(world.difficulty.narrowest_gap_m));
  EXPECT_TRUE(std::isnan(world_from_json(to_json(world), "test").difficulty.narrowest_gap_m));
}

TEST(Worlds, ResolvedSectionReadsBack) {
  const Worlds a = worlds(
      "seed: 8\nclearance: 0.04\nfamilies: {clutter: {weight: 2, objects: 3, box_edge: {normal: [0.3, 0.1]}}, open: "
      "{}}");
  const nlohmann::ordered_json json = a.to_json();
  const Worlds b = worlds(json.dump());
  EXPECT_EQ(b.to_json(), json);
  EXPECT_EQ(a.identity(5), b.identity(5));
}

TEST(Worlds, FrozenSetsAreReadFromJsonLines) {
  const auto model = robot("panda");
  const Worlds source = worlds("seed: 2\nfamilies: {clutter: {}}");
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "moma_frozen_test.jsonl";
  {
    std::ofstream file(path);
    for (std::uint64_t i = 3; i < 6; ++i) file << to_json(source.make(model, i)).dump() << "\n";
  }
  const Worlds frozen = worlds("frozen: " + path.string());
  ASSERT_EQ(frozen.size(), 3);
  EXPECT_EQ(to_json(frozen.make(model, 1)).dump(), to_json(source.make(model, 4)).dump());
  EXPECT_EQ(frozen.family_of(0), "clutter");
  EXPECT_THROW(frozen.make(model, 3), GenerationError);
  EXPECT_THROW(frozen.make(robot("ur5"), 0), GenerationError);
  const Worlds again = worlds(frozen.to_json().dump());
  EXPECT_EQ(to_json(again.make(model, 2)).dump(), to_json(frozen.make(model, 2)).dump());
  std::filesystem::remove(path);
}

TEST(Worlds, ErrorNamesTheConstraintThatFailedMost) {
  const auto model = robot("frankie");
  try {
    worlds("tries: 20\nfamilies: {open: {tip_height: 9}}").make(model, 0);
    FAIL() << "a goal 9 m high was found";
  } catch (const GenerationError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("tip_height"), std::string::npos) << text;
    EXPECT_NE(text.find("20"), std::string::npos) << text;
  }
  try {
    worlds("clearance: 30\ntries: 3\nfamilies: {clutter: {}}").make(model, 0);
    FAIL();
  } catch (const GenerationError& error) {
    EXPECT_NE(std::string(error.what()).find("clearance"), std::string::npos) << error.what();
  }
}

TEST(Worlds, GivesUpWhereNoFirstObjectHasAPlace) {
  try {
    worlds("clearance: 60\nfamilies: {crowd: {}}").make(robot("frankie"), 0);
    FAIL() << "a person stands 60 m away";
  } catch (const GenerationError& error) {
    const std::string text = error.what();  // 100 tries with 400 draws each, and those whose robot has no place
    const std::size_t at = text.find(" in ");
    ASSERT_NE(at, std::string::npos) << text;
    EXPECT_LT(std::stoi(text.substr(at + 4)), 200) << text;
    EXPECT_NE(text.find("no path clear of start and goal (worlds.clearance) (100 times)"), std::string::npos) << text;
  }
}

TEST(Worlds, RefusesBadSections) {
  const auto refused = [](const std::string& yaml, const char* part) {
    try {
      worlds(yaml);
      ADD_FAILURE() << yaml << " was accepted";
    } catch (const config::ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused("seed: 1", "families");
  refused("families: {}", "at least one family");
  refused("families: {cluter: {}}", "did you mean clutter?");
  refused("families: {open: {weight: 0}}", "weight above 0");
  refused("families: {open: {weight: -1}}", "weight");
  refused("families: {open: {objects: 3}}", "objects");
  refused("families: {clutter: {objects: 2.5}}", "whole");
  refused("families: {clutter: {shapes: [cone]}}", "cone");
  refused("sed: 3\nfamilies: {open: {}}", "did you mean seed?");
  refused("frozen: /nowhere/worlds.jsonl", "/nowhere/worlds.jsonl");
  refused("clearance: -0.1\nfamilies: {open: {}}", "clearance");
}

TEST(Worlds, FileErrorsNameThePlace) {
  const auto model = robot("panda");
  const nlohmann::ordered_json good = to_json(worlds("families: {clutter: {objects: 2}}").make(model, 0));
  const auto refused = [&](auto change, const char* part) {
    nlohmann::ordered_json bad = good;
    change(bad);
    try {
      world_from_json(bad, "set.jsonl:7");
      ADD_FAILURE() << "accepted: " << part;
    } catch (const config::ConfigError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("set.jsonl:7"), std::string::npos) << text;
      EXPECT_NE(text.find(part), std::string::npos) << text;
    }
  };
  refused([](auto& w) { w["objects"][1]["size"] = {-1.0}; }, "size");
  refused([](auto& w) { w["objects"][1]["shape"] = "cone"; }, "cone");
  refused([](auto& w) { w["objects"][0]["name"] = w["objects"][1]["name"]; }, "twice");
  refused([](auto& w) { w["goal"]["quaternion"] = {1, 1, 0, 0}; }, "unit quaternion");
  refused([](auto& w) { w["goal"]["motion"] = {{"kind", "warp"}}; }, "linear");
  refused(
      [](auto& w) {
        w["goal"]["motion"] = {{"kind", "spline"}, {"times", {0, 1}}, {"positions", {{0, 0, 9}, {0, 0, 8}}}};
      },
      "position given");
  refused([](auto& w) { w["goal"]["stop"] = false; }, "no other goal follows");
  refused([](auto& w) { w["goal"]["free"] = {"rz", "roll"}; }, "roll");
  refused([](auto& w) { w["goal"]["free"] = {"rx", "ry", "rz", "x", "y", "z"}; }, "a direction that is not free");
  refused([](auto& w) { w["upright"] = {{"axis", {0, 0, 0}}, {"angle", 0.2}}; }, "an axis that is not zero");
  refused([](auto& w) { w["upright"] = {{"axis", {0, 0, 1}}, {"angle", 0.0}}; }, "angle");
  refused([](auto& w) { w["upright"] = {{"axis", {0, 0, 1}}}; }, "angle");
  refused([](auto& w) { w["goals"] = {w["goal"]}; }, "either goal or goals");
  const auto several = [](auto& w) -> auto& {
    w["goals"] = {w["goal"], w["goal"]};
    w.erase("goal");
    return w["goals"];
  };
  refused([&](auto& w) { several(w)[1]["stop"] = false; }, "a last goal with stop: true");
  refused([&](auto& w) { several(w).clear(); }, "at least one goal");
  refused([](auto& w) { w.erase("start"); }, "start");
  refused([](auto& w) { w["colour"] = "red"; }, "colour");
}

}  // namespace
}  // namespace moma
