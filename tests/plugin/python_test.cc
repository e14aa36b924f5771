// Controllers that are Python classes: they get what is sensed, their commands arrive, and whatever they do, from an
// exception to an endless loop, ends its trial with a reason and nothing else.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>

#include "controller/step.h"
#include "tests/plugin/foreign_suite.h"

namespace moma::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHold = R"(
class Mine:
    def __init__(self, gain=0.1):
        self.gain = gain

    def reset(self, robot, objects):
        self.command = [0.0] * len(robot.velocities)
        self.command[0] = self.gain

    def step(self, seen):
        return self.command
)";

class PythonControllers : public ForeignSuite {
 protected:
  static std::string entry(const std::string& parameters = "{}", const std::string& more = "") {
    return "{method: python, path: mine.py, class: Mine, parameters: " + parameters + more + "}";
  }
  void write(const std::string& text) { folder_.write("mine.py", text); }
  /// A class whose third step is this.
  void write_step(const std::string& body) {
    write(
        "import ctypes, os, signal, sys, time\nfrom helper import dig\n\nclass Mine:\n    def reset(self, robot, "
        "objects):\n"
        "        self.steps = 0\n\n    def step(self, seen):\n        self.steps += 1\n        if self.steps == 3:\n"
        "            " +
        body + "\n        return [0.1, 0, 0, 0, 0]\n");
    folder_.write(
        "helper.py",
        "def dig(depth):\n    if depth == 0:\n        raise RuntimeError('found water')\n    dig(depth - 1)\n");
  }
};

TEST_F(PythonControllers, DriveTheRobot) {
  write(kHold);
  const TrialOutput output = run(load(entry("{gain: 0.25}")));
  ASSERT_GT(output.trace.size(), 10u) << output.row.reason;
  EXPECT_EQ(output.trace[5].command, (VectorX(5) << 0.25, 0, 0, 0, 0).finished());
  EXPECT_EQ(output.row.outcome, Outcome::kTimeout) << output.row.reason;
}

// Every number that is sensed comes back in a command, as the sum that C++ makes of it: with NumPy where there is any,
// and in plain Python.
TEST_F(PythonControllers, SeeWhatIsSensed) {
  write(R"(
import sys

class Mine:
    def __init__(self, plain):
        if plain:
            runner = sys.modules["__main__"]
            runner.numpy = None

    def reset(self, robot, objects):
        assert robot.name == "tiny" and robot.base == "differential", (robot.name, robot.base)
        assert robot.joints == ("turn", "bend", "reach"), robot.joints
        assert robot.velocities == ("v", "omega", "turn", "bend", "reach"), robot.velocities
        assert list(robot.lower) == [-2, -1, -0.2] and list(robot.upper) == [2, 1, 0.4], robot.lower
        assert list(robot.velocity_limits) == [1, 2, 1.5, 1.5, 0.5], robot.velocity_limits
        assert robot.control_period == 0.05 and "<robot" in robot.description["urdf_text"]
        assert [o.name for o in objects] == ["ball", "crate"], [o.name for o in objects]
        assert [o.shape for o in objects] == ["sphere", "box"] == [o.kind for o in objects] and list(objects[1].size) == [0.5, 0.25, 0.125]
        self.first = None

    def step(self, seen):
        flat = lambda matrix: [float(v) for row in matrix for v in row]
        ball, crate = seen.objects
        assert ball.visible and not crate.visible
        assert crate.position_covariance is None and crate.velocity_covariance is None
        if self.first is None:
            self.first = seen
        assert self.first.time == 0.125
        parts = [[seen.time], seen.base, seen.q, seen.qdot, seen.goal.position, flat(seen.goal.rotation), seen.goal.twist,
                 ball.position, flat(ball.rotation), ball.twist, flat(ball.position_covariance),
                 flat(ball.velocity_covariance)]
        total = 0.0
        for i, part in enumerate(parts):
            for j, value in enumerate(part):
                total += float(value) * (1 + i + 16 * j)
        return {"command": [total / 65536, 0, 0, 0, 0], "status": "max_iterations", "fallback": "relaxed",
                "slack": [1, 2, 3, 4, 5, 6], "least_distance": 0.5, "rows": 7, "active_rows": 3, "iterations": 11}
)");
  for (const char* plain : {"false", "true"}) {
    const Suite suite = load(entry(std::string("{plain: ") + plain + "}"), "", {{"simulation.control_period", "0.05"}});
    const auto controller = suite.points[0].plugin->make();
    const std::vector<ObjectShape> shapes{{"ball", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}},
                                          {"crate", {ShapeKind::kBox, {0.5, 0.25, 0.125}, nullptr}}};
    controller->reset(shapes);
    StepResult result;
    controller->prepare(result);
    Observation seen;
    seen.objects.resize(2);
    double next = 0.0;
    const auto fill = [&next](auto&& values) {
      for (double& value : values) value = (next += 0.125);
    };
    const auto fill_matrix = [&next](Eigen::Ref<Matrix3> matrix) {
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) matrix(r, c) = (next += 0.125);
    };
    seen.q.resize(3);
    seen.qdot.resize(5);
    seen.time = (next += 0.125);
    fill(seen.base);
    fill(seen.q);
    fill(seen.qdot);
    ObjectState& ball = seen.objects[0];
    ball.visible = true;
    seen.objects[1].visible = false;
    ball.covariance.emplace();
    Vector3 p;
    fill(p);
    seen.goal.X_WG.translation() = p;
    Matrix3 R;
    fill_matrix(R);
    seen.goal.X_WG.linear() = R;
    fill(seen.goal.V_WG_W);
    fill(p);
    ball.X_WO.translation() = p;
    fill_matrix(R);
    ball.X_WO.linear() = R;
    fill(ball.V_WO_W);
    fill_matrix(ball.covariance->position_W);
    fill_matrix(ball.covariance->velocity_W);
    // The same sum: values count up by 1/8 in the order in which they are filled.
    const int sizes[] = {1, 3, 3, 5, 3, 9, 6, 3, 9, 6, 9, 9};
    double expected = 0.0, value = 0.0;
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < sizes[i]; ++j) expected += (value += 0.125) * (1 + i + 16 * j);
    expected /= 65536;
    ASSERT_LT(expected, 1.0);
    controller->step(seen, result);
    ASSERT_TRUE(controller->failure().empty()) << controller->failure();
    const double limit = suite.points[0].robot->model->velocity_limits()[0];
    EXPECT_NEAR(result.command[0], std::min(expected, limit), 1e-12) << plain;
    EXPECT_EQ(result.status, StepStatus::kMaxIterations);
    EXPECT_EQ(result.fallback, Fallback::kRelaxed);
    EXPECT_EQ(result.slack, (Vector6() << 1, 2, 3, 4, 5, 6).finished());
    EXPECT_EQ(result.least_distance, 0.5);
    EXPECT_EQ(result.rows, 7);
    EXPECT_EQ(result.active_rows, 3);
    EXPECT_EQ(result.iterations, 11);
    seen.time = 9.0;
    controller->step(seen, result);
    EXPECT_TRUE(controller->failure().empty()) << controller->failure();
  }
}

