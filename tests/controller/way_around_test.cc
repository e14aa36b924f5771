// Ways around obstacles, against a search on a fine grid and against lengths that follow from geometry.

#include "controller/task/way_around.h"

#include <gtest/gtest.h>

#include <queue>

#include "tests/controller/qp_robots.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

AroundParams params(double clearance = 0.0, double reach = 0.0) {
  return {.enabled = true, .clearance = clearance, .reach = reach};
}

// A floor with obstacles, and ways on it.
struct Floor {
  std::shared_ptr<const RobotModel> model = frankie();  // its base is a capsule of radius 0.3 that stands
  Proximity proximity{model};
  std::vector<ObjectShape> shapes;
  std::vector<ObjectState> states;
  WayAround way_around;

  explicit Floor(const AroundParams& p = params()) : way_around(*model, p) {}

  void put(ShapeKind kind, const Vector3& size, const Isometry& X_WO) {
    shapes.push_back({"o" + std::to_string(shapes.size()), {kind, size, nullptr}});
    states.push_back({});
    states.back().X_WO = X_WO;
    proximity.set_objects(shapes);
    way_around.allocate(static_cast<int>(shapes.size()));
  }
  void pillar(double x, double y, double radius) {
    put(ShapeKind::kCylinder, {radius, 1.0, 0}, pose(x, y, 0.5, 0, 0, 0));
  }
  void wall(double x, double y, double length, double yaw) {
    put(ShapeKind::kBox, {length, 0.1, 1.0}, pose(x, y, 0.5, 0, 0, yaw));
  }
  Way ask(const Vector2& from, const Vector2& to) { return way_around.find(proximity, states, from, to); }
  // From corner to corner; empty where there is no way.
  std::vector<Vector2> follow(const Vector2& from, const Vector2& to) {
    std::vector<Vector2> line{from};
    for (int turn = 0; turn < 50; ++turn) {
      const Way way = ask(line.back(), to);
      if (!way.found) return {};
      line.push_back(way.corner);
      if (way.straight) return line;
    }
    ADD_FAILURE() << "fifty turns and not there";
    return {};
  }
};

double length_of(const std::vector<Vector2>& line) {
  double sum = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += (line[i] - line[i - 1]).norm();
  return sum;
}

TEST(WayAround, KnowsTheFootprint) {
  EXPECT_NEAR(Floor().way_around.footprint_radius(), 0.3, 1e-12);
  // A capsule of radius 0.2 and length 0.3 that lies along x about the base's origin.
  EXPECT_NEAR(WayAround(*mecanum(), params()).footprint_radius(), 0.35, 1e-12);
}

TEST(WayAround, NothingInTheWayIsStraight) {
  Floor floor;
  floor.pillar(1.0, 1.0, 0.3);
  const Way way = floor.ask({0, 0}, {2, 0});
  EXPECT_TRUE(way.found);
  EXPECT_TRUE(way.straight);
  EXPECT_EQ(way.corner, Vector2(2, 0));
}

TEST(WayAround, LeavesAPillarOnTheNearerSide) {
  Floor floor;
  floor.pillar(1.5, 0.1, 0.2);
  const std::vector<Vector2> line = floor.follow({0, 0}, {3, 0});
  ASSERT_GE(line.size(), 3u);
  const double R = 0.5;  // footprint and pillar
  for (std::size_t i = 1; i + 1 < line.size(); ++i) EXPECT_LT(line[i].y(), 0.0) << "the pillar is to the left";
  // The shortest way around a circle: two tangents and the arc between them.
  const auto tangent = [&](const Vector2& p) { return std::sqrt((p - Vector2(1.5, 0.1)).squaredNorm() - R * R); };
  const auto half = [&](const Vector2& p) { return std::acos(R / (p - Vector2(1.5, 0.1)).norm()); };
  const Vector2 a = Vector2(0, 0) - Vector2(1.5, 0.1), b = Vector2(3, 0) - Vector2(1.5, 0.1);
  const double opening = std::acos(a.dot(b) / (a.norm() * b.norm()));
  const double shortest = tangent({0, 0}) + tangent({3, 0}) + R * (opening - half({0, 0}) - half({3, 0}));
  EXPECT_GE(length_of(line), shortest);
  EXPECT_LE(length_of(line), 1.05 * shortest);
}

