// What moves in the family `moving`: how often, how fast, where, and that what was there before stays as it was.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/world/support.h"
#include "world/world_json.h"

namespace moma::test {
namespace {

constexpr const char* kAll = "seed: 9\nfamilies: {moving: {objects: 5, walk: 0.4, orbit: 0.3}}";

template <typename Kind>
const Kind* motion(const WorldObject& object) {
  return std::get_if<Kind>(&object.motion);
}

TEST(MovingWorlds, CirclesAndWalkersComeAsOftenAsAskedFor) {
  const auto model = robot("frankie");
  const Worlds source = worlds(kAll);
  int straight = 0, circles = 0, walkers = 0, around_goal = 0;
  constexpr int kWorlds = 200;
  for (std::uint64_t i = 0; i < kWorlds; ++i) {
    const World world = source.make(model, i);
    const Vector3 goal = world.goal.X_WG.translation();
    for (const WorldObject& object : world.objects) {
      straight += motion<LinearMotion>(object) != nullptr;
      walkers += motion<PathMotion>(object) != nullptr;
      EXPECT_EQ(object.name.rfind("walker", 0) == 0, motion<PathMotion>(object) != nullptr);
      if (const auto* circle = motion<CircleMotion>(object)) {
        ++circles;
        around_goal += (circle->center - goal).head<2>().norm() < 1e-12;
      }
    }
  }
  const auto near = [](int count, double part, int of) {  // four standard deviations of a binomial
    EXPECT_NEAR(count, part * of, 4.0 * std::sqrt(part * (1.0 - part) * of));
  };
  near(straight, 0.3, 5 * kWorlds);
  near(circles, 0.3, 5 * kWorlds);
  near(walkers, 0.4, 5 * kWorlds);
  near(around_goal, 0.5, circles);
}

/// Times of the knots of a path, at which its velocity jumps.
bool near_knot(const WorldObject& object, double t) {
  const auto* path = motion<PathMotion>(object);
  if (path == nullptr) return false;
  for (const double knot : path->times)
    if (std::abs(knot - t) < 2e-5) return true;
  return false;
}

TEST(MovingWorlds, VelocityIsTheDerivativeAndPositionDoesNotJump) {
  const auto model = robot("frankie");
  const Worlds source = worlds(kAll);
  constexpr double kHalf = 1e-5;
  for (std::uint64_t i = 0; i < 10; ++i) {
    for (const WorldObject& object : source.make(model, i).objects) {
      Vector3 before = object.X_WO.translation();
      EXPECT_LT((evaluate(object.motion, object.X_WO, 0.0).X.matrix() - object.X_WO.matrix()).norm(), 1e-12);
      for (int k = 1; k < 3000; ++k) {
        const double t = 0.023 * k;
        const MovingPose now = evaluate(object.motion, object.X_WO, t);
        ASSERT_LT((now.X.translation() - before).norm(), 0.023 * 3.0) << object.name << " at " << t;
        before = now.X.translation();
        if (near_knot(object, t)) continue;
        const Isometry a = evaluate(object.motion, object.X_WO, t - kHalf).X;
        const Isometry b = evaluate(object.motion, object.X_WO, t + kHalf).X;
        const Vector3 v = (b.translation() - a.translation()) / (2.0 * kHalf);
        const Vector3 w = log_so3(b.linear() * a.linear().transpose()) / (2.0 * kHalf);
        ASSERT_LT((now.V_W.tail<3>() - v).norm(), 1e-6) << object.name << " at " << t;
        ASSERT_LT((now.V_W.head<3>() - w).norm(), 1e-6) << object.name << " at " << t;
      }
    }
  }
}

TEST(MovingWorlds, WalkersGiveWayIfAskedToAndWalkAsBefore) {
  const auto model = robot("frankie");
  const Worlds plain = worlds("families: {moving: {objects: 3, walk: 0.5}}");
  const Worlds polite = worlds("families: {moving: {objects: 3, walk: 0.5, walk_yields: {distance: 0.8}}}");
  int walkers = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    World world = polite.make(model, i);
    for (WorldObject& object : world.objects) {
      const bool walks = motion<PathMotion>(object) != nullptr;
      walkers += walks;
      EXPECT_EQ(object.yields.distance, walks ? 0.8 : 0.0);
      object.yields = {};
    }
    EXPECT_EQ(to_json(world).dump(), to_json(plain.make(model, i)).dump());
  }
  EXPECT_GT(walkers, 10);
}

TEST(MovingWorlds, CirclesAreRoundAndBothWays) {
  const auto model = robot("frankie");
  const Worlds source = worlds("families: {moving: {objects: 3, orbit: 1, orbit_radius: {uniform: [0.6, 2]}}}");
  int left = 0, right = 0;
  for (std::uint64_t i = 0; i < 30; ++i) {
    for (const WorldObject& object : source.make(model, i).objects) {
      const auto* circle = motion<CircleMotion>(object);
      ASSERT_NE(circle, nullptr);
      (circle->rate > 0.0 ? left : right) += 1;
      const double radius = (object.X_WO.translation() - circle->center).norm();
      EXPECT_GE(radius, 0.6 - 1e-12);
      EXPECT_LE(radius, 2.0 + 1e-12);
      const MovingPose later = evaluate(object.motion, object.X_WO, 17.0);
      EXPECT_NEAR((later.X.translation() - circle->center).norm(), radius, 1e-12);
      EXPECT_GE(later.V_W.tail<3>().norm(), 0.1 - 1e-9);
      EXPECT_LE(later.V_W.tail<3>().norm(), 0.5 + 1e-9);
    }
  }
  EXPECT_GT(left, 20);
  EXPECT_GT(right, 20);
}

TEST(MovingWorlds, WalkersHaveAPaceStopAndStayNearTheWay) {
  const auto model = robot("frankie");
  const Worlds source = worlds("families: {moving: {objects: 4, walk: 1, walk_margin: 1.7}}");
  double sum = 0.0;
  int walkers = 0, legs = 0, stops = 0, crossings = 0;
  for (std::uint64_t i = 0; i < 40; ++i) {
    const World world = source.make(model, i);
    Vector3 way = world.goal.X_WG.translation();
    way.z() = 0.0;
    const double length = way.norm();
    const Vector3 forward = way / length;
    const Vector3 left(-forward.y(), forward.x(), 0.0);
    for (const WorldObject& object : world.objects) {
      const auto* path = motion<PathMotion>(object);
      ASSERT_NE(path, nullptr);
      EXPECT_EQ(object.shape.kind, ShapeKind::kCapsule);
      EXPECT_NEAR(lowest_point(object.shape, object.X_WO), 0.0, 1e-12) << "stands on the floor";
      EXPECT_NEAR(object.shape.size.y() + 2.0 * object.shape.size.x(), 1.7, 0.5);
      EXPECT_GE(path->times.back(), 60.0);
      double pace = 0.0;
      for (std::size_t k = 0; k + 1 < path->times.size(); ++k) {
        const Vector3 p = path->positions[k];
        EXPECT_GE(forward.dot(p), -1.7 - 1e-9);
        EXPECT_LE(forward.dot(p), length + 1.7 + 1e-9);
        EXPECT_LE(std::abs(left.dot(p)), 1.7 + 1e-9);
        const Vector3 step = path->positions[k + 1] - p;
        const double speed = step.norm() / (path->times[k + 1] - path->times[k]);
        if (speed == 0.0) {
          ++stops;
          continue;
        }
        ++legs;
        crossings += left.dot(p) * left.dot(path->positions[k + 1]) < 0.0;
        if (pace == 0.0) pace = speed;
        EXPECT_NEAR(speed, pace, 1e-9) << "one pace";
        EXPECT_GE(step.norm(), 0.5 - 1e-12);
      }
      sum += pace;
      ++walkers;
    }
  }
  EXPECT_EQ(walkers, 160);
  EXPECT_NEAR(sum / walkers, 1.34, 4.0 * 0.26 / std::sqrt(walkers));
  EXPECT_NEAR(stops, 0.3 * legs, 4.0 * std::sqrt(0.3 * 0.7 * legs) + walkers);
  EXPECT_GT(crossings, legs / 5) << "people get in the way";
}

TEST(MovingWorlds, SolidsCanWalkToo) {
  const auto model = robot("panda");
  const Worlds source = worlds("families: {moving: {objects: 4, walk: 1, walker: solid, shapes: [box]}}");
  for (std::uint64_t i = 0; i < 10; ++i)
    for (const WorldObject& object : source.make(model, i).objects) {
      EXPECT_EQ(object.shape.kind, ShapeKind::kBox);
      EXPECT_NE(motion<PathMotion>(object), nullptr);
    }
}

TEST(MovingWorlds, AFileKeepsEveryBit) {
  const auto model = robot("frankie");
  const Worlds source = worlds(kAll);
  for (std::uint64_t i = 0; i < 10; ++i) {
    const World a = source.make(model, i);
    const World b = world_from_json(nlohmann::ordered_json::parse(to_json(a).dump()), "test");
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t k = 0; k < a.objects.size(); ++k)
      for (const double t : {0.0, 0.3, 7.7, 59.0, 90.0}) {
        const MovingPose x = evaluate(a.objects[k].motion, a.objects[k].X_WO, t);
        const MovingPose y = evaluate(b.objects[k].motion, b.objects[k].X_WO, t);
        EXPECT_EQ(x.X.matrix(), y.X.matrix());
        EXPECT_EQ(x.V_W, y.V_W);
      }
  }
}

