// Controllers from shared libraries: what they compute is what they would compute without the border between; what is
// wrong with them is said at the place in the suite that named them, or ends the trial, never the batch.

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "controller/controller.h"
#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"
#include "eval/trial/trial.h"
#include "plugin/host/library.h"
#include "tests/plugin/foreign_suite.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

namespace fs = std::filesystem;

const fs::path kPlugins = fs::path(MOMA_BINARY_DIR) / "tests/plugins";

std::string entry(const std::string& library, const std::string& parameters = "{}") {
  return "{method: plugin, path: " + library + ", parameters: " + parameters + "}";
}

class PluginSuite : public test::ForeignSuite {
 protected:
  void SetUp() override {
    for (const char* name : {"odd.so", "wrong_abi.so", "no_step.so", "hold.so", "class.so"})
      fs::copy_file(kPlugins / name, folder_.root() / name);
  }
};

TEST_F(PluginSuite, ComputesWhatTheSameControllerComputesWithoutABorder) {
  const Suite suite = load_suite(folder_.suite("", "{own: {}, mine: " + entry("class.so") + "}"));
  for (std::uint64_t world = 0; world < 5; ++world) {
    const TrialOutput own = run(suite, world, 0), mine = run(suite, world, 1);
    EXPECT_EQ(own.row.outcome, mine.row.outcome) << mine.row.reason;
    ASSERT_EQ(own.trace.size(), mine.trace.size());
    ASSERT_GT(own.trace.size(), 5u);
    for (std::size_t k = 0; k < own.trace.size(); ++k) {
      ASSERT_EQ(own.trace[k].command, mine.trace[k].command) << "world " << world << " step " << k;
      ASSERT_EQ(own.trace[k].slack, mine.trace[k].slack);
      ASSERT_EQ(own.trace[k].status, mine.trace[k].status);
      ASSERT_EQ(own.trace[k].fallback, mine.trace[k].fallback);
      ASSERT_EQ(own.trace[k].least_distance, mine.trace[k].least_distance);
    }
  }
}

TEST_F(PluginSuite, SeesWhatIsSensedAsTheSameControllerDoesWithoutABorder) {
  const std::string on =
      "disturbances: {joints: {noise: 0.002, delay: 0.02}, base: {odometry: {distance: 0.05}}, "
      "objects: {range: 1, delay: 0.06, noise: {position: 0.01}}, goal: {noise: {position: 0.01}}, "
      "actuators: {base: {delay: 0.04}}}\n";
  const Suite suite = load_suite(folder_.suite(on, "{own: {}, mine: " + entry("class.so") + "}"),
                                 {{"worlds.families", "{clutter: {weight: 1}}"}});
  for (std::uint64_t world = 0; world < 3; ++world) {
    const TrialOutput own = run(suite, world, 0), mine = run(suite, world, 1);
    EXPECT_EQ(own.row.outcome, mine.row.outcome) << mine.row.reason;
    ASSERT_EQ(own.trace.size(), mine.trace.size());
    for (std::size_t k = 0; k < own.trace.size(); ++k)
      ASSERT_EQ(own.trace[k].command, mine.trace[k].command) << "world " << world << " step " << k;
  }
}

TEST_F(PluginSuite, ObjectsOfEveryKindCrossTheBorder) {
  // Clutter has spheres, boxes and capsules; the echo keeps its distance from them only if it gets them right.
  const Suite suite = load_suite(folder_.suite("", "{own: {}, mine: " + entry("class.so") + "}"),
                                 {{"worlds.families", "{clutter: {weight: 1}}"}});
  int objects = 0;
  for (std::uint64_t world = 0; world < 3; ++world) {
    const World w = suite.points[0].worlds.make(suite.points[0].robot->model, world);
    objects += static_cast<int>(w.objects.size());
    const TrialOutput own = run_trial(suite.points[0], w), mine = run_trial(suite.points[1], w);
    EXPECT_EQ(own.row.outcome, mine.row.outcome);
    EXPECT_EQ(own.row.clearance_min_m, mine.row.clearance_min_m);
    EXPECT_EQ(own.row.path_ee_m, mine.row.path_ee_m);
  }
  EXPECT_GT(objects, 10);
}

