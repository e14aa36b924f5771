// Suite files: what is read, what is refused, and the resolved form.
#include <gtest/gtest.h>

#include "controller/config/node.h"
#include "eval/trial/key.h"
#include "eval/trial/trial.h"
#include "tests/eval/suite_fixture.h"
#include "tests/support/scratch.h"

namespace moma::test {
namespace {

std::string refusal(const std::filesystem::path& file, const Overrides& overrides = {}) {
  try {
    load_suite(file, overrides);
  } catch (const config::ConfigError& e) {
    return e.what();
  }
  return "accepted";
}

#define EXPECT_REFUSED(file, overrides, part)                             \
  do {                                                                    \
    const std::string text = refusal(file, overrides);                    \
    EXPECT_NE(text.find(part), std::string::npos) << "message: " << text; \
  } while (false)

TEST(Suite, ReadsEverySection) {
  SuiteFolder folder;
  const Suite suite =
      load_suite(folder.suite(R"(success: {position: 0.03, orientation: 0.1, dwell: 0.4}
stuck: {time: 1.5, motion: 0.001}
infeasible: {time: .inf}
samples: all
)",
                              "{plain: controllers/plain.yaml, quick: {include: controllers/plain.yaml, "
                              "servo: {position: 3}}, bare: {}}"));
  EXPECT_EQ(suite.name, "tiny");
  EXPECT_EQ(suite.trials, 10u);
  EXPECT_EQ(suite.samples, SamplesKept::kAll);
  ASSERT_EQ(suite.points.size(), 3u);
  EXPECT_EQ(suite.points[1].controller, "quick");
  EXPECT_EQ(suite.points[0].controller_params.servo.position, 1.5);
  EXPECT_EQ(suite.points[1].controller_params.servo.position, 3.0);
  EXPECT_EQ(suite.points[1].label, "");
  const SuitePoint& point = suite.points[0];
  EXPECT_EQ(point.simulation.mode, SimulationMode::kKinematic);
  EXPECT_EQ(point.simulation.time_limit, 6.0);
  EXPECT_EQ(point.simulation.control_period, 0.02);
  EXPECT_EQ(point.success.dwell, 0.4);
  EXPECT_EQ(point.stuck.ends.motion, 0.001);
  EXPECT_EQ(point.infeasible.time, kInfinity);
  EXPECT_EQ(point.robot->model->num_joints(), 3);
  EXPECT_EQ(point.robot.get(), suite.points[2].robot.get()) << "the robot is shared";
  EXPECT_EQ(point.worlds.seed(), 3u);
}

// Who is told by depth needs sensors and a map; what it believes about the start is compared with what worlds promise.
TEST(Suite, ToldByDepthNeedsSensorsAndAMap) {
  const std::string folder = MOMA_SOURCE_DIR "/configs/suites/";
  const auto set = [](const char* key, const char* value) { return Overrides{{key, value}}; };
  EXPECT_REFUSED(folder + "depth.yaml", set("robot", "../robots/frankie.yaml"),
                 "has no sensors, and disturbances.objects.seen_by is depth");
  EXPECT_REFUSED(folder + "depth.yaml", set("controllers.moma.map", "none"),
                 "controllers.moma: has no `map`, and disturbances.objects.seen_by is depth");
  const auto warnings = [&](const char* room) {
    std::string all;
    for (const std::string& warning : load_suite(folder + "depth.yaml", set("worlds.start_room", room)).warnings)
      all += warning + "\n";
    return all;
  };
  EXPECT_NE(warnings("0.05").find("space 0.15 m about the start counts as free, and worlds.start_room promises 0.05 m"),
            std::string::npos)
      << warnings("0.05");
  EXPECT_EQ(warnings("0.15").find("start_room"), std::string::npos) << warnings("0.15");
}

TEST(Suite, RefusesWhatIsWrongAndSaysWhere) {
  SuiteFolder folder;
  EXPECT_REFUSED(folder.suite("sucess: {}\n"), {}, "suite.yaml:7:1: sucess: unknown key (did you mean success?)");
  EXPECT_REFUSED(folder.suite("success: {positon: 1}\n"), {}, "success.positon: unknown key (did you mean position?)");
  EXPECT_REFUSED(folder.suite("success: {position: -0.02}\n"), {}, "success.position: found '-0.02'");
  EXPECT_REFUSED(folder.suite("success: {position: nan}\n"), {}, "success.position: found 'nan'");
  EXPECT_REFUSED(folder.suite("success: {dwell: 6}\n"), {}, "does not fit into the time limit of 6 s");
  EXPECT_REFUSED(folder.suite("stuck: {time: 0.03}\n"), {}, "stuck.time: half of 0.03 s is shorter");
  EXPECT_REFUSED(folder.suite("stuck: {disturbed: {time: 0.03}}\n"), {},
                 "stuck.disturbed.time: half of 0.03 s is shorter");
  EXPECT_REFUSED(folder.suite("samples: some\n"), {}, "expected one of: all, failures, none");
  EXPECT_REFUSED(folder.suite("", "{}"), {}, "controllers: expected at least one controller");
  EXPECT_REFUSED(folder.suite("", "[controllers/plain.yaml]"), {}, "controllers: expected at least one controller");
  EXPECT_REFUSED(folder.suite("", "{plain: controllers/none.yaml}"), {}, "none.yaml");
  EXPECT_REFUSED(folder.suite("", "{a.b: controllers/plain.yaml}"), {}, "controllers.a.b: a controller's name");
  EXPECT_REFUSED(folder.suite("", "{plain: {lambda_p: 1}}"), {}, "lambda_p");
  EXPECT_REFUSED(folder.write("empty.yaml", ""), {}, "the suite is empty");
  EXPECT_REFUSED(folder.write("list.yaml", "[1, 2]"), {}, "the suite is empty; expected a map");
  EXPECT_REFUSED(folder.write("short.yaml", "name: x\n"), {}, "trials: missing");
  EXPECT_REFUSED(folder.write("short.yaml", "trials: 1\n"), {}, "robot: missing");
  EXPECT_REFUSED(folder.root() / "absent.yaml", {}, "no such file");
  EXPECT_REFUSED(folder.write("broken.yaml", "trials: [1\n"), {}, "broken.yaml:");
}

TEST(Suite, SaysWhatWasTypedAndWhatThereIs) {
  SuiteFolder folder;
  const auto file = folder.suite("", "{mine: controllers/plain.yaml, other: controllers/plain.yaml}");
  EXPECT_REFUSED(
      file, (Overrides{{"controllers.mien.lambda_q", "1"}}),
      "--set controllers.mien.lambda_q=1: controllers.mien.lambda_q: the suite has no controller mien (did you "
      "mean mine?); it has mine, other");
  EXPECT_REFUSED(file, (Overrides{{"worlds.families.opn.weight", "2"}}), "--set worlds.families.opn.weight=2: ");
  EXPECT_EQ(refusal(file, Overrides{{"controllers.mine.lambda_q", "1"}}), "accepted");
}

TEST(Suite, PathsWithinAnOptionAreThoseOfTheWorkingFolder) {
  SuiteFolder folder;
  const std::string plain =
      std::filesystem::relative(folder.root() / "controllers/plain.yaml", std::filesystem::current_path()).string();
  const Suite suite = load_suite(folder.suite(), {{"controllers", "{mine: " + plain + "}"}});
  EXPECT_EQ(suite.points.front().controller, "mine");
  EXPECT_EQ(suite.points.front().controller_params.servo.position, 1.5);
}

TEST(Suite, PhysicsNeedsWheelsAndMasses) {
  SuiteFolder folder;
  const auto file = folder.suite();
  const Overrides dynamic{{"simulation.mode", "dynamic"}};
  EXPECT_EQ(refusal(file, dynamic), "accepted");
  const auto without = [&](const char* key) {
    Overrides all = dynamic;
    all.emplace_back(key, "null");
    return all;
  };
  EXPECT_REFUSED(file, without("robot.base.wheels"),
                 "robot: cannot be simulated in dynamic mode: robot tiny: base.wheels is missing");
  EXPECT_REFUSED(file, without("robot.base.footprint.mass"), "base.footprint.mass is missing");
  EXPECT_EQ(refusal(file, Overrides{{"robot.base.wheels", "null"}}), "accepted") << "kinematic";
}

TEST(Suite, WarnsOfABaseThatBrakesTooLate) {
  SuiteFolder folder;
  const auto file = folder.suite();
  const auto said = [&](const Overrides& overrides) {
    for (const std::string& warning : load_suite(file, overrides).warnings)
      if (warning.find("to brake from") != std::string::npos) return warning;
    return std::string();
  };
  // 1 m/s at 2 m/s^2: 0.25 m, which is just what the rows have by default (0.3 m to 0.05 m).
  EXPECT_EQ(said({}), "");
  const std::string warning = said({{"robot.base.max_acceleration", "[0.5, 1]"}});
  EXPECT_NE(
      warning.find("controllers.plain.collision.influence: rows begin 0.25 m before they stop the robot, its base "
                   "takes 1 m to brake from 1 m/s (0.5 m/s^2)"),
      std::string::npos)
      << warning;
  EXPECT_NE(warning.find("1.05 m or more"), std::string::npos) << warning;
  EXPECT_EQ(said({{"robot.base.max_acceleration", "[0.5, 1]"}, {"controller.collision.influence", "1.06"}}), "");
  EXPECT_EQ(said({{"robot.base.max_acceleration", "[0.5, 1]"}, {"controller.collision.gain", "0.4"}}), "");
}

TEST(Suite, RefusesWrongTrialsAndPeriods) {
  SuiteFolder folder;
  const auto suite = folder.suite();
  EXPECT_REFUSED(suite, (Overrides{{"trials", "0"}}), "trials: found '0', expected a whole number from 1");
  EXPECT_REFUSED(suite, (Overrides{{"trials", "-3"}}), "trials: found '-3'");
  EXPECT_REFUSED(suite, (Overrides{{"trials", "2.5"}}), "trials: found '2.5'");
  EXPECT_REFUSED(suite, (Overrides{{"simulation.physics_step", "0.05"}}), "simulation.physics_step: found '0.05'");
  EXPECT_REFUSED(suite, (Overrides{{"simulation.control_period", "0"}}), "simulation.control_period: found '0'");
  EXPECT_REFUSED(suite, (Overrides{{"simulation.time_limit", ".inf"}}), "simulation.time_limit");
  EXPECT_REFUSED(suite, (Overrides{{"simulation.time_limit", "0.01"}}), "shorter than one control period");
}

TEST(Suite, OverridesReachAnyKey) {
  SuiteFolder folder;
  const auto file = folder.suite("", "{one: controllers/plain.yaml, two: {include: controllers/plain.yaml}}");
  const Suite suite = load_suite(file, {{"trials", "7"},
                                        {"worlds.seed", "99"},
                                        {"simulation.mode", "dynamic"},
                                        {"controller.lambda_q", "0.02"},
                                        {"controllers.two.servo.position", "2.5"},
                                        {"robot.base.max_linear", "0.5"},
                                        {"success", "{position: 0.1}"}});
  EXPECT_EQ(suite.trials, 7u);
  ASSERT_EQ(suite.points.size(), 2u);
  EXPECT_EQ(suite.points[0].worlds.seed(), 99u);
  EXPECT_EQ(suite.points[0].simulation.mode, SimulationMode::kDynamic);
  EXPECT_EQ(suite.points[0].simulation.time_limit, 6.0) << "other keys of the map stay";
  EXPECT_EQ(suite.points[0].controller_params.lambda_q[0], 0.02);
  EXPECT_EQ(suite.points[1].controller_params.lambda_q[0], 0.02);
  EXPECT_EQ(suite.points[0].controller_params.servo.position, 1.5) << "the file's value stays";
  EXPECT_EQ(suite.points[1].controller_params.servo.position, 2.5);
  EXPECT_EQ(suite.points[0].robot->model->base.max_linear, 0.5);
  EXPECT_EQ(suite.points[0].robot->model->num_joints(), 3) << "the robot file's other keys stay";
  EXPECT_EQ(suite.points[0].success.position, 0.1);

  EXPECT_REFUSED(file, (Overrides{{"simulaton.mode", "dynamic"}}), "did you mean simulation.mode?");
  EXPECT_REFUSED(file, (Overrides{{"controllers.three.lambda_q", "x"}}), "controllers.three.lambda_q");
  EXPECT_REFUSED(file, (Overrides{{"controller.lambda_p", "1"}}), "lambda_p");
  const Suite swapped = load_suite(file, {{"controllers.two", (folder.root() / "controllers/plain.yaml").string()}});
  EXPECT_EQ(swapped.points[1].controller_params.servo.position, 1.5);
}

TEST(Suite, WarnsOfDoubtfulThings) {
  SuiteFolder folder;
  const Suite suite = load_suite(folder.suite("", "{a: {collision: {stop: 0.08}}, b: {collision: {stop: 0.08}}}"));
  const auto mentions = [&](const std::string& part) {
    return std::any_of(suite.warnings.begin(), suite.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; });
  };
  EXPECT_TRUE(mentions("collision.stop: 0.08 m is more than worlds.clearance (0.05 m)"));
  EXPECT_TRUE(mentions("a and b are the same in every value"));
  EXPECT_FALSE(mentions("unusual"));
  const Suite units =
      load_suite(folder.suite("success: {position: 5, orientation: 3}\n"
                              "disturbances: {base: {noise: {position: 5}}, payload: {mass: 100}}\n"));
  for (const char* words :
       {"success.position: 5 m is unusual, where suites have 0 to 0.5 m: millimetres?", "success.orientation: 3 rad",
        "disturbances.base.noise.position: 5 m", "disturbances.payload.mass: 100 kg"})
    EXPECT_EQ(std::count_if(units.warnings.begin(), units.warnings.end(),
                            [&](const std::string& w) { return w.find(words) != std::string::npos; }),
              1)
        << words;
}

