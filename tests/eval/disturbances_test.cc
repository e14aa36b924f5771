// Disturbances in whole trials: off they are not there; on, the controller alone is deceived; the same bits for any
// number of threads, from the resolved suite and in any order of a sweep's points.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "eval/batch/batch.h"
#include "eval/trial/trial_detail.h"
#include "tests/eval/suite_fixture.h"
#include "tests/eval/trial_fixture.h"
#include "world/sensing/disturbances_file.h"
#include "world/world_json.h"

namespace moma::test {
namespace {

constexpr const char* kEverything = R"({
  joints: {noise: 0.001, velocity_noise: 0.01, bias: 0.001, delay: 0.02},
  base: {noise: {position: 0.002, rotation: 0.001}, velocity_noise: {linear: 0.01, angular: 0.01},
         bias: {position: 0.002, rotation: 0.002}, delay: 0.02,
         odometry: {distance: 0.01, turn: 0.01, heading: 0.005, walk: {position: 0.003, rotation: 0.003}}},
  objects: {frame: base, noise: {position: 0.005, rotation: 0.005}, velocity_noise: {linear: 0.05, angular: 0.05},
            bias: {position: 0.005, rotation: 0.005}, delay: 0.08, range: 3, detection: 0.1},
  goal: {frame: base, noise: {position: 0.002, rotation: 0.005}, velocity_noise: {linear: 0.01, angular: 0.01},
         bias: {position: 0.003, rotation: 0.01}, delay: 0.08},
  actuators: {joints: {delay: 0.02, lag: 0.03, gain_error: 0.01, friction: {effort: 0.05, spread: 0.02}},
              base: {delay: 0.04, gain_error: {linear: 0.02, angular: 0.02}}},
  payload: {mass: 0.5, spread: 0.2}, floor: {friction: 0.7, spread: 0.1}, control: {missed: 0.05}
})";

std::vector<TrialOutput> run(const Suite& suite, int threads) {
  std::vector<TrialOutput> out;
  BatchOptions options;
  options.threads = threads;
  run_batch(suite.points, make_jobs(suite.points, 0, suite.trials), options,
            [&](const BatchJob&, BatchResult&& result) {
              out.push_back(std::move(result.output));
              return true;
            });
  return out;
}

void expect_same_bits(const TrialOutput& a, const TrialOutput& b, const std::string& where) {
  EXPECT_EQ(a.row.outcome, b.row.outcome) << where << ": " << a.row.reason << " / " << b.row.reason;
  EXPECT_EQ(a.row.reason, b.row.reason) << where;
  ASSERT_EQ(a.trace.size(), b.trace.size()) << where;
  for (std::size_t k = 0; k < a.trace.size(); ++k) {
    ASSERT_EQ(a.trace[k].base, b.trace[k].base) << where << " step " << k;
    ASSERT_EQ(a.trace[k].q, b.trace[k].q) << where << " step " << k;
    ASSERT_EQ(a.trace[k].command, b.trace[k].command) << where << " step " << k;
    ASSERT_EQ(a.trace[k].error, b.trace[k].error) << where << " step " << k;
    ASSERT_EQ(a.trace[k].least_distance, b.trace[k].least_distance) << where << " step " << k;
  }
}

bool same_commands(const TrialOutput& a, const TrialOutput& b) {
  if (a.trace.size() != b.trace.size()) return false;
  for (std::size_t k = 0; k < a.trace.size(); ++k)
    if (a.trace[k].command != b.trace[k].command) return false;
  return true;
}

Suite clutter(const SuiteFolder& folder, const std::string& more, const std::string& mode = "kinematic",
              const std::string& controllers = "{qp: {limits: {acceleration: 5}}, rrmc: {method: rrmc}}") {
  return load_suite(folder.write("clutter.yaml", "robot: robots/tiny.yaml\ncontrollers: " + controllers +
                                                     "\nworlds: {seed: 11, families: {clutter: {weight: 2, objects: 3},"
                                                     " moving: {weight: 1, objects: 2}, tracking: {weight: 1}}}\n"
                                                     "simulation: {mode: " +
                                                     mode + ", time_limit: 5}\ntrials: 8\n" + more));
}

