// Controllers in processes of their own, by the protocol alone: whatever a process does ends its trial with a reason
// and nothing else, and what its trials are known by is what it is made of.

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <set>
#include <thread>

#include "controller/step.h"
#include "tests/plugin/foreign_suite.h"
#include "tests/support/no_alloc.h"

namespace moma::test {
namespace {

namespace fs = std::filesystem;

class Processes : public ForeignSuite {
 protected:
  void SetUp() override { fs::copy_file(MOMA_BINARY_DIR "/tests/processes/odd_process", folder_.root() / "odd"); }
  static std::string odd(const std::string& deed, const std::string& more = "") {
    return "{method: process, command: [./odd" + (deed.empty() ? "" : ", " + deed) + "]" + more + "}";
  }
};

TEST_F(Processes, DriveTheRobot) {
  const TrialOutput output = run(load(odd("")));
  ASSERT_GT(output.trace.size(), 10u) << output.row.reason;
  EXPECT_EQ(output.trace[5].command, (VectorX(5) << 0.1, 0, 0, 0, 0).finished());
  EXPECT_EQ(output.row.outcome, Outcome::kTimeout) << output.row.reason;
}

TEST_F(Processes, MistakesAreNamedWithTheirPlace) {
  expect_error("{method: process}", "command", "the program and its arguments");
  expect_error("{method: process, command: {}}", "command", "found a map, expected a list of words");
  expect_error("{method: process, command: []}", "command", "expected a list of words");
  expect_error("{method: process, command: [./none]}", "command", "no file");
  expect_error("{method: process, command: [no-such-program-anywhere]}", "command", "No such file or directory");
  expect_error("{method: process, command: [./robots/tiny.yaml]}", "command", "Permission denied");
  expect_error("{method: process, command: [./odd], directory: nowhere}", "directory", "which is no folder");
  expect_error("{method: process, command: [./odd], files: [none.bin]}", "command", "no file");
  expect_error(odd("", ", deadline: 0.5"), "deadline", "0.5");
  expect_error(odd("", ", memory: 0"), "memory", "found '0', expected a number above 0");
  expect_error(odd("", ", parameters: [1]"), "parameters", "expected a map");
  expect_error(odd("", ", dedline: 3"), "dedline", "unknown key (did you mean deadline?)");
  expect_error(odd("exit_at_once"), "command",
               "ended with exit code 3; an answer to its setup was due; it said: no "
               "licence for this robot");
  expect_error(odd("hang_at_once", ", start: 0.2"), "command", "gave no answer to its setup within 0.2 s");
  expect_error(odd("refuse"), "command", "these parameters are not to my taste");
  expect_error(odd("other_version"), "command", "speaks version 4711 of the protocol, this moma speaks 6");
  expect_error(odd("no_json"), "command", "answer to its setup is not");
  expect_error(odd("own_file"), "command", "weights.bin");
}

TEST_F(Processes, WhateverTheyDoEndsTheTrialWithAReason) {
  const auto expect = [&](const std::string& deed, const std::string& says, const std::string& more = "") {
    expect_failure(odd(deed, more), says);
  };
  expect("fail_in_reset", "does not start: too many objects, ? of them");
  expect("exit_in_reset", "ended with exit code 5; an answer to a reset was due");
  expect("exit", "at t = 0.04 s the plugin fails: its process ended with exit code 4; an answer to a step was due");
  expect("exit_0", "ended with exit code 0");
  expect("crash", "was ended by signal 11 (Segmentation fault)");
  expect("killed", "was ended by signal 9 (Killed)");
  expect("close", "closed its standard output");
  expect("hang", "gave no answer to a step within 0.1 s and was killed", ", deadline: 5");
  expect("spin", "gave no answer to a step within 0.1 s and was killed", ", deadline: 5");
  expect("fail", "the plugin fails: lost my way");
  expect("print", "no frame of the protocol, beginning with 'step thr'");
  expect("too_much", "commands 48 bytes; 5 velocities are 40, or 136 with details");
  expect("short", "commands 32 bytes");
  expect("endless", "no frame of the protocol");
  expect("wrong_kind", "answers to a step with a frame of kind 102; 103 is due");
  expect("nan", "commands nan for omega");
  expect("status", "the plugin answers, but status must be one of: solved");
  expect("memory", "no 10 GiB to be had");
}

TEST_F(Processes, WhatTheySayAsideIsReadAndThrownAway) {
  const TrialOutput output = run(load(odd("flood"), "", {{"simulation.time_limit", "1"}}));
  EXPECT_EQ(output.row.outcome, Outcome::kTimeout) << output.row.reason;
}

TEST_F(Processes, BrakingForLongIsAnOutcomeOfItsOwn) {
  EXPECT_EQ(run(load(odd("brake"))).row.outcome, Outcome::kInfeasible);
}

TEST_F(Processes, ThreadsHaveAProcessEach) {
  const Suite suite = load(odd(""), "", {{"simulation.time_limit", "2"}});
  std::vector<TrialOutput> together(6);
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t world = 0; world < together.size(); ++world)
      threads.emplace_back([&, world] { together[world] = run(suite, world); });
  }
  for (std::uint64_t world = 0; world < together.size(); ++world) {
    const TrialOutput alone = run(suite, world);
    ASSERT_EQ(alone.trace.size(), together[world].trace.size()) << together[world].row.reason;
    EXPECT_EQ(alone.row.path_ee_m, together[world].row.path_ee_m);
  }
}