TEST(Suite, WarnsOfAnAccelerationThatSharesReplace) {
  const std::string configs = std::string(MOMA_SOURCE_DIR) + "/configs/";
  const test::Scratch scratch;
  scratch.write("mine.yaml", "include: " + configs + "controllers/moma.yaml\nlimits: {acceleration: 2}\n");
  const auto said = [&](const std::string& controller, const Overrides& overrides = {},
                        const std::string& robot = "frankie.yaml") {
    const auto file =
        scratch.write("suite.yaml", "robot: " + configs + "robots/" + robot + "\ncontrollers: {c: " + controller +
                                        "}\nworlds: {families: {open: {}}}\n"
                                        "simulation: {mode: kinematic}\ntrials: 1\n");
    const Suite suite = load_suite(file, overrides);
    return std::count_if(suite.warnings.begin(), suite.warnings.end(), [](const std::string& w) {
      return w.starts_with("controllers.c.limits.acceleration: has no effect");
    });
  };
  const std::string moma = configs + "controllers/moma.yaml";
  const Overrides set = {{"controllers.c.limits.acceleration", "5"}};
  EXPECT_EQ(said(moma, set), 1);
  EXPECT_EQ(said("{include: " + moma + ", limits: {acceleration: 5}}"), 1);
  EXPECT_EQ(said("mine.yaml"), 1);
  EXPECT_EQ(said(moma, {{"sweep", "{axes: {controller.limits.acceleration: [1, 2]}}"}}), 1);
  EXPECT_EQ(said(moma, set, "panda.yaml"), 1) << "no base";
  EXPECT_EQ(said(moma), 0) << "its own file leaves it to the shares";
  EXPECT_EQ(said("{include: " + moma + ", k_epsilon: 0.1}"), 0);
  EXPECT_EQ(said("{include: " + moma + ", limits: {acceleration: 5, joints: 0}}"), 0);
  EXPECT_EQ(said("{include: " + moma + ", limits: {acceleration: 5, base: 0}}"), 0);
  EXPECT_EQ(said("{include: " + configs + "controllers/holistic.yaml, limits: {acceleration: 5}}"), 0);
}