// A tracker's covariances reach the plugin, each in its place, and are gone where there are none.
TEST_F(PluginSuite, CovariancesCrossTheBorder) {
  const Suite suite = load(entry("class.so", "{is: tracked}"));
  const auto model = suite.points[0].robot->model;
  const auto mine = suite.points[0].plugin->make();
  ControllerParams params;
  params.prediction.enabled = params.uncertainty.enabled = true;
  Controller own(model, params, suite.points[0].simulation.control_period);
  const std::vector<ObjectShape> ball{{.name = "ball", .shape = {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}};
  StepResult a, b;
  mine->reset(ball);
  own.reset(ball);
  mine->prepare(a);
  own.prepare(b);
  Observation seen;
  seen.q = model->ready;
  seen.qdot = VectorX::Zero(5);
  seen.goal.X_WG.translation() = Vector3(2.0, 0.3, 0.7);
  seen.objects.resize(1);
  seen.objects[0].X_WO.translation() = Vector3(0.8, 0.1, 0.6);
  seen.objects[0].V_WO_W[3] = -0.1;
  VectorX last;
  int changes = 0;
  for (int k = 0; k < 12; ++k) {
    seen.objects[0].covariance.reset();
    if (k % 3 > 0) {
      Matrix3 P = Matrix3::Zero();
      P.diagonal() << 1e-4, 4e-4 * k, 9e-4;
      P(0, 1) = P(1, 0) = 1e-4;
      seen.objects[0].covariance = ObjectCovariance{P, Matrix3(k % 3 * P)};
    }
    mine->step(seen, a);
    own.step(seen, b);
    ASSERT_EQ(a.command, b.command) << k;
    if (k > 0 && a.command != last) ++changes;
    last = a.command;
  }
  EXPECT_GT(changes, 6) << "it makes a difference";
}

TEST_F(PluginSuite, APluginInC) {
  const TrialOutput output = run(load(entry("hold.so")));
  ASSERT_GT(output.trace.size(), 10u);
  EXPECT_EQ(output.trace[5].command, (VectorX(5) << 0, 0, 0, 0, 0.05).finished());
  EXPECT_EQ(output.row.outcome, Outcome::kTimeout) << output.row.reason;
}

TEST_F(PluginSuite, ThreadsGiveTheSameAsOneAfterTheOther) {
  const Suite suite = load(entry("class.so"));
  std::vector<TrialOutput> together(6);
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t world = 0; world < together.size(); ++world)
      threads.emplace_back([&, world] { together[world] = run(suite, world); });
  }
  for (std::uint64_t world = 0; world < together.size(); ++world) {
    const TrialOutput alone = run(suite, world);
    ASSERT_EQ(alone.trace.size(), together[world].trace.size());
    EXPECT_EQ(alone.trace.back().command, together[world].trace.back().command);
  }
}

TEST_F(PluginSuite, MistakesAreNamedWithTheirPlace) {
  expect_error("{method: plugin}", "path", "the shared library");
  expect_error(entry("none.so"), "path", "no file");
  expect_error(entry("robots"), "path", "is not a file");
  expect_error(entry("robots/tiny.urdf"), "path", "cannot be loaded as a shared library");
  folder_.write("empty.so", "");
  expect_error(entry("empty.so"), "path", "cannot be loaded as a shared library");
  for (const std::uintmax_t size : {9000, 3000, 100, 30}) {
    fs::resize_file(folder_.root() / "hold.so", size);
    expect_error(entry("hold.so"), "path", size < 64 ? "cannot be loaded as a shared library" : "cut off");
  }
  expect_error(entry("wrong_abi.so"), "path", "is made for version 4711 of the plugin interface");
  expect_error(entry("no_step.so"), "path", "has no function moma_plugin_step");
  expect_error(entry("odd.so", "{do: refuse}"), "parameters", "joint turn is not to my taste");
  expect_error(entry("odd.so", "{do: refuse_silently}"), "parameters", "refuses this robot and these parameters");
  expect_error(entry("odd.so", "{do: throw_in_open}"), "parameters", "throws: no parameters today");
  expect_error(entry("class.so", "{iz: echo}"), "parameters", "parameters.iz: unknown key (did you mean is?)");
  expect_error(entry("odd.so", "[1, 2]"), "parameters", "expected a map");
  expect_error("{method: plugin, path: odd.so, servo: {position: 1}}", "servo", "unknown key");
}