TEST_F(Processes, OptionsNameThemAsFilesDo) {
  const std::string command = "[" + (folder_.root() / "odd").string() + ", fast]";
  const Suite suite = load(odd(""), "", {{"controllers.mine.command", command}, {"simulation.time_limit", "1"}});
  EXPECT_EQ(run(suite).row.outcome, Outcome::kTimeout) << run(suite).row.reason;
  EXPECT_EQ(trial_key(suite.points[0], 0),
            trial_key(load(odd("fast"), "", {{"simulation.time_limit", "1"}}).points[0], 0));
  EXPECT_EQ(suite.resolved["controllers"]["mine"]["directory"].get<std::string>().front(), '/');
}

// What they are made of decides, wherever it lies.
TEST_F(Processes, KeysFollowFilesAndArguments) {
  const auto key = [this](const std::string& entry) { return trial_key(load(entry).points[0], 0); };
  const std::string plain = key(odd(""));
  fs::create_directory(folder_.root() / "elsewhere");
  fs::copy_file(folder_.root() / "odd", folder_.root() / "elsewhere/same");
  EXPECT_EQ(key("{method: process, command: [elsewhere/same]}"), plain);
  EXPECT_EQ(key("{method: process, command: ./same, directory: elsewhere}"), plain);
  std::set<std::string> all{plain};
  const auto expect_new = [&](const std::string& what, const std::string& entry) {
    EXPECT_TRUE(all.insert(key(entry)).second) << what;
  };
  expect_new("an argument", odd("fast"));
  expect_new("parameters", odd("", ", parameters: {gain: 2}"));
  expect_new("a guard", odd("", ", deadline: 7"));
  folder_.write("weights.bin", "1 2 3");
  expect_new("a file", odd("", ", files: [weights.bin]"));
  expect_new("a file as argument", odd("weights.bin"));
  expect_new("a file that the process names", odd("own_file"));
  folder_.write("weights.bin", "1 2 4");
  expect_new("the file's content", odd("", ", files: [weights.bin]"));
  expect_new("the file's content as argument", odd("weights.bin"));
  expect_new("the content of the file that the process names", odd("own_file"));
  std::ofstream(folder_.root() / "odd", std::ios::app | std::ios::binary) << "another build";
  expect_new("the program", odd(""));
}

TEST_F(Processes, AStoredSuiteStartsWhatItsTrialsWereComputedBy) {
  folder_.write("weights.bin", "1 2 3");
  const Suite suite = load("{method: process, command: [./odd, own_file], parameters: {gain: 1}}",
                           "sweep: {axes: {controller.parameters.gain: [1, 2, 4]}}\n");
  ASSERT_EQ(suite.points.size(), 3u);
  const auto stored = nlohmann::ordered_json::parse(suite.resolved.dump());
  const Suite again = suite_from_resolved(stored, Plugins::kOfStore);
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_EQ(trial_key(again.points[p], 2), trial_key(suite.points[p], 2));
    EXPECT_EQ(again.points[p].controller_resolved, suite.points[p].controller_resolved);
  }
  EXPECT_NE(trial_key(suite.points[0], 0), trial_key(suite.points[1], 0));
  EXPECT_THROW(suite_from_resolved(stored, Plugins::kRefused), PluginRefused);
  auto relative = stored;
  relative["controllers"]["mine"]["directory"] = "here";
  EXPECT_THROW(suite_from_resolved(relative, Plugins::kOfStore), config::ConfigError);
  folder_.write("weights.bin", "1 2 4");
  expect_other_code(stored);
}

TEST_F(Processes, AFileThatChangesUnderARunIsNoticed) {
  const Suite suite = load(odd("killed"));
  EXPECT_NE(run(suite).row.reason.find("signal 9"), std::string::npos);
  std::ofstream(folder_.root() / "odd", std::ios::app | std::ios::binary) << "another build";
  const TrialOutput next = run(suite, 1);
  EXPECT_NE(next.row.reason.find("has changed since the suite was read"), std::string::npos) << next.row.reason;
}

TEST_F(Processes, AStepTakesNoMemory) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  const Suite suite = load(odd(""));
  const auto controller = suite.points[0].plugin->make();
  controller->reset(std::vector<ObjectShape>(3));
  StepResult result;
  controller->prepare(result);
  Observation seen;
  seen.q = VectorX::Zero(3);
  seen.qdot = VectorX::Zero(5);
  seen.objects.resize(3);
  {
    const NoAlloc guard;
    for (int k = 0; k < 10; ++k) controller->step(seen, result);
    EXPECT_EQ(guard.count(), 0);
  }
  EXPECT_TRUE(controller->failure().empty()) << controller->failure();
  EXPECT_EQ(result.command[0], 0.1);
}

// They are in groups of their own, and what they started dies with them.
TEST_F(Processes, NothingIsLeftBehind) {
  folder_.write("leaves.sh", "#!/bin/sh\nsleep 600 &\necho $! > left\nexec ./odd hang\n");
  fs::permissions(folder_.root() / "leaves.sh", fs::perms::owner_all);
  EXPECT_EQ(run(load("{method: process, command: [./leaves.sh], deadline: 5}")).row.outcome, Outcome::kError);
  pid_t left = 0;
  std::ifstream(folder_.root() / "left") >> left;
  ASSERT_GT(left, 0);
  bool there = true;
  for (int i = 0; i < 500 && there; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::ifstream state("/proc/" + std::to_string(left) + "/stat");
    std::string pid, name, letter;
    there = static_cast<bool>(state >> pid >> name >> letter) && letter != "Z";
  }
  EXPECT_FALSE(there) << left;
}

}  // namespace
}  // namespace moma::test