TEST(MovingWorlds, WithoutThemEverythingIsAsItWas) {
  // World 1 of configs/suites/moving.yaml, written before there were circles and walkers.
  const World world = worlds("seed: 1\nfamilies: {moving: {weight: 1}}").make(robot("frankie"), 1);
  ASSERT_EQ(world.objects.size(), 3u);
  const WorldObject& box = world.objects[2];
  EXPECT_EQ(box.name, "object3");
  EXPECT_LT((box.shape.size - Vector3(0.23545395540131428, 0.3488589581710227, 0.6099021027194598)).norm(), 1e-9);
  EXPECT_LT((box.X_WO.translation() - Vector3(2.4763260638739246, -0.2696223882734714, 0.3049510513597299)).norm(),
            1e-9);
  const auto* line = motion<LinearMotion>(box);
  ASSERT_NE(line, nullptr);
  EXPECT_LT((line->V_W.tail<3>() - Vector3(-0.23526263451232157, -0.23518660334989677, 0.0)).norm(), 1e-9);
  // The parameters are part of a trial's key: none is new.
  const std::set<std::string> old{
      "start_heading",   "distance",       "direction",      "heading",        "limit_margin",    "tip_height",
      "floor_clearance", "self_clearance", "objects",        "crossing",       "speed",           "robot_speed",
      "along",           "angle",          "offset",         "horizon",        "shapes",          "standing",
      "sphere_radius",   "box_edge",       "capsule_radius", "capsule_length", "standing_height", "height"};
  const auto parameters =
      worlds("families: {moving: {walk: 0, walk_speed: 1, orbit_radius: 3}}").identity(0)["parameters"];
  std::set<std::string> now;
  for (const auto& [key, value] : parameters.items()) now.insert(key);
  EXPECT_EQ(now, old);
}