void expect_same_keys(const Suite& a, const Suite& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.trials, b.trials);
  EXPECT_EQ(a.samples, b.samples);
  for (std::size_t p = 0; p < a.points.size(); ++p) {
    EXPECT_EQ(a.points[p].controller, b.points[p].controller);
    EXPECT_EQ(a.points[p].label, b.points[p].label);
    EXPECT_EQ(a.points[p].params.dump(), b.points[p].params.dump());
    EXPECT_EQ(a.points[p].controller_resolved.dump(), b.points[p].controller_resolved.dump());
    EXPECT_EQ(a.points[p].robot_digest, b.points[p].robot_digest);
    for (const std::uint64_t world : {0u, 1u, 7u}) {
      EXPECT_EQ(trial_key(a.points[p], world), trial_key(b.points[p], world)) << p << " " << world;
    }
  }
}

TEST(Suite, ResolvedFormReadsBackBitForBit) {
  SuiteFolder folder;
  const Suite plain = load_suite(folder.suite("infeasible: {time: .inf}\nsamples: none\n"));
  // Through text, as a store keeps it.
  const Suite again = suite_from_resolved(nlohmann::ordered_json::parse(plain.resolved.dump()));
  expect_same_keys(plain, again);
  EXPECT_EQ(again.resolved.dump(), plain.resolved.dump());

  const Suite swept = load_suite(folder.suite(R"(sweep:
  axes:
    controller.servo.position: [0.1, 2]
    simulation.control_period: [0.02, 0.03]
    robot.base.max_linear: [0.4, 0.7]
    worlds.seed: [1, 2]
)",
                                              "{a: controllers/plain.yaml, b: {servo: {orientation: 0.3}}}"));
  ASSERT_EQ(swept.points.size(), 32u);
  expect_same_keys(swept, suite_from_resolved(nlohmann::ordered_json::parse(swept.resolved.dump())));
  EXPECT_EQ(swept.resolved["more_robots"].size(), 1u) << "each robot is kept once";
}