TEST(Disturbances, OffTheyAreNotThere) {
  SuiteFolder folder;
  const Suite plain = clutter(folder, "");
  EXPECT_FALSE(plain.resolved.contains("disturbances"));
  const std::vector<TrialOutput> before = run(plain, 2);
  for (const char* off : {"none", "{}", "{seed: 5}", "{joints: {noise: 0}, objects: {frame: base}}"}) {
    const Suite suite = clutter(folder, "disturbances: " + std::string(off) + "\n");
    EXPECT_EQ(suite.resolved, plain.resolved) << off;
    for (std::size_t p = 0; p < suite.points.size(); ++p)
      EXPECT_EQ(trial_key(suite.points[p], 3), trial_key(plain.points[p], 3)) << off;
    const std::vector<TrialOutput> after = run(suite, 2);
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < after.size(); ++i) expect_same_bits(before[i], after[i], off);
  }
}

TEST(Disturbances, EachIsPartOfTheKeyAndChangesTheTrial) {
  SuiteFolder folder;
  const Suite plain = clutter(folder, "");
  std::set<std::string> keys = {trial_key(plain.points[0], 0)};
  const TrialOutput before = run_trial(plain.points[0], plain.points[0].worlds.make(plain.points[0].robot->model, 0));
  for (const char* on :
       {"{joints: {noise: 0.01}}", "{joints: {velocity_noise: 0.1}}", "{joints: {bias: 0.01}}",
        "{joints: {delay: 0.1}}", "{base: {noise: {position: 0.01}}}", "{base: {odometry: {distance: 0.1}}}",
        "{base: {delay: 0.1}}", "{goal: {noise: {position: 0.01}}}", "{goal: {bias: {rotation: 0.1}}}",
        "{objects: {range: 0.1}}", "{objects: {bias: {position: 0.05}}}", "{actuators: {joints: {delay: 0.1}}}",
        "{actuators: {base: {gain_error: {linear: 0.1}}}}", "{actuators: {joints: {lag: 0.1}}}",
        "{actuators: {base: {lag: 0.1}}}", "{control: {missed: 0.4}}", "{seed: 1, joints: {noise: 0.01}}"}) {
    const Suite suite = clutter(folder, "disturbances: " + std::string(on) + "\n");
    EXPECT_TRUE(keys.insert(trial_key(suite.points[0], 0)).second) << on;
    const TrialOutput after = run_trial(suite.points[0], suite.points[0].worlds.make(suite.points[0].robot->model, 0));
    EXPECT_FALSE(same_commands(before, after)) << on;
    EXPECT_EQ(after.row.outcome == Outcome::kError, false) << after.row.reason;
  }
}

TEST(Disturbances, OneAndFourThreadsGiveTheSameBitsWithEverythingOn) {
  SuiteFolder folder;
  for (const char* mode : {"kinematic", "dynamic"}) {
    const Suite suite = clutter(folder, std::string("disturbances: ") + kEverything + "\n", mode);
    const std::vector<TrialOutput> one = run(suite, 1), four = run(suite, 4);
    const Suite again = suite_from_resolved(nlohmann::ordered_json::parse(suite.resolved.dump()));
    const std::vector<TrialOutput> resolved = run(again, 3);
    ASSERT_EQ(one.size(), 16u);
    ASSERT_EQ(one.size(), four.size());
    ASSERT_EQ(one.size(), resolved.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_NE(one[i].row.outcome, Outcome::kError) << one[i].row.reason;
      expect_same_bits(one[i], four[i], std::string(mode) + " trial " + std::to_string(i));
      expect_same_bits(one[i], resolved[i], std::string(mode) + " resolved, trial " + std::to_string(i));
    }
    // From the world alone, as a replay has it.
    const SuitePoint& point = suite.points[0];
    const World world = point.worlds.make(point.robot->model, 2);
    const World read = world_from_json(nlohmann::ordered_json::parse(to_json(world).dump()), "stored");
    expect_same_bits(run_trial(point, world), run_trial(again.points[0], read), mode);
  }
}