TEST_F(PluginSuite, PathsAreRelativeToTheFileThatNamesThem) {
  fs::copy_file(kPlugins / "odd.so", folder_.root() / "controllers/near.so");
  folder_.write("controllers/plugged.yaml", "method: plugin\npath: near.so\nparameters: {gain: 2}\n");
  const Suite suite = load("controllers/plugged.yaml");
  ASSERT_NE(suite.points[0].plugin, nullptr);
  EXPECT_EQ(suite.points[0].controller_resolved["parameters"]["gain"], 2);
  EXPECT_EQ(load("{include: controllers/plugged.yaml, parameters: {gain: 3}}")
                .points[0]
                .controller_resolved["parameters"]["gain"],
            3);
  EXPECT_EQ(load("controllers/plugged.yaml", "",
                 {{"controllers.mine.path", (kPlugins / "class.so").string()}, {"controllers.mine.parameters", "{}"}})
                .points[0]
                .plugin->library()
                .file.filename(),
            "class.so");
  // A sweep over a parameter of the plugin's.
  const Suite swept = load("controllers/plugged.yaml", "sweep: {axes: {controller.parameters.gain: [1, 2, 4]}}\n");
  ASSERT_EQ(swept.points.size(), 3u);
  EXPECT_EQ(swept.points[2].controller_resolved["parameters"]["gain"], 4);
  EXPECT_NE(trial_key(swept.points[0], 0), trial_key(swept.points[1], 0));
  const Suite again = suite_from_resolved(nlohmann::ordered_json::parse(swept.resolved.dump()), Plugins::kOfStore);
  for (std::size_t p = 0; p < 3; ++p) EXPECT_EQ(trial_key(again.points[p], 2), trial_key(swept.points[p], 2));
}

TEST_F(PluginSuite, KeysFollowTheLibrarysContentNotItsPlace) {
  const std::string key = trial_key(load(entry("odd.so")).points[0], 0);
  fs::copy_file(folder_.root() / "odd.so", folder_.root() / "same.so");
  EXPECT_EQ(trial_key(load(entry("same.so")).points[0], 0), key);
  EXPECT_NE(trial_key(load(entry("odd.so", "{gain: 1}")).points[0], 0), key);
  // Built again, it is another controller. Bytes after its last section do not keep a library from working.
  fs::copy_file(folder_.root() / "odd.so", folder_.root() / "built_again.so");
  std::ofstream(folder_.root() / "built_again.so", std::ios::app | std::ios::binary) << "another build";
  const Suite changed = load(entry("built_again.so"));
  EXPECT_NE(trial_key(changed.points[0], 0), key);

  // A stored suite asks for the library that it was run with.
  const auto stored = nlohmann::ordered_json::parse(changed.resolved.dump());
  EXPECT_EQ(trial_key(suite_from_resolved(stored, Plugins::kOfStore).points[0], 0), trial_key(changed.points[0], 0));
  std::ofstream(folder_.root() / "built_again.so", std::ios::app | std::ios::binary) << "and another";
  expect_other_code(stored);
}

TEST_F(PluginSuite, ALibraryRebuiltUnderARunningProcessIsRefused) {
  const fs::path file = folder_.write("mine.so", "");
  fs::copy_file(kPlugins / "odd.so", file, fs::copy_options::overwrite_existing);
  EXPECT_NO_THROW(load_plugin(file));
  EXPECT_NO_THROW(load_plugin(file));
  fs::remove(file);
  fs::copy_file(kPlugins / "hold.so", file);
  try {
    load_plugin(file);
    ADD_FAILURE() << "the code in memory is not that of the file";
  } catch (const PluginError& e) {
    EXPECT_NE(std::string(e.what()).find("has changed since this process loaded it"), std::string::npos) << e.what();
  }
}