TEST(Suite, NotesAreKeptAndDecideNothing) {
  SuiteFolder folder;
  const Suite plain = load_suite(folder.suite());
  EXPECT_EQ(plain.notes, "");
  EXPECT_FALSE(plain.resolved.contains("notes"));
  const Suite noted = load_suite(folder.suite("notes: |\n  # Why\n  Colon: kept, *so* is this.\n"));
  EXPECT_EQ(noted.notes, "# Why\nColon: kept, *so* is this.\n");
  EXPECT_EQ(noted.resolved.at("notes"), noted.notes);
  expect_same_keys(plain, noted);
  const Suite again = suite_from_resolved(nlohmann::ordered_json::parse(noted.resolved.dump()));
  EXPECT_EQ(again.notes, noted.notes);
  expect_same_keys(noted, again);
  EXPECT_REFUSED(folder.suite("notes: [one, two]\n"), Overrides{}, "notes: found a list, expected text in Markdown");
  EXPECT_REFUSED(folder.suite("notes: {one: two}\n"), Overrides{}, "notes: found a map, expected text");
  EXPECT_EQ(load_suite(folder.suite("notes:\n")).resolved.dump(), plain.resolved.dump()) << "nothing is none";
  EXPECT_REFUSED(folder.suite("note: one\n"), Overrides{}, "did you mean notes?");
}

