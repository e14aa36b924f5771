// The map's cells against OctoMap's, rays against a walk in small steps, boxes against every cell by itself.

#include <gtest/gtest.h>

#include <random>
#include <set>

#ifdef MOMA_HAVE_OCTOMAP
#include <dynamicEDT3D/dynamicEDTOctomap.h>
#include <octomap/octomap.h>
#endif

#include "controller/map/occupancy_map.h"
#include "tests/support/no_alloc.h"

namespace moma::test {
namespace {

constexpr double kCell = 0.05;

struct Frame {
  Vector3 from;
  std::vector<Vector3> ends;
};

// Points on two walls and a ball, seen from a few places; the last frames see the ball's place empty.
std::vector<Frame> frames() {
  std::mt19937 engine(5);
  std::normal_distribution<> noise(0.0, 0.01);
  std::uniform_real_distribution<> turn(-1.2, 1.2), place(-0.4, 0.4);
  std::vector<Frame> out;
  for (int k = 0; k < 12; ++k) {
    Frame& frame = out.emplace_back();
    frame.from = Vector3(place(engine), place(engine), 1.0 + 0.5 * place(engine));
    for (int i = 0; i < 1500; ++i) {
      const double a = turn(engine), e = 0.5 * turn(engine);
      const Vector3 u(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      double r = std::min(2.12 / std::abs(u.x()), 1.92 / std::abs(u.y()));
      const Vector3 ball(1.2, 0.1, 1.0);
      const double along = u.dot(ball - frame.from);
      if (k < 6 && (frame.from + along * u - ball).norm() < 0.2) r = std::min(r, along - 0.1);
      if (u.z() < 0.0) r = std::min(r, (frame.from.z() - 0.06) / -u.z());
      if (u.z() > 0.0) r = std::min(r, (1.9 - frame.from.z()) / u.z());
      frame.ends.push_back(frame.from + std::max(0.1, r + noise(engine)) * u);
    }
  }
  return out;
}

void insert(const Frame& frame, OccupancyMap& map) {
  for (const Vector3& end : frame.ends) map.hit(end, (end - frame.from).normalized());
  for (const Vector3& end : frame.ends) map.pass(frame.from, end);
  map.end();
}

OccupancyMap filled(const MapParams& params = {}) {
  OccupancyMap map(params);
  for (const Frame& frame : frames()) insert(frame, map);
  return map;
}

template <class Visit>
void each_cell(const OccupancyMap& map, Visit visit) {
  Eigen::Vector3i c;
  for (c.x() = 0; c.x() < map.cells().x(); ++c.x())
    for (c.y() = 0; c.y() < map.cells().y(); ++c.y())
      for (c.z() = 0; c.z() < map.cells().z(); ++c.z()) visit(c);
}

Vector3 middle(const OccupancyMap& map, const Eigen::Vector3i& c) {
  return map.low_corner(c) + Vector3::Constant(0.5 * map.cell());
}

#ifdef MOMA_HAVE_OCTOMAP
octomap::point3d point(const Vector3& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

octomap::OcTree oracle() {
  octomap::OcTree tree(kCell);
  const auto probability = [](double log_odds) { return octomap::probability(log_odds); };
  tree.setProbHit(probability(0.85));
  tree.setProbMiss(probability(-0.4));
  tree.setClampingThresMin(probability(-2.0));
  tree.setClampingThresMax(probability(3.5));
  for (const Frame& frame : frames()) {
    octomap::Pointcloud cloud;
    for (const Vector3& end : frame.ends) cloud.push_back(point(end));
    tree.insertPointCloud(cloud, point(frame.from));
  }
  return tree;
}

TEST(OccupancyMap, HasTheLogOddsOfOctoMap) {
  const OccupancyMap map = filled();
  const octomap::OcTree tree = oracle();
  long touched = 0, occupied = 0, off = 0;
  each_cell(map, [&](const Eigen::Vector3i& c) {
    const octomap::OcTreeNode* node = tree.search(point(middle(map, c)));
    if (node == nullptr && map.unseen(c)) return;
    ++touched;
    occupied += map.occupied(c) ? 1 : 0;
    if (node == nullptr || map.unseen(c) || std::abs(node->getLogOdds() - map.odds(c) * OccupancyMap::kUnit) > 0.01)
      ++off;
  });
  EXPECT_GT(touched, 40'000);
  EXPECT_GT(occupied, 1500);
  // OctoMap walks with single precision: a ray may touch another cell at a corner.
  EXPECT_LT(off, touched / 1000) << "of " << touched;
}

// The distance to the middle of the nearest occupied cell is that to the boxes without half a cell at each face.
TEST(OccupancyMap, BoxesAreAsFarAsTheDistanceTransformSays) {
  OccupancyMap map = filled();
  octomap::OcTree tree = oracle();
  const octomap::point3d low = point({-3.0, -3.0, 0.0}), high = point({3.0, 3.0, 1.99});
  constexpr float kMost = 0.6F;
  DynamicEDTOctomap transform(kMost, &tree, low, high, false);
  transform.update();
  std::vector<CellBox> boxes;
  boxes.reserve(10'000);
  map.cover(OccupancyMap::Kind::kOccupied, {{0, 0, 0}, map.cells()}, boxes);
  std::mt19937 engine(6);
  std::uniform_real_distribution<> x(-2.0, 2.0), z(0.2, 1.8);
  int near = 0, off = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3 p = middle(map, map.cell_of({x(engine), x(engine), z(engine)}));
    double found = kMost;
    for (const CellBox& box : boxes) {
      const Vector3 at = p.cwiseMax(middle(map, box.low)).cwiseMin(middle(map, box.high - Eigen::Vector3i::Ones()));
      found = std::min(found, (at - p).norm());
    }
    const double wanted = std::min<double>(kMost, transform.getDistance(point(p)));
    near += wanted < kMost ? 1 : 0;
    // The transform spreads over neighbours, which misses the nearest cell now and then (Lau et al. 2013).
    off += std::abs(found - wanted) > 1e-3 ? 1 : 0;
  }
  EXPECT_GT(near, 800);
  EXPECT_LT(off, 30);
}
#endif

TEST(OccupancyMap, ARayFreesWhatASmallStepMeets) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<> place(-4.0, 4.0), inside(-2.0, 2.0), height(-0.5, 2.5);
  for (int k = 0; k < 60; ++k) {
    OccupancyMap map(MapParams{});
    const Vector3 from(inside(engine), inside(engine), 1.0 + 0.3 * inside(engine));
    const Vector3 to = k % 10 == 0 ? Vector3(from.x(), place(engine), from.z())
                                   : Vector3(place(engine), place(engine), height(engine));
    map.pass(from, to);
    map.end();
    OccupancyMap walked(MapParams{});
    const int parts = static_cast<int>((to - from).norm() / 1e-4) + 1;
    for (int i = 0; i < parts; ++i) {
      const Eigen::Vector3i cell = walked.cell_of(from + (i / static_cast<double>(parts)) * (to - from));
      if (cell != walked.cell_of(to)) walked.take_for_free(cell, false);
    }
    int free = 0, off = 0;
    each_cell(map, [&](const Eigen::Vector3i& c) {
      free += map.unseen(c) ? 0 : 1;
      off += map.unseen(c) != walked.unseen(c) ? 1 : 0;
    });
    EXPECT_GT(free, 3) << k;
    EXPECT_LE(off, 3) << "cells whose corner alone the ray meets, ray " << k;
  }
}

TEST(OccupancyMap, BoxesCoverEachCellOnce) {
  OccupancyMap map = filled();
  for (const OccupancyMap::Kind kind : {OccupancyMap::Kind::kOccupied, OccupancyMap::Kind::kUnseen}) {
    const CellBox region{{20, 30, 2}, {115, 110, 33}};
    std::vector<CellBox> boxes;
    boxes.reserve(20'000);
    map.cover(kind, region, boxes);
    ASSERT_LT(boxes.size(), boxes.capacity());
    std::vector<int> covered(static_cast<std::size_t>(map.cells().prod()), 0);
    const auto at = [&](const Eigen::Vector3i& c) {
      return static_cast<std::size_t>((c.x() * map.cells().y() + c.y()) * map.cells().z() + c.z());
    };
    for (const CellBox& box : boxes) {
      EXPECT_LE((box.high - box.low).maxCoeff(), OccupancyMap::kLongest);
      for (int x = box.low.x(); x < box.high.x(); ++x)
        for (int y = box.low.y(); y < box.high.y(); ++y)
          for (int z = box.low.z(); z < box.high.z(); ++z) ++covered[at({x, y, z})];
    }
    long wrong = 0, wanted = 0;
    each_cell(map, [&](const Eigen::Vector3i& c) {
      const bool in = (c.array() >= region.low.array()).all() && (c.array() < region.high.array()).all();
      const bool is = in && (kind == OccupancyMap::Kind::kOccupied ? map.occupied(c) : map.unseen(c));
      wanted += is ? 1 : 0;
      wrong += covered[at(c)] != (is ? 1 : 0) ? 1 : 0;
    });
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(wanted, 500);
    EXPECT_LT(static_cast<long>(boxes.size()), 2 * wanted / 3) << "boxes of more than one cell";
    std::vector<CellBox> few;
    few.reserve(3);
    map.cover(kind, region, few);
    EXPECT_EQ(few.size(), 3u) << "as many as there is room for";
  }
}

TEST(OccupancyMap, UnseenCellsCountInCubesWithoutAFreeCellAndBehindHits) {
  struct Case {
    double least;
    int edge;
    double behind;
    int deep;
  };
  for (const auto& [least, edge, behind, deep] :
       {Case{0.1, 2, 0.0, 0}, {0.15, 3, 0.0, 0}, {0.15, 3, 0.05, 1}, {0.15, 3, 0.2, 4}, {0.25, 5, 0.1, 2}}) {
    SCOPED_TRACE(testing::Message() << "least " << least << ", behind " << behind);
    MapParams params;
    params.unseen.least = least;
    params.unseen.behind = behind;
    OccupancyMap map = filled(params);
    const CellBox region{{0, 30, 2}, {115, 128, 33}};
    std::vector<CellBox> boxes;
    boxes.reserve(20'000);
    map.cover(OccupancyMap::Kind::kUnseen, region, boxes);
    const auto each_of = [](const CellBox& box, auto&& of) {
      Eigen::Vector3i c;
      for (c.x() = box.low.x(); c.x() < box.high.x(); ++c.x())
        for (c.y() = box.low.y(); c.y() < box.high.y(); ++c.y())
          for (c.z() = box.low.z(); c.z() < box.high.z(); ++c.z())
            if (!of(c)) return false;
      return true;
    };
    const auto hides = [&](const Eigen::Vector3i& c) {
      return (c.array() < 0).any() || (c.array() >= map.cells().array()).any() || map.unseen(c) || map.occupied(c);
    };
    const auto at = [&](const Eigen::Vector3i& c) {
      return static_cast<std::size_t>((c.x() * map.cells().y() + c.y()) * map.cells().z() + c.z());
    };
    std::vector<char> covered(static_cast<std::size_t>(map.cells().prod()), 0), counts = covered;
    for (const CellBox& box : boxes) each_of(box, [&](const Eigen::Vector3i& c) { return covered[at(c)] = 1, true; });
    const Eigen::Vector3i more = Eigen::Vector3i::Constant(edge);
    each_of({{1 - edge, 1 - edge, 0}, map.cells()},
            [&](const Eigen::Vector3i& low) {  // no cube reaches below the floor
              const CellBox cube{low, low + more};
              if (!each_of(cube, hides)) return true;
              return each_of({low.cwiseMax(0), cube.high.cwiseMin(map.cells())},
                             [&](const Eigen::Vector3i& c) { return counts[at(c)] = map.unseen(c), true; });
            });
    // The first hit of a cell in a frame hides what lies behind it along the ray.
    std::set<std::size_t> hidden;
    for (const Frame& frame : frames()) {
      std::set<std::size_t> hits;
      for (const Vector3& end : frame.ends) {
        if (!hits.insert(at(map.cell_of(end))).second) continue;
        const Vector3 step = params.cell * (end - frame.from).normalized();
        for (int k = 1; k <= deep; ++k)
          if (const Eigen::Vector3i c = map.cell_of(end + k * step); c.z() < map.cells().z()) hidden.insert(at(c));
      }
    }
    long wrong = 0, wanted = 0, pockets = 0, behind_hits = 0;
    each_of(region, [&](const Eigen::Vector3i& c) {
      if (map.unseen(c) && !counts[at(c)] && hidden.contains(at(c))) {
        counts[at(c)] = 1;
        ++behind_hits;
      }
      wanted += counts[at(c)];
      pockets += map.unseen(c) && !counts[at(c)] ? 1 : 0;
      wrong += covered[at(c)] != counts[at(c)] ? 1 : 0;
      return true;
    });
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(wanted, 500);
    EXPECT_GT(pockets, 100);
    if (deep > 0) {
      EXPECT_GT(behind_hits, 100);
    }
  }
}

TEST(OccupancyMap, MovesWithTheRobotAndForgetsWhatItLeaves) {
  OccupancyMap map = filled();
  const OccupancyMap before = filled();
  EXPECT_FALSE(map.centre(0.3, -0.3)) << "not for a few cells";
  ASSERT_TRUE(map.centre(1.0, -0.8));
  long kept = 0, wrong = 0, fresh = 0;
  each_cell(map, [&](const Eigen::Vector3i& c) {
    const Eigen::Vector3i then = before.cell_of(middle(map, c));
    const bool inside = (then.array() >= 0).all() && (then.array() < before.cells().array()).all();
    (inside ? kept : fresh) += 1;
    if (map.odds(c) != (inside ? before.odds(then) : OccupancyMap::kUnseen)) ++wrong;
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(kept, 100'000);
  EXPECT_GT(fresh, 100'000);
  std::vector<CellBox> boxes;
  boxes.reserve(10'000);
  map.cover(OccupancyMap::Kind::kOccupied, {{0, 0, 0}, map.cells()}, boxes);
  EXPECT_GT(boxes.size(), 50u) << "columns know their cells after the move";
}

TEST(OccupancyMap, TellsOfCellsThatItsBoxesMiss) {
  OccupancyMap map(MapParams{});
  const CellBox all{{0, 0, 0}, map.cells()};
  const Vector3 ahead = Vector3::UnitX();
  EXPECT_FALSE(map.uncovered());
  map.hit({1.0, 0.5, 0.7}, ahead);
  map.end();
  std::vector<CellBox> boxes;
  boxes.reserve(10);
  map.cover(OccupancyMap::Kind::kOccupied, all, boxes);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_FALSE(map.uncovered());
  map.hit({1.0, 0.5, 0.7}, ahead);
  map.end();
  EXPECT_FALSE(map.uncovered());
  map.hit({1.0, 0.5, 0.8}, ahead);
  map.end();
  EXPECT_TRUE(map.uncovered());
  map.cover(OccupancyMap::Kind::kOccupied, {{0, 0, 0}, map.cell_of({0.8, 0.5, 0.7})}, boxes);
  EXPECT_FALSE(map.uncovered());
  map.hit({1.0, 0.5, 0.9}, ahead);
  map.end();
  EXPECT_FALSE(map.uncovered()) << "outside the region";
}

TEST(OccupancyMap, TakesNoMemory) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  const std::vector<Frame> seen = frames();
  OccupancyMap map(MapParams{});
  std::vector<CellBox> boxes;
  boxes.reserve(10'000);
  const NoAlloc guard;
  for (int k = 0; k < 300; ++k) insert({seen[static_cast<std::size_t>(k) % seen.size()].from, {}}, map);
  for (const Frame& frame : seen) {
    insert(frame, map);
    map.centre(frame.from.x() * 4.0, 0.0);
    map.cover(OccupancyMap::Kind::kOccupied, {{0, 0, 0}, map.cells()}, boxes);
  }
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace moma::test