TEST(WayAround, TakesAGapOnlyWhereTheBaseFits) {
  for (const double gap : {0.5, 0.8}) {
    Floor floor;
    floor.wall(2.0, 1.0 + gap / 2, 2.0, kPi / 2);
    floor.wall(2.0, -1.0 - gap / 2, 2.0, kPi / 2);
    const std::vector<Vector2> line = floor.follow({0.5, 0.6}, {3.5, -0.6});
    ASSERT_FALSE(line.empty());
    const bool through = length_of(line) < 4.0;  // else around an end, at y = +-2.6
    EXPECT_EQ(through, gap > 0.6) << "gap " << gap << ", length " << length_of(line);
  }
}

TEST(WayAround, TakesLessClearanceWhereThereIsNoWayWithIt) {
  for (const double clearance : {0.0, 0.08}) {
    Floor floor(params(clearance));
    // A square room with a door of 0.68: 0.3 of radius fit, 0.38 do not.
    floor.wall(0.0, 1.5, 3.1, 0);
    floor.wall(0.0, -1.5, 3.1, 0);
    floor.wall(-1.5, 0.0, 3.1, kPi / 2);
    floor.wall(1.5, 0.34 + 0.58, 1.16, kPi / 2);
    floor.wall(1.5, -0.34 - 0.58, 1.16, kPi / 2);
    const Way out = floor.ask({-0.5, 0.9}, {4, 0.9});
    EXPECT_TRUE(out.found);
    EXPECT_FALSE(out.straight);
    floor.pillar(1.5, 0, 0.1);  // in the door
    EXPECT_FALSE(floor.ask({-0.5, 0.9}, {4, 0.9}).found);
  }
}

TEST(WayAround, TheLastMetresAreTheArms) {
  Floor floor(params(0.0, 0.7));
  floor.pillar(2.0, 0.0, 0.2);
  EXPECT_TRUE(floor.ask({0, 0}, {2.1, 0}).straight) << "the pillar's octagon begins 0.6 m before the goal";
  EXPECT_FALSE(floor.ask({0, 0}, {2.5, 0}).straight);
}

TEST(WayAround, LooksAtWhatStandsInTheRobotsHeightOnly) {
  const auto straight = [](auto change) {
    Floor floor;
    floor.pillar(1.0, 0.0, 0.2);
    change(floor.states[0]);
    return floor.ask({0, 0}, {2, 0}).straight;
  };
  EXPECT_FALSE(straight([](ObjectState&) {}));
  EXPECT_TRUE(straight([](ObjectState& o) { o.visible = false; }));
  EXPECT_TRUE(straight([](ObjectState& o) { o.V_WO_W[4] = 0.2; })) << "it will have gone";
  EXPECT_TRUE(straight([](ObjectState& o) { o.X_WO.translation().z() = 3.0; })) << "it hangs above";
  EXPECT_TRUE(straight([](ObjectState& o) { o.X_WO.translation().x() = std::nan(""); }));
}

TEST(WayAround, StartsFromWithinAMargin) {
  Floor floor;
  floor.pillar(0.0, 0.0, 0.3);
  // In contact with the pillar, behind it: the way leads round, not through.
  const std::vector<Vector2> line = floor.follow({-0.35, 0.02}, {2, 0});
  ASSERT_GE(line.size(), 3u);
  for (std::size_t i = 1; i < line.size(); ++i) {
    for (double t = 0.0; t <= 1.0; t += 0.01)
      EXPECT_GT((line[i - 1] + t * (line[i] - line[i - 1])).norm(), 0.3) << "at " << t << " of line " << i;
  }
}