TEST_F(PythonControllers, MistakesAreNamedWithTheirPlace) {
  write(kHold);
  expect_error("{method: python, class: Mine}", "path", "the Python file with the controller");
  expect_error("{method: python, path: mine.py}", "class", "the name of the file's class");
  expect_error("{method: python, path: none.py, class: Mine}", "path", "no file");
  expect_error("{method: python, path: mine.py, class: Yours}", "path", "mine.py has no class Yours; it has Mine");
  expect_error(entry("{gian: 2}"), "path", "unexpected keyword argument 'gian'");
  expect_error(entry("{}", ", python: ./no-python"), "path", "No such file or directory");
  write("class Mine:\n    def reset(self, robot, objects): pass\n");
  expect_error(entry(), "path", "class Mine has no step()");
  write("class Mine:\n  def step(self:\n");
  expect_error(entry(), "path", "SyntaxError: ");
  expect_error(entry(), "path", "(mine.py:2)");
  write("import no_such_module\n");
  expect_error(entry(), "path", "ModuleNotFoundError: No module named 'no_such_module' | mine.py:1 in <module>");
  write("import sys\nsys.exit(3)\n");
  expect_error(entry(), "path", "SystemExit: 3 | mine.py:2 in <module>: sys.exit(3)");
  write("while True: pass\n");
  expect_error(entry("{}", ", start: 1"), "path", "gave no answer to its setup within 1 s and was killed");
}

