// Every family's worlds, proved solvable by coal and forward kinematics; the same for any threads and neighbours.
//
// MOMA_WORLDS=N makes N worlds of each family instead of 1,000.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

#include "tests/world/world_proof.h"

namespace moma::test {
namespace {

constexpr double kHorizon = 60.0;  // of `moving`'s promise [s]
constexpr double kStep = 0.05;     // 7 cm of a person's way [s]

int wanted() {
  const char* text = std::getenv("MOMA_WORLDS");
  const int asked = text != nullptr ? std::atoi(text) : 0;
  return asked > 0 ? asked : 1000;
}

struct Case {
  const char* robot;
  const char* name;
  const char* family;
};

class EveryWorld : public testing::TestWithParam<Case> {};

TEST_P(EveryWorld, IsSolvedByItsWitness) {
  const Case& param = GetParam();
  const auto model = robot(param.robot);
  const Worlds source = worlds(fmt::format("seed: 77\nfamilies: {{{}}}", param.family));
  WorldProof proof(model);
  const int count = wanted();
  std::size_t objects = 0;
  for (int i = 0; i < count; ++i) {
    const World world = source.make(model, static_cast<std::uint64_t>(i));
    objects += world.objects.size();
    proof.check(world, source.clearance(), kHorizon, kStep);
    if (HasFatalFailure()) FAIL() << "world " << i << ": " << to_json(world).dump();
  }
  fmt::print("{} worlds, {} objects\n", count, objects);
}

constexpr const char* kOpen = "open: {}";
constexpr const char* kClutter = "clutter: {}";
constexpr const char* kTable = "table: {}";
constexpr const char* kShelf = "shelf: {}";
constexpr const char* kDoorway = "doorway: {}";
constexpr const char* kCorridor = "corridor: {}";
constexpr const char* kTracking = "tracking: {}";
constexpr const char* kMoving = "moving: {}";
constexpr const char* kOrbit = "moving: {orbit: 1}";
constexpr const char* kWalk = "moving: {walk: 1}";
constexpr const char* kMixed = "moving: {walk: 0.4, orbit: 0.3, walker: solid}";

INSTANTIATE_TEST_SUITE_P(Families, EveryWorld,
                         testing::Values(Case{"frankie", "open", kOpen}, Case{"frankie", "clutter", kClutter},
                                         Case{"frankie", "table", kTable}, Case{"frankie", "shelf", kShelf},
                                         Case{"frankie", "doorway", kDoorway}, Case{"frankie", "corridor", kCorridor},
                                         Case{"frankie", "tracking", kTracking}, Case{"frankie", "moving", kMoving},
                                         Case{"frankie", "orbit", kOrbit}, Case{"frankie", "walk", kWalk},
                                         Case{"frankie", "mixed", kMixed}, Case{"panda", "open", kOpen},
                                         Case{"panda", "clutter", kClutter}, Case{"panda", "table", kTable},
                                         Case{"panda", "shelf", kShelf}, Case{"panda", "tracking", kTracking},
                                         Case{"panda", "moving", kMoving}, Case{"panda", "orbit", kOrbit},
                                         Case{"panda", "walk", kWalk}, Case{"lift_ur5", "corridor", kCorridor},
                                         Case{"lift_ur5", "walk", kWalk}, Case{"frankie_omni", "doorway", kDoorway}),
                         [](const auto& p) { return std::string(p.param.robot) + "_" + p.param.name; });

/// Fresh workspaces on every thread, one source for all.
std::vector<std::string> made(const Worlds& source, const std::shared_ptr<const RobotModel>& model, std::uint64_t count,
                              std::uint64_t threads) {
  std::vector<std::string> out(count);
  std::vector<std::thread> pool;
  for (std::uint64_t first = 0; first < threads; ++first)
    pool.emplace_back([&, first] {
      for (std::uint64_t i = first; i < count; i += threads) out[i] = to_json(source.make(model, i)).dump();
    });
  for (std::thread& thread : pool) thread.join();
  return out;
}

constexpr const char* kEveryFamily[] = {
    "open: {}",    "clutter: {}",  "table: {}",    "shelf: {}",
    "doorway: {}", "corridor: {}", "tracking: {}", "moving: {walk: 0.4, orbit: 0.3}"};

TEST(EveryFamily, IsTheSameOnOneThreadAndOnFour) {
  std::string all;
  for (const char* family : kEveryFamily) all += std::string(all.empty() ? "" : ", ") + family;
  const auto model = robot("frankie");
  const std::vector<std::string> one = made(worlds("seed: 3\nfamilies: {" + all + "}"), model, 240, 1);
  EXPECT_EQ(made(worlds("seed: 3\nfamilies: {" + all + "}"), model, 240, 4), one);
}

TEST(EveryFamily, IsTheSameBesideFamiliesOfWeightZero) {
  const auto model = robot("frankie");
  for (const char* family : kEveryFamily) {
    const std::string name = std::string(family).substr(0, std::string(family).find(':'));
    std::string others;
    for (const char* other : kEveryFamily) {
      const std::string key = std::string(other).substr(0, std::string(other).find(':'));
      if (key != name) others += key + ": {weight: 0}, ";
    }
    const Worlds alone = worlds(fmt::format("seed: 3\nfamilies: {{{}}}", family));
    const Worlds among = worlds(fmt::format("seed: 3\nfamilies: {{{}{}}}", others, family));
    EXPECT_EQ(made(among, model, 30, 1), made(alone, model, 30, 1)) << name;
    for (std::uint64_t i = 0; i < 30; ++i) EXPECT_EQ(among.identity(i), alone.identity(i)) << name;
  }
}

/// Parameters under which many tries fail for the family's own reason.
struct Rejected {
  const char* family;
  const char* because;
  const char* redrawn = nullptr;
};

TEST(EveryFamily, CountsEveryRejectedTryByItsReason) {
  const auto model = robot("frankie");
  for (const Rejected& param :
       {Rejected{"open: {tip_height: 0.9}", "goal: too low (tip_height)"}, Rejected{"open: {}", "goal: self-collision"},
        Rejected{"clutter: {objects: 1, lateral: 0, along: {choice: [0, 0.5]}}", "objects: no place clear of start",
                 "an object not clear of start and goal"},
        Rejected{"table: {above: 0.5}", "table: the goal is at no height for a table"},
        Rejected{"shelf: {}", "shelf: the tool does not point into it (level)"},
        Rejected{"doorway: {along: 1}", "doorway: the goal is not behind it"},
        Rejected{"corridor: {width: 0.9}", "corridor: start or goal outside its walls"},
        Rejected{"moving: {objects: 1, orbit: 1, orbit_radius: 0.3, shapes: [box], standing_height: 5}",
                 "objects: no path clear of start and goal", "a path not clear of start and goal"},
        Rejected{"tracking: {speed: 0.5}", "tracking: too fast to follow (speed)"}}) {
    const Worlds source = worlds(fmt::format("seed: 5\nfamilies: {{{}}}", param.family));
    MakingLog log;
    for (std::uint64_t i = 0; i < 20; ++i) source.make(model, i, &log);
    std::uint64_t rejected = 0;
    bool named = false;
    for (const auto& [why, count] : log.rejections) {
      rejected += count;
      named = named || why.rfind(param.because, 0) == 0;
    }
    EXPECT_EQ(log.worlds, 20u) << param.family;
    EXPECT_EQ(log.tries, log.worlds + rejected) << param.family << ": one reason for each rejected try";
    EXPECT_TRUE(named) << param.family << ": " << param.because;
    if (param.redrawn != nullptr) {
      EXPECT_GT(log.redraws[param.redrawn], 0u) << param.family;
    }
  }
}

TEST(EveryFamily, CountsWhatFailedWhereNoWorldIsFound) {
  MakingLog log;
  EXPECT_THROW(worlds("tries: 30\nfamilies: {open: {tip_height: 9}}").make(robot("panda"), 0, &log), GenerationError);
  EXPECT_EQ(log.worlds, 0u);
  EXPECT_EQ(log.tries, 30u);
  EXPECT_EQ(log.rejections["goal: too low (tip_height)"], 30u);
}

}  // namespace
}  // namespace moma::test