TEST(MovingWorlds, ResolvedParametersReadBack) {
  const Worlds a = worlds("families: {moving: {walk: 0.5, walker: solid, walk_pause: 0.1, orbit: 0.2, orbit_goal: 1}}");
  const Worlds b = worlds(a.to_json().dump());
  EXPECT_EQ(b.to_json(), a.to_json());
  EXPECT_EQ(a.identity(5), b.identity(5));
  EXPECT_NE(a.identity(5), worlds("families: {moving: {walk: 0.5}}").identity(5));
  const auto model = robot("frankie");
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ(to_json(a.make(model, i)).dump(), to_json(b.make(model, i)).dump());
}

TEST(MovingWorlds, RefusesWhatCannotBe) {
  const auto refused = [](const std::string& keys, const char* part) {
    try {
      worlds("families: {moving: {" + keys + "}}");
      ADD_FAILURE() << keys << " was accepted";
    } catch (const config::ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused("walk: 0.7, orbit: 0.6", "at most 1 together");
  refused("walk: 2", "walk");
  refused("walk_speed: 0", "walk_speed");
  refused("walk_radius: {normal: [0, 1]}", "walk_radius");
  refused("walker: dog", "person");
  refused("orbit_radius: 0", "orbit_radius");
  refused("orbt: 1", "did you mean orbit?");
  refused("horizon: 1e9", "horizon");
}

TEST(MovingWorlds, WhereNoOneFitsTheErrorSaysSo) {
  for (const char* keys :
       {"walk: 1, walk_radius: 8", "orbit: 1, orbit_goal: 1, orbit_radius: 0.3, shapes: [box], standing_height: 5"}) {
    try {
      worlds("tries: 3\nfamilies: {moving: {objects: 1, " + std::string(keys) + "}}").make(robot("frankie"), 0);
      ADD_FAILURE() << keys << ": a world was found";
    } catch (const GenerationError& error) {
      EXPECT_NE(std::string(error.what()).find("no path clear"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace moma::test
