// Mistakes that would look like results, and what the program says of them.
#include <SQLiteCpp/SQLiteCpp.h>

#include <nlohmann/json.hpp>
#include <string>

#include "cli_fixture.h"

namespace moma::test {
namespace {

using CliMistakes = CliTest;
using json = nlohmann::json;

TEST_F(CliMistakes, LinksFarApartThatTouchAtReadyAreAllNamed) {
  // A shape of the root that reaches the lower link and the slide, two joints and three away.
  write("robots/touching.yaml", R"(include: tiny.yaml
collision:
  shapes:
    - {link: root, shape: sphere, size: [0.3], position: [0.7, 0, 0]}
    - {link: lower, shape: sphere, size: [0.05], position: [0.1, 0, 0]}
    - {link: slide, shape: capsule, size: [0.04, 0.2], position: [0.2, 0, 0], rpy: [0, 1.5707963, 0]}
  self: auto
)");
  const ProcessResult shown = good({"robot", "robots/touching.yaml"});
  EXPECT_NE(shown.err.find("warning: self-collision: these touch at `ready`, so that their contacts never count"),
            std::string::npos)
      << shown.err;
  // The whole list is in the notes; the warning is of those that are no neighbours.
  const json whole = json::parse(good({"robot", "robots/touching.yaml", "--json"}).out);
  EXPECT_NE(whole["notes"].dump().find("in touch at `ready`: root - lower, root - slide"), std::string::npos) << whole;
  EXPECT_NE(whole["warnings"].dump().find("never count: root - slide;"), std::string::npos) << whole;
}

TEST_F(CliMistakes, AStartThatIsRefusedNamesTheShapeAndItsHeight) {
  write("robots/sunk.yaml", "include: tiny.yaml\nbase: {include: base.yaml, mount: {position: [0, 0, -0.2]}}\n");
  write("robots/base.yaml",
        "type: differential\nmax_linear: 1\nmax_angular: 2\nwheels: {radius: 0.1, separation: 0.4}\n");
  write("sunk.yaml", R"(name: sunk
robot: robots/sunk.yaml
controllers: {plain: controllers/plain.yaml}
worlds: {seed: 1, tries: 20, families: {open: {}}}
simulation: {mode: kinematic}
trials: 2
)");
  const ProcessResult refused = moma({"check", "sunk.yaml"});
  EXPECT_NE(refused.code, 0);
  EXPECT_NE((refused.out + refused.err).find("at arm.ready shape upper reaches 0.25 m below the floor"),
            std::string::npos)
      << refused.out << refused.err;
}

TEST_F(CliMistakes, CheckCountsThePointsOfASweep) {
  const ProcessResult checked =
      good({"check", "suite.yaml", "--no-time", "--set", "sweep.axes={controller.lambda_q: [0.1, 0.2, 0.3]}"});
  EXPECT_NE(checked.out.find("36 trials = 6 worlds x 2 controllers (plain, slow) x 3 sweep points"), std::string::npos)
      << checked.out;
}

TEST_F(CliMistakes, GainsThatAreWorseDoNotTakeTheirPlace) {
  // To be as far from the goal as can be: what is found arrives nowhere.
  write("tune.yaml", std::string(kSuite) + R"(success: {position: 0.6, orientation: 3.15}
tune:
  controller: plain
  variables: {controller.servo.position: {range: [0.001, 2], scale: log}}
  objective: {minimize: {success: 1}}
  budget: {trials: 80}
  worlds: 4
  racing: none
  confirm: none
  sensitivity: none
  held_out: {count: 40, seed: 9}
)");
  const ProcessResult tuned =
      good({"tune", "tune.yaml", "-o", "t.db", "-q", "--gains", "found.yaml", "--set", "simulation.time_limit=8"});
  EXPECT_NE(tuned.out.find("worse (by success)"), std::string::npos) << tuned.out;
  EXPECT_FALSE(fs::exists(path("found.yaml"))) << "worse gains under the name where better ones are looked for";
  EXPECT_TRUE(fs::exists(path("found-worse.yaml"))) << tuned.out << tuned.err;
}

TEST_F(CliMistakes, WhatIsNoYamlIsSaidInWords) {
  write("robot.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"x\"><link name=\"a\"/></robot>\n");
  bad({"check", "robot.urdf"}, {"robot.urdf:1", "begins like XML, which a URDF is; expected YAML"});
  write("tab.yaml", "name: x\n\trobot: y\n");
  bad({"check", "tab.yaml"}, {"tab.yaml:2", "a tab indents this line"});
  write("places.yaml", "name: x\n  robot: y\n");
  bad({"check", "places.yaml"}, {"places.yaml:2", "KEY: VALUE has no place here"});
  const ProcessResult refused = bad({"world", "suite.yaml", "--", "-1"}, {"-1"});
  EXPECT_LT(refused.err.size(), 200u) << refused.err;
}

TEST_F(CliMistakes, ASweepCanBeSwitchedOff) {
  write("sweep.yaml", std::string(kSuite) + "sweep: {axes: {controller.lambda_q: [0.1, 0.2, 0.3]}}\n");
  EXPECT_NE(good({"check", "sweep.yaml", "--no-time"}).out.find("x 3 sweep points"), std::string::npos);
  EXPECT_EQ(good({"check", "sweep.yaml", "--no-time", "--set", "sweep=none"}).out.find("sweep point"),
            std::string::npos);
}

TEST_F(CliMistakes, MomaAloneListsItsCommandsInGroups) {
  const std::string help = good({}).out;
  for (const char* head : {"Evaluate", "Look at results", "Keep results", "Make suites, robots and controllers"})
    EXPECT_NE(help.find(head), std::string::npos) << help;
  EXPECT_LT(help.find("  run "), help.find("  compare ")) << help;
  // Whatever no head names stands under the last: the two that are about the program itself.
  const std::string last = help.substr(help.find("\nHelp:"));
  for (const char* command : {"\n  completion ", "\n  help "}) EXPECT_NE(last.find(command), std::string::npos) << help;
  const std::string commands = last.substr(0, last.find("\n\n", 2));
  EXPECT_EQ(std::count(commands.begin(), commands.end(), '\n'), 3) << commands;
}

TEST_F(CliMistakes, AFirstSuiteIsWrittenAndGood) {
  EXPECT_NE(good({"init", "mine.yaml"}).out.find("moma check mine.yaml"), std::string::npos);
  EXPECT_NE(good({"check", "mine.yaml", "--no-time"}).out.find("mine: 80 trials = 40 worlds x 2 controllers"),
            std::string::npos);
  write("mine.yaml", "name: edited\n");
  bad({"init", "mine.yaml"}, {"mine.yaml", "--force"});
  good({"init", "a: b #1.yaml"});
  EXPECT_NE(good({"check", "a: b #1.yaml", "--no-time"}).out.find("a: b #1: 80 trials"), std::string::npos);
}

TEST_F(CliMistakes, ASearchThatFindsNothingWritesNoGains) {
  // Every candidate does the same: the cost is a constant of the outcome.
  write("tune.yaml", std::string(kSuite) + R"(success: {position: 0.6, orientation: 3.15}
tune:
  controller: plain
  variables: {controller.servo.position: {range: [0.001, 2], scale: log}}
  objective: {minimize: {error: 1}}
  budget: {trials: 40}
  worlds: 4
  racing: none
  confirm: none
  sensitivity: none
  held_out: {count: 8, seed: 9}
)");
  const ProcessResult tuned = good({"tune", "tune.yaml", "-o", "t.db", "-q", "--gains", "found.yaml"});
  EXPECT_NE(tuned.out.find("nothing better than the gains that it began with"), std::string::npos) << tuned.out;
  EXPECT_FALSE(fs::exists(path("found.yaml")));
}

TEST_F(CliMistakes, AStoreThatIsACopyOfARunThatGoesOnIsDoubted) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  SQLite::Database(path("a.db").string(), SQLite::OPEN_READWRITE)
      .exec("UPDATE invocation SET status = 'running', ended = NULL");
  const ProcessResult verified = good({"verify", "a.db", "--fraction", "0"});
  EXPECT_NE((verified.out + verified.err).find("moma merge makes whole copies"), std::string::npos)
      << verified.out << verified.err;
}

}  // namespace
}  // namespace moma::test