// Shortest way on a grid of 4 cm with 16 neighbours, around discs; infinite where there is none.
double grid_way(const std::vector<std::pair<Vector2, double>>& discs, const Vector2& from, const Vector2& to) {
  constexpr double kCell = 0.04;
  constexpr int kSide = 150;
  const auto place = [&](int i) -> Vector2 { return kCell * Vector2(i % kSide - kSide / 2, i / kSide - kSide / 2); };
  const auto cell = [&](const Vector2& p) {
    return static_cast<int>(std::lround(p.y() / kCell)) * kSide + static_cast<int>(std::lround(p.x() / kCell)) +
           kSide / 2 * (kSide + 1);
  };
  std::vector<bool> blocked(kSide * kSide);
  for (int i = 0; i < kSide * kSide; ++i)
    for (const auto& [centre, radius] : discs)
      if ((place(i) - centre).norm() < radius) blocked[static_cast<std::size_t>(i)] = true;
  std::vector<double> cost(kSide * kSide, std::numeric_limits<double>::infinity());
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> open;
  cost[static_cast<std::size_t>(cell(from))] = 0.0;
  open.emplace(0.0, cell(from));
  while (!open.empty()) {
    const auto [c, i] = open.top();
    open.pop();
    if (i == cell(to)) return c;
    if (c > cost[static_cast<std::size_t>(i)]) continue;
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        if (dx % 2 == 0 && dy % 2 == 0) continue;
        const int x = i % kSide + dx, y = i / kSide + dy, j = y * kSide + x;
        if (x < 0 || y < 0 || x >= kSide || y >= kSide || blocked[static_cast<std::size_t>(j)]) continue;
        const double next = c + kCell * std::hypot(dx, dy);
        if (next >= cost[static_cast<std::size_t>(j)]) continue;
        cost[static_cast<std::size_t>(j)] = next;
        open.emplace(next, j);
      }
    }
  }
  return std::numeric_limits<double>::infinity();
}

// The octagon of a disc of radius r contains the disc, and is contained in one of radius r / cos(22.5 degrees).
TEST(WayAround, AsShortAsOnAGridAndFoundWhereThatFindsOne) {
  Rng rng(7);
  int around = 0;
  for (int scene = 0; scene < 60; ++scene) {
    Floor floor;
    std::vector<std::pair<Vector2, double>> least, most;
    const Vector2 from(-2.4, uniform(rng, -2.4, 2.4)), to(2.4, uniform(rng, -2.4, 2.4));
    while (floor.shapes.size() < 25) {
      const Vector2 p(uniform(rng, -2.8, 2.8), uniform(rng, -2.8, 2.8));
      const double radius = uniform(rng, 0.05, 0.3);
      if ((p - from).norm() < radius + 0.4 || (p - to).norm() < radius + 0.4) continue;
      floor.pillar(p.x(), p.y(), radius);
      least.emplace_back(p, radius + 0.3 - 0.06);  // less the grid's half diagonals
      most.emplace_back(p, (radius + 0.3) / std::cos(kPi / 8) + 0.06);
    }
    const std::vector<Vector2> line = floor.follow(from, to);
    const double shortest = grid_way(least, from, to), safe = grid_way(most, from, to);
    if (std::isfinite(safe)) {
      EXPECT_FALSE(line.empty()) << "scene " << scene << ": the grid found a way of " << safe << " m";
    }
    if (line.empty()) continue;
    around += line.size() > 2 ? 1 : 0;
    // A grid with 16 neighbours is at most 2.8 % longer than a straight line, and ends up to a cell off.
    EXPECT_GE(length_of(line), shortest / 1.028 - 0.12) << "scene " << scene;
    EXPECT_LE(length_of(line), safe + 0.12) << "scene " << scene;
    for (std::size_t i = 1; i < line.size(); ++i) {
      for (double t = 0.0; t <= 1.0; t += 0.02) {
        const Vector2 p = line[i - 1] + t * (line[i] - line[i - 1]);
        for (std::size_t j = 0; j < least.size(); ++j)
          EXPECT_GT((p - least[j].first).norm(), least[j].second + 0.06 - 1e-9)
              << "scene " << scene << ", pillar " << j;
      }
    }
  }
  EXPECT_GT(around, 20);
}

TEST(WayAround, TakesNoMemoryAndIsTheSameEachTime) {
  Rng rng(8);
  Floor floor;
  for (int i = 0; i < 60; ++i) floor.pillar(uniform(rng, -3, 3), uniform(rng, -3, 3), uniform(rng, 0.05, 0.15));
  const Way first = floor.ask({-3, -3}, {3, 3});
  const NoAlloc guard;
  for (int i = 0; i < 20; ++i) {
    const Way again = floor.ask({-3, -3}, {3, 3});
    EXPECT_EQ(again.found, first.found);
    EXPECT_EQ(again.corner, first.corner);
  }
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace moma