TEST(Disturbances, TheControllerSeesWhatIsSensedAndEverythingElseTheTruth) {
  TrialSpec point = tiny_spec();
  point.disturbances.base.bias.position = 0.3;
  point.disturbances.joints.noise = 0.01;
  point.disturbances.goal.bias.position = 0.5;
  World world = tiny_world(0.4);
  world.seed = 3;
  std::vector<Observation> seen;
  const TrialOutput out = run_scripted(point, world, [&](const Observation& o, StepResult& result) {
    seen.push_back(o);
    if (o.time < 0.8 - 1e-9) result.command[0] = 0.5;
  });
  // To the true goal, whatever is seen of it.
  EXPECT_EQ(out.row.outcome, Outcome::kSuccess) << out.row.reason;
  EXPECT_DOUBLE_EQ(out.row.time_to_goal_s, 0.76);
  EXPECT_NEAR(out.row.path_base_m, 0.4, 1e-12);
  EXPECT_NEAR(out.row.position_error_m, 0.0, 1e-12);
  ASSERT_EQ(seen.size(), out.trace.size());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    EXPECT_EQ(out.trace[k].q, VectorX::Zero(3)) << "joints do not move";
    EXPECT_NE(seen[k].q, out.trace[k].q);
    EXPECT_GT((seen[k].base - out.trace[k].base).norm(), 0.01);
    EXPECT_GT((seen[k].goal.X_WG.translation() - world.goal.X_WG.translation()).norm(), 0.05);
    EXPECT_NEAR(out.trace[k].error.tail<3>().norm(), std::max(0.0, 0.4 - 0.01 * static_cast<double>(k)), 1e-9);
  }
}

TEST(Disturbances, HiddenObjectsAreHitAndMeasuredAllTheSame) {
  TrialSpec point = tiny_spec();
  World world = tiny_world(3.0);
  world.objects = {sphere("ball", Vector3(1.5, 0, 0.1), 0.2)};
  point.disturbances.detection.range = 0.5;
  point.disturbances.detection.sensor = {0, 0, 0.1};
  std::vector<bool> visible;
  const auto script = [&](const Observation& o, StepResult& result) {
    visible.push_back(o.objects[0].visible);
    EXPECT_EQ(o.objects[0].X_WO.translation().x(), o.objects[0].visible ? 1.5 : 0.0) << "what is hidden is not told";
    result.command[0] = 0.5;
  };
  // On the exact plant, which has contacts.
  TrialParts parts;
  parts.controller = [&](const TrialSpec& p) {
    return std::make_unique<ScriptedController>(p.robot->model->num_velocities(), script);
  };
  const TrialOutput out = run_trial(point, world, parts);
  EXPECT_EQ(out.row.outcome, Outcome::kCollision) << out.row.reason;
  EXPECT_EQ(out.row.object, "ball");
  EXPECT_LT(out.row.clearance_min_m, 0.01);
  ASSERT_GT(visible.size(), 90u);
  // The surface is at 1.3 m: 0.5 m from the base once it is at 0.8 m, after 80 steps of 1 cm.
  for (std::size_t k = 0; k < visible.size(); ++k) {
    if (k == 80) continue;  // on the edge, where rounding decides
    EXPECT_EQ(visible[k], k > 80) << k;
  }
}

TEST(Disturbances, CommandsActLateAndScaledOnThePlant) {
  TrialSpec point = tiny_spec();
  point.simulation.time_limit = 1.0;
  point.stuck.ends.time = kInfinity;
  point.disturbances.actuators.joints.delay = 0.06;  // 3 steps
  point.disturbances.actuators.base.delay = 0.1;     // 5
  point.disturbances.actuators.base.gain_error.linear = 0.1;
  World world = tiny_world(3.0);
  world.seed = 8;
  TrialParts parts;
  parts.controller = [](const TrialSpec& p) {
    return std::make_unique<ScriptedController>(
        p.robot->model->num_velocities(), [](const Observation& o, StepResult& result) {
          result.command << 0.1 + 0.1 * o.time, 0.0, 0.2 * std::cos(o.time), 0.1 * std::sin(o.time), 0.05;
        });
  };
  const TrialOutput out = run_trial(point, world, parts);
  ASSERT_EQ(out.trace.size(), 50u) << out.row.reason;
  const double factor = (out.trace[6].base.x() - out.trace[5].base.x()) / 0.02 / out.trace[0].command[0];
  EXPECT_GT(std::abs(factor - 1.0), 1e-4);
  EXPECT_LT(std::abs(factor - 1.0), 0.5);
  for (std::size_t k = 0; k + 1 < out.trace.size(); ++k) {
    const VectorX moved = (out.trace[k + 1].q - out.trace[k].q) / 0.02;
    const double driven = (out.trace[k + 1].base.x() - out.trace[k].base.x()) / 0.02;
    EXPECT_LT((moved - (k < 3 ? VectorX::Zero(3) : VectorX(out.trace[k - 3].command.tail(3)))).norm(), 1e-12) << k;
    EXPECT_NEAR(driven, k < 5 ? 0.0 : factor * out.trace[k - 5].command[0], 1e-12) << k;
  }
}