TEST_F(PythonControllers, WhateverTheyDoEndsTheTrialWithAReason) {
  const auto expect = [&](const std::string& body, const std::string& says, const std::string& more = "") {
    write_step(body);
    expect_failure(entry("{}", more), says);
  };
  expect("dig(2)",
         "at t = 0.04 s the plugin fails: RuntimeError: found water | mine.py:11 in step: dig(2) | helper.py:4 in dig: "
         "dig(depth - 1) | helper.py:4 in dig: dig(depth - 1) | helper.py:3 in dig: raise RuntimeError('found water')");
  expect("sys.exit('enough')", "SystemExit: enough | mine.py:11 in step: sys.exit('enough')");
  expect("os._exit(7)", "its process ended with exit code 7");
  expect("ctypes.string_at(0)", "was ended by signal 11 (Segmentation fault)");
  expect("os.kill(os.getpid(), signal.SIGKILL)", "was ended by signal 9 (Killed)");
  expect("time.sleep(600)", "gave no answer to a step within 0.2 s and was killed", ", deadline: 10");
  expect("print('so far so good')\n            while True: pass",
         "gave no answer to a step within 2 s and was killed; it said: so far so good", ", deadline: 100");
  expect("self.much = b'x' * 10_000_000_000", "MemoryError | mine.py:11 in step: self.much = b'x' * 10_000_000_000");
  expect("return [0.1, 0]", "step() returned 2 numbers, the robot wants 5: v, omega, turn, bend, reach");
  expect("return None", "step() returned nothing");
  expect("return [0.1, float('nan'), 0, 0, 0]", "commands nan for omega");
  expect("return [0.1, 0, 'fast', 0, 0]", "could not convert string to float: 'fast'");
  expect("return {'command': [0] * 5, 'state': 'solved'}", "step() returned the key 'state', none of command, status");
  expect("return {'command': [0] * 5, 'status': 'fine'}", "status is 'fine', none of solved, infeasible");
}

// Prints go to nobody, and input is empty: neither is the line to moma.
TEST_F(PythonControllers, MayPrintAndRead) {
  write_step("print('x' * 100000); sys.stdout.write('y'); os.write(1, b'z' * 1000); assert sys.stdin.read() == ''");
  const TrialOutput output = run(load(entry(), "", {{"simulation.time_limit", "1"}}));
  EXPECT_EQ(output.row.outcome, Outcome::kTimeout) << output.row.reason;
}

TEST_F(PythonControllers, EveryTrialBeginsAlike) {
  write(R"(
import random

class Mine:
    def reset(self, robot, objects):
        self.set = sorted(hash(name) for name in robot.velocities)

    def step(self, seen):
        return [0.1 * random.random(), 1e-19 * self.set[0], 0, 0, 0]
)");
  const Suite suite = load(entry(), "", {{"simulation.time_limit", "1"}});
  const TrialOutput first = run(suite, 0), other = run(suite, 1), again = run(suite, 0);
  const TrialOutput anew = run(load(entry(), "", {{"simulation.time_limit", "1"}}), 0);
  ASSERT_GT(first.trace.size(), 10u) << first.row.reason;
  EXPECT_NE(first.trace[3].command, first.trace[4].command);
  for (std::size_t k = 0; k < first.trace.size(); ++k) {
    ASSERT_EQ(first.trace[k].command, again.trace.at(k).command) << k;
    ASSERT_EQ(first.trace[k].command, anew.trace.at(k).command) << k;
  }
}

TEST_F(PythonControllers, KeysFollowAllFilesOfTheController) {
  write("import helper\n" + std::string(kHold));
  folder_.write("helper.py", "x = 1\n");
  const auto key = [this](const std::string& text) { return trial_key(load(text).points[0], 0); };
  const std::string plain = key(entry());
  EXPECT_EQ(key(entry()), plain);
  std::set<std::string> all{plain};
  const auto expect_new = [&](const std::string& what, const std::string& text) {
    EXPECT_TRUE(all.insert(key(text)).second) << what;
  };
  expect_new("parameters", entry("{gain: 0.3}"));
  folder_.write("helper.py", "x = 2\n");
  expect_new("an imported file", entry());
  folder_.write("gains.txt", "1 2 3\n");
  expect_new("a file that is named", entry("{}", ", files: [gains.txt]"));
  write("import helper\n\n" + std::string(kHold));
  expect_new("the file itself", entry());
  fs::create_directory(folder_.root() / "elsewhere");
  for (const char* name : {"mine.py", "helper.py"})
    fs::copy_file(folder_.root() / name, folder_.root() / "elsewhere" / name);
  EXPECT_EQ(key("{method: python, path: elsewhere/mine.py, class: Mine}"), key(entry())) << "only its place is another";

  const Suite suite = load(entry("{gain: 0.3}", ", files: [gains.txt]"));
  const auto stored = nlohmann::ordered_json::parse(suite.resolved.dump());
  const Suite again = suite_from_resolved(stored, Plugins::kOfStore);
  EXPECT_EQ(trial_key(again.points[0], 3), trial_key(suite.points[0], 3));
  EXPECT_THROW(suite_from_resolved(stored, Plugins::kRefused), PluginRefused);
  folder_.write("helper.py", "open('started', 'w')\n");
  EXPECT_THROW(suite_from_resolved(stored, Plugins::kOfStore), config::ConfigError);
  EXPECT_FALSE(fs::exists(folder_.root() / "started")) << "it is compared before anything runs";
}

}  // namespace
}  // namespace moma::test
