// Every family's worlds, proved solvable by coal and forward kinematics; the same for any threads and neighbours.
//
// MOMA_WORLDS=N makes N worlds of each family.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/world/world_proof.h"
#include "world/scenario/family.h"
#include "world/world_json.h"

namespace moma::test {
namespace {

constexpr double kHorizon = 60.0;    // of `moving`'s promise [s]
constexpr double kProofStep = 0.05;  // 7 cm of a person's way [s]

int wanted(int usual) {
  const char* text = std::getenv("MOMA_WORLDS");
  const int asked = text != nullptr ? std::atoi(text) : 0;
  return asked > 0 ? asked : usual;
}

struct Case {
  std::string robot;
  std::string name;
  std::string family;
  int worlds = 1000;
};

/// Every family with its own parameters, and one in which walkers, circles and straight lines meet.
std::vector<std::string> sections() {
  std::vector<std::string> out;
  for (const FamilyType& type : family_types()) out.push_back(std::string(type.name) + ": {}");
  out.emplace_back("moving: {walk: 0.4, orbit: 0.3}");
  return out;
}

std::string name_of(const std::string& section) { return section.substr(0, section.find(':')); }

class EveryWorld : public testing::TestWithParam<Case> {};

TEST_P(EveryWorld, IsSolvedByItsWitness) {
  const Case& param = GetParam();
  const auto model = robot_for(param.robot, name_of(param.family));
  const Worlds source = worlds(fmt::format("seed: 77\nfamilies: {{{}}}", param.family));
  if (is_for_others(source, model)) return;
  WorldProof proof(model);
  const double clearance = at_witness(source);
  const int count = wanted(param.worlds);
  std::size_t objects = 0;
  for (int i = 0; i < count; ++i) {
    const World world = source.make(model, static_cast<std::uint64_t>(i));
    objects += world.objects.size();
    proof.check(world, source.clearance(), kHorizon, kProofStep, clearance);
    EXPECT_EQ(world.family, name_of(param.family));
    EXPECT_EQ(world.robot, model->name);
    EXPECT_EQ(world.difficulty.objects, static_cast<int>(world.objects.size()));
    if (HasFatalFailure()) FAIL() << "world " << i << ": " << to_json(world).dump();
  }
  fmt::print("{} worlds, {} objects\n", count, objects);
}

/// Every family on a base that drives and on one that does not, and what other robots and `moving` add to that.
std::vector<Case> cases() {
  const std::string orbit = "moving: {orbit: 1}";
  const std::string walk = "moving: {walk: 1}";
  std::vector<Case> out;
  for (const auto& [robot, count] :
       {std::pair{"frankie", 1000}, {"panda", 1000}, {"frankie_omni", 200}, {"lift_ur5", 200}, {"ur5", 200}})
    for (const FamilyType& type : family_types()) {
      const bool dear = type.name == "pick-place";  // to make, ten times as much as others
      out.push_back({robot, std::string(type.name), std::string(type.name) + ": {}", dear ? count / 5 : count});
    }
  for (const std::string robot : {"frankie", "panda"}) {
    out.push_back({robot, "orbit", orbit});
    out.push_back({robot, "walk", walk});
  }
  out.push_back({"frankie", "mixed", "moving: {walk: 0.4, orbit: 0.3, walker: solid}"});
  out.push_back({"lift_ur5", "walk", walk});
  return out;
}

INSTANTIATE_TEST_SUITE_P(Families, EveryWorld, testing::ValuesIn(cases()),
                         [](const auto& p) { return part_of_name(p.param.robot + "_" + p.param.name); });

class CloseGoals : public testing::TestWithParam<const char*> {};

TEST_P(CloseGoals, AreAsNearAsTheirClearanceSays) {
  const auto model = robot(GetParam());
  WorldProof proof(model);
  for (const std::string family : {"grasp", "insert"}) {
    std::set<std::string> names;
    for (const double clearance : {0.005, 0.02, 0.05}) {
      const Worlds source = worlds(fmt::format("seed: 5\nfamilies: {{{}: {{clearance: {}}}}}", family, clearance));
      for (std::uint64_t i = 0; i < 12; ++i) {
        const World world = source.make(model, i);
        proof.check(world, 0.05, 0.0, 1.0, clearance);
        if (HasFatalFailure()) FAIL() << to_json(world).dump();
        EXPECT_NEAR(proof.least_at_witness(world), clearance, 1e-3) << to_json(world).dump();
        EXPECT_NEAR(world.difficulty.witness_clearance_m, clearance, 1e-3);
        for (const WorldObject& object : world.objects) names.insert(object.name);
      }
    }
    EXPECT_EQ(names, family == "insert" ? std::set<std::string>({"board1", "board2"})
                                        : std::set<std::string>({"box", "can", "handle", "panel", "post"}));
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, CloseGoals, testing::Values("frankie", "frankie_omni", "panda", "ur5", "lift_ur5"),
                         [](const auto& p) { return std::string(p.param); });

TEST(CloseGoals, RefuseWhatCannotBe) {
  const auto error_of = [](const std::string& family) -> std::string {
    try {
      worlds("tries: 200\nfamilies: {" + family + "}").make(robot("panda"), 0);
      return "";
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  for (const auto& [family, what] :
       {std::pair{"grasp: {can: 0, handle: 0, box: 0}", "one of can, handle, box"},
        std::pair{"grasp: {clearance: 0}", "grasp.clearance"},
        std::pair{"insert: {clearance: 0.3}", "insert.clearance"}, std::pair{"insert: {depth: 2}", "insert: a board"}})
    EXPECT_NE(error_of(family).find(what), std::string::npos) << family << ": " << error_of(family);
}

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

TEST(EveryFamily, IsTheSameOnOneThreadAndOnFour) {
  const auto model = robot("frankie");
  std::string all = "moving: {walk: 0.4, orbit: 0.3}";
  for (const std::string& type : families_for_driving())
    if (type != "moving") all += fmt::format(", {}: {{}}", type);
  const std::vector<std::string> one = made(worlds("seed: 3\nfamilies: {" + all + "}"), model, 240, 1);
  EXPECT_EQ(made(worlds("seed: 3\nfamilies: {" + all + "}"), model, 240, 4), one);
}

TEST(EveryFamily, IsTheSameBesideFamiliesOfWeightZero) {
  const auto model = robot("frankie");
  for (const std::string& family : sections()) {
    const std::string name = name_of(family);
    if (name == "desk") continue;  // frankie drives
    std::string others;
    for (const FamilyType& other : family_types())
      if (other.name != name) others += fmt::format("{}: {{weight: 0}}, ", other.name);
    const Worlds alone = worlds(fmt::format("seed: 3\nfamilies: {{{}}}", family));
    const Worlds among = worlds(fmt::format("seed: 3\nfamilies: {{{}{}}}", others, family));
    EXPECT_EQ(made(among, model, 30, 1), made(alone, model, 30, 1)) << family;
    for (std::uint64_t i = 0; i < 30; ++i) EXPECT_EQ(among.identity(i), alone.identity(i)) << family;
  }
}

TEST(EveryFamily, ReadsBackWhatItWrites) {
  for (const std::string& family : sections()) {
    const Worlds source = worlds("families: {" + family + "}");
    const nlohmann::ordered_json json = source.to_json();
    EXPECT_EQ(worlds(json.dump()).to_json().dump(), json.dump()) << family;
    EXPECT_EQ(json["families"].begin().key(), name_of(family));
  }
}

TEST(EveryFamily, IsNamedWhereAnUnknownOneIsAskedFor) {
  std::string list;
  for (const FamilyType& type : family_types()) list += (list.empty() ? "" : ", ") + std::string(type.name);
  try {
    worlds("families: {labyrinth: {}}");
    FAIL() << "accepted";
  } catch (const config::ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("families are: " + list), std::string::npos) << error.what();
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
        Rejected{"home: {}", "home: the furniture at the goal stands in a door"},
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