TEST(Disturbances, AMissedPeriodRepeatsTheLastCommand) {
  TrialSpec point = tiny_spec();
  point.simulation.time_limit = 10.0;
  point.stuck.ends.time = kInfinity;
  point.disturbances.control.missed = 0.3;
  World world = tiny_world(30.0);
  world.seed = 8;
  std::vector<double> asked;
  const TrialOutput out = run_scripted(point, world, [&](const Observation& o, StepResult& result) {
    asked.push_back(o.time);
    result.command[0] = 0.1 + 0.01 * o.time;
  });
  ASSERT_EQ(out.trace.size(), 500u) << out.row.reason;
  EXPECT_EQ(asked.front(), 0.0) << "the first period has a command";
  EXPECT_NEAR(static_cast<double>(asked.size()), 0.7 * 500, 5.0 * std::sqrt(500 * 0.3 * 0.7));
  std::size_t next = 0;
  for (const Sample& sample : out.trace) {
    if (next < asked.size() && asked[next] == sample.t) ++next;
    EXPECT_EQ(sample.command[0], 0.1 + 0.01 * asked[next - 1]) << sample.t;
  }
  EXPECT_EQ(next, asked.size()) << "the controller is asked at the trial's own times";
}

TEST(Disturbances, AreSweptSetAndResolvedInAnyOrder) {
  SuiteFolder folder;
  folder.write("noisy.yaml", "joints: {noise: 0.002}\nbase: {delay: 0.04}\n");
  for (const char* order : {"[none, noisy.yaml]", "[noisy.yaml, none]"}) {
    const Suite suite =
        load_suite(folder.suite("sweep: {axes: {disturbances: " + std::string(order) + "}}\n", "{one: {}, two: {}}"));
    ASSERT_EQ(suite.points.size(), 4u);
    const Suite again = suite_from_resolved(nlohmann::ordered_json::parse(suite.resolved.dump()));
    std::set<std::string> labels;
    for (std::size_t p = 0; p < 4; ++p) {
      const bool noisy = suite.points[p].label == "disturbances=noisy";
      labels.insert(suite.points[p].label);
      EXPECT_EQ(suite.points[p].disturbances.joints.noise, noisy ? 0.002 : 0.0);
      EXPECT_TRUE(same(suite.points[p].disturbances, again.points[p].disturbances)) << order << " point " << p;
      EXPECT_EQ(trial_key(suite.points[p], 1), trial_key(again.points[p], 1));
    }
    EXPECT_EQ(labels, (std::set<std::string>{"disturbances=none", "disturbances=noisy"}));
  }
  // Single keys by range, over a file, over nothing and over none.
  for (const char* given :
       {"disturbances: noisy.yaml\n", "", "disturbances: none\n", "disturbances: {base: {delay: 0.04}}\n"}) {
    const Suite suite =
        load_suite(folder.suite(std::string(given) +
                                "sweep: {axes: {disturbances.goal.noise.position: {linear: [0, 0.02], n: 3}}}\n"),
                   {{"disturbances.joints.bias", "0.003"}});
    ASSERT_EQ(suite.points.size(), 3u);
    EXPECT_EQ(suite.points[2].disturbances.goal.noise.position, 0.02) << given;
    EXPECT_EQ(suite.points[0].disturbances.joints.bias, 0.003) << given;
    EXPECT_EQ(suite.points[0].disturbances.joints.noise,
              std::string(given).find("noisy") != std::string::npos ? 0.002 : 0);
  }
  const std::string file = (folder.root() / "noisy.yaml").string();
  EXPECT_EQ(load_suite(folder.suite(), {{"disturbances", file}}).points[0].disturbances.base.delay, 0.04);
  EXPECT_FALSE(
      any(load_suite(folder.suite("disturbances: noisy.yaml\n"), {{"disturbances", "none"}}).points[0].disturbances));
}