TEST(Suite, ResolvedFormIsReadStrictly) {
  SuiteFolder folder;
  nlohmann::ordered_json resolved = load_suite(folder.suite()).resolved;
  resolved["simulation"]["mode"] = "static";
  EXPECT_THROW(suite_from_resolved(resolved), config::ConfigError);
  resolved["simulation"]["mode"] = "kinematic";
  resolved["extra"] = 1;
  EXPECT_THROW(suite_from_resolved(resolved), config::ConfigError);
  EXPECT_THROW(suite_from_resolved(nlohmann::ordered_json::array()), config::ConfigError);
  EXPECT_THROW(suite_from_resolved(nlohmann::ordered_json::object()), config::ConfigError);
}

TEST(Suite, KeysChangeWithEverythingThatDecidesARow) {
  SuiteFolder folder;
  const auto file = folder.suite();
  const std::string base = trial_key(load_suite(file).points[0], 4);
  EXPECT_EQ(base.size(), 32u);
  EXPECT_EQ(trial_key(load_suite(file).points[0], 4), base);
  EXPECT_NE(trial_key(load_suite(file).points[0], 5), base);
  for (const Overrides& change : {Overrides{{"controller.k_epsilon", "0.25"}},
                                  {{"robot.base.max_angular", "1.9"}},
                                  {{"simulation.time_limit", "7"}},
                                  {{"success.dwell", "0.3"}},
                                  {{"stuck.motion", "0.0006"}},
                                  {{"infeasible.time", "0.6"}},
                                  {{"worlds.seed", "4"}}}) {
    EXPECT_NE(trial_key(load_suite(file, change).points[0], 4), base) << change[0].first;
  }
  for (const Overrides& harmless : {Overrides{{"trials", "20"}}, {{"samples", "none"}}, {{"name", "other"}}})
    EXPECT_EQ(trial_key(load_suite(file, harmless).points[0], 4), base) << harmless[0].first;
}

TEST(Suite, CanonicalDigestForgetsOrderOnly) {
  using nlohmann::ordered_json;
  EXPECT_EQ(canonical_digest(ordered_json::parse(R"({"a": 1, "b": {"c": 2.5, "d": []}})")),
            canonical_digest(ordered_json::parse(R"({"b": {"d": [], "c": 2.5}, "a": 1})")));
  EXPECT_NE(canonical_digest(ordered_json::parse("[1, 2]")), canonical_digest(ordered_json::parse("[2, 1]")));
  // The published test value of XXH3-128 for the empty input.
  EXPECT_EQ(digest_hex(""), "99aa06d3014798d86001c324468d497f");
}

}  // namespace
}  // namespace moma::test