TEST_F(PluginSuite, FailuresEndTheTrialWithTheirReason) {
  const auto expect = [&](const std::string& library, const std::string& deed, const std::string& says) {
    const TrialOutput output = run(load(entry(library, deed)));
    EXPECT_EQ(output.row.outcome, Outcome::kError) << deed;
    EXPECT_NE(output.row.reason.find(says), std::string::npos) << deed << ": " << output.row.reason;
  };
  expect("odd.so", "{do: throw_in_start}", "throws when it starts: an exception of unknown type");
  expect("odd.so", "{do: fail_in_start}", "does not start: 0 objects are too many");
  expect("odd.so", "{do: throw_in_step}", "at t = 0.04 s the plugin throws: lost my way");
  expect("odd.so", "{do: throw_a_number}", "an exception of unknown type");
  expect("odd.so", "{do: throw_out_of_memory}", "bad_alloc");
  expect("odd.so", "{do: fail_in_step}", "at t = 0.04 s the plugin fails: xxxxx");
  expect("odd.so", "{do: nan}", "commands nan for omega");
  expect("odd.so", "{do: infinite}", "commands inf for v");
  expect("odd.so", "{do: forget}", "commands nan for reach");
  expect("odd.so", "{do: status}", "the plugin answers, but status must be one of: solved");
  expect("odd.so", "{do: fallback}", "the plugin answers, but fallback must be one of: none");
  expect("odd.so", "{do: slack}", "the plugin answers, but slack must be a finite number, is inf");
  expect("class.so", "{is: late}", "not among 0 objects");
  expect("class.so", "{is: throwing}", "the plugin fails: time is up");
  expect("class.so", "{is: short}", "the command has 4 values, the robot has 5 velocities");
  expect("class.so", "{is: long}", "the command has 100 values, the robot has 5 velocities");
}

TEST_F(PluginSuite, BrakingForLongIsAnOutcomeOfItsOwn) {
  EXPECT_EQ(run(load(entry("odd.so", "{do: brake}"))).row.outcome, Outcome::kInfeasible);
}

TEST_F(PluginSuite, SpeedsBeyondTheRobotsAreScaledAsAWhole) {
  const Suite suite = load(entry("odd.so", "{do: race}"));
  const TrialOutput output = run(suite);
  const RobotModel& model = *suite.points[0].robot->model;
  const VectorX limit = model.velocity_limits();
  ASSERT_GT(output.trace.size(), 3u);
  const VectorX command = output.trace[3].command;
  EXPECT_TRUE((command.array().abs() <= limit.array()).all()) << command.transpose();
  EXPECT_NEAR(command[1] / command[0], -0.3, 1e-12);
  EXPECT_NEAR((command.array() / limit.array()).abs().maxCoeff(), 1.0, 1e-12);
}

TEST_F(PluginSuite, TheBorderTakesNoMemory) {
  if (!test::NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  const Suite suite = load(entry("hold.so"));
  const auto controller = suite.points[0].plugin->make();
  controller->reset(std::vector<ObjectShape>(3));
  StepResult result;
  controller->prepare(result);
  Observation seen;
  seen.q = VectorX::Zero(3);
  seen.qdot = VectorX::Zero(5);
  seen.objects.resize(3);
  {
    const test::NoAlloc guard;
    for (int k = 0; k < 10; ++k) controller->step(seen, result);
    EXPECT_EQ(guard.count(), 0);
  }
  EXPECT_TRUE(controller->failure().empty());
  seen.objects.pop_back();
  controller->step(seen, result);
  EXPECT_FALSE(controller->failure().empty()) << "other objects than it was started among";
  EXPECT_EQ(result.command, VectorX::Zero(5));
}

}  // namespace
}  // namespace moma