TEST(Disturbances, WhatIsWrongIsSaidWithItsPlace) {
  SuiteFolder folder;
  const auto refused = [&](const std::string& more, const Overrides& overrides, const std::string& says) {
    try {
      load_suite(folder.suite(more), overrides);
      ADD_FAILURE() << "accepted: " << more;
    } catch (const config::ConfigError& e) {
      EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << e.what();
    }
  };
  refused("disturbances: {joints: {nose: 1}}\n", {}, "suite.yaml:7:25: disturbances.joints.nose: unknown key");
  refused("disturbance: {}\n", {}, "did you mean disturbances?");
  refused("disturbances: gone.yaml\n", {}, "no such file");
  refused("disturbances: some\n", {}, "suite.yaml:7:15: disturbances: found 'some', expected none");
  refused("", {{"disturbances.base.delay", "3"}}, "disturbances.base.delay: found '3'");
  refused("", {{"disturbances", "wild"}}, "disturbances: found 'wild'");
  refused("sweep: {axes: {disturbances.base.delay: [-1]}}\n", {}, "disturbances.base.delay: found '-1'");
}

TEST(Disturbances, TheLargestThatAreAllowedEndTrialsInAnOutcome) {
  SuiteFolder folder;
  const std::string most = R"({
  joints: {noise: 10, velocity_noise: 10, bias: 10, delay: 2},
  base: {noise: {position: 10, rotation: 10}, velocity_noise: {linear: 10, angular: 10},
         bias: {position: 10, rotation: 10}, delay: 2,
         odometry: {distance: 1, turn: 1, heading: 10, walk: {position: 10, rotation: 10}}},
  objects: {frame: base, noise: {position: 10, rotation: 10}, velocity_noise: {linear: 10, angular: 10},
            bias: {position: 10, rotation: 10}, delay: 2, range: 0, detection: 3600},
  goal: {frame: base, noise: {position: 10, rotation: 10}, velocity_noise: {linear: 10, angular: 10},
         bias: {position: 10, rotation: 10}, delay: 2},
  actuators: {joints: {delay: 2, gain_error: 1}, base: {delay: 2, gain_error: {linear: 1, angular: 1}}}
})";
  const std::string moma = MOMA_SOURCE_DIR "/configs/controllers/moma.yaml";
  for (const char* mode : {"kinematic", "dynamic"}) {
    const Suite suite = clutter(folder, "disturbances: " + most + "\n", mode,
                                "{moma: " + moma + ", rrmc: {method: rrmc}, baur: {method: baur}}");
    for (const TrialOutput& out : run(suite, 2)) {
      EXPECT_NE(out.row.outcome, Outcome::kError) << out.row.reason;
      EXPECT_TRUE(std::isfinite(out.row.path_base_m));
    }
  }
}

TEST(Disturbances, TheShippedSuiteIsGood) {
  const Suite suite = load_suite(MOMA_SOURCE_DIR "/configs/suites/disturbances.yaml");
  EXPECT_TRUE(suite.warnings.empty()) << suite.warnings.front();
  ASSERT_EQ(suite.points.size(), 9u);
  int on = 0;
  for (const SuitePoint& point : suite.points) on += any(point.disturbances) ? 1 : 0;
  EXPECT_EQ(on, 6);
}

TEST(Disturbances, TheTraceSaysWhatWasOn) {
  SuiteFolder folder;
  const Suite suite = load_suite(folder.suite("disturbances: {joints: {noise: 0.002}}\n"));
  const SuitePoint& point = suite.points[0];
  const World world = point.worlds.make(point.robot->model, 0);
  const nlohmann::ordered_json json = trace_json(point, world, run_trial(point, world), "0");
  EXPECT_EQ(json["disturbances"].dump(), R"({"joints":{"noise":0.002}})");
}

}  // namespace
}  // namespace moma::test
