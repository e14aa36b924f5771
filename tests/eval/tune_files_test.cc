#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "controller/config/node.h"
#include "eval/tune/trial_cost.h"
#include "eval/tune/tuned_file.h"
#include "eval/tune/tuning.h"
#include "tests/eval/suite_fixture.h"

namespace moma::tune {
namespace {

using moma::test::SuiteFolder;

constexpr const char* kVariables = "  variables: {controller.k_epsilon: {range: [0.1, 5], scale: log}}\n";

std::string message(const std::string& tune, const Overrides& overrides = {}) {
  const SuiteFolder folder;
  const auto file = folder.suite("tune:\n" + tune);
  try {
    load_tuning(file, overrides);
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string with_variable(const std::string& variable, const std::string& more = "") {
  return message("  variables: {" + variable + "}\n  budget: {trials: 1000}\n" + more);
}

std::string with(const std::string& more) { return message(kVariables + ("  budget: {trials: 1000}\n" + more)); }

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << "said: " << (text)

TEST(TuneFiles, ReadsASectionWithItsDefaults) {
  const SuiteFolder folder;
  const Tuning t =
      load_tuning(folder.suite("tune:\n  variables: {controller.k_epsilon: {range: [0.1, 5], scale: log}, "
                               "controller.lambda_q: {range: [0.001, 1], scale: log}}\n  budget: {trials: 20000}\n"));
  EXPECT_EQ(t.config.controller, "plain");
  ASSERT_EQ(t.config.variables.size(), 2u);
  EXPECT_EQ(t.config.variables[0].start, 0.5) << "the controller's own value";
  EXPECT_EQ(t.config.variables[1].start, 0.01) << "a list of equal values counts as one";
  EXPECT_TRUE(t.config.cost.standard());
  EXPECT_EQ(t.config.worlds.count, 100u);
  EXPECT_EQ(t.config.confirm.first, 100u);
  EXPECT_EQ(t.config.held_out.first, 200u);
  EXPECT_EQ(t.config.held_out.count, 500u);
}

// A key that is listed and not read would be refused as unknown.
TEST(TuneFiles, EveryKeyThatIsListedIsRead) {
  const std::vector<Key> keys = tune_keys();
  EXPECT_GT(keys.size(), 20u);
  for (const Key& key : keys) {
    const std::string said =
        message(kVariables + std::string("  budget: {trials: 1000}\n"), {{key.name, "[[no such value]]"}});
    EXPECT_SAYS(said, key.name);
    EXPECT_EQ(said.find("unknown key"), std::string::npos) << key.name << " said: " << said;
  }
}

TEST(TuneFiles, BadVariablesAreNamedWithTheirPlace) {
  EXPECT_SAYS(with_variable("controller.k_epsilon: {range: [5, 0.1]}"), "suite.yaml:8:");
  EXPECT_SAYS(with_variable("controller.k_epsilon: {range: [5, 0.1]}"), "lower end below its upper end");
  EXPECT_SAYS(with_variable("controller.k_epsilon: {range: [0, 5], scale: log}"), "scale log must be above zero");
  EXPECT_SAYS(with_variable("controller.k_epsilon: {range: [-1, 5], scale: log}"), "scale log must be above zero");
  EXPECT_SAYS(with_variable("controller.k_epsilon: {range: [1, 5]}"), "start 0.5 is outside its range [1, 5]");
  EXPECT_SAYS(with_variable("controller.k_epsilon: {range: [1, 5], start: 9}"), "start 9 is outside its range [1, 5]");
  EXPECT_SAYS(with_variable("controller.k_epsilon: {range: [1, 5, 6]}"), "range");
  EXPECT_SAYS(with_variable("controller.k_epsilon: {rang: [1, 5]}"), "range");
  EXPECT_SAYS(with_variable("controller.k_epsilonn: {range: [1, 5], start: 2}"), "did you mean k_epsilon?");
  EXPECT_SAYS(with_variable("controllers.other.k_epsilon: {range: [1, 5], start: 2}"), "other");
  EXPECT_SAYS(with_variable("controller.base_weight: {range: [1, 5]}"),
              "(inverse_error) is not one finite number; give `start`");
  EXPECT_SAYS(with_variable("controller.servo.max_linear: {range: [1, 5]}"), "is not one finite number; give `start`");
  EXPECT_SAYS(with_variable("trials: {range: [1, 5], start: 2}"), "cannot be searched");
  EXPECT_SAYS(with_variable("controller.method: {range: [1, 5], start: 2}"), "method");
  EXPECT_SAYS(message("  budget: {trials: 1000}\n"), "variables");
  EXPECT_SAYS(message("  variables: {}\n  budget: {trials: 1000}\n"), "at least one key");
}

TEST(TuneFiles, BadSettingsAreNamed) {
  EXPECT_SAYS(with("  algorithm: CRS3\n"), "known are CRS2_LM");
  EXPECT_SAYS(with("  algorithm: [BOBYQQ]\n"), "did you mean BOBYQA?");
  EXPECT_SAYS(with("  algorithm: [{name: BOBYQA, population: 5}]\n"), "tune.algorithm");
  EXPECT_SAYS(with("  algorithms: BOBYQA\n"), "did you mean algorithm?");
  EXPECT_SAYS(with("  controller: mine\n"), "the suite has no controller 'mine'; it has plain");
  EXPECT_SAYS(with("  worlds: 0\n"), "whole number");
  EXPECT_SAYS(with("  racing: {significance: 2}\n"), "significance");
  EXPECT_SAYS(message(std::string(kVariables) + "  budget: {trials: 0}\n"), "tune.budget.trials");
  EXPECT_SAYS(message(std::string(kVariables) + "  budget: {trials: 150}\n"),
              "does not reach for two candidates (100 trials each)");
  EXPECT_SAYS(message(kVariables), "budget");
  EXPECT_SAYS(message(std::string(kVariables) + "  budget: {trials: 1000}\n", {{"tune.budget.trials", "0"}}),
              "tune.budget.trials");
  const SuiteFolder folder;
  EXPECT_THROW(load_tuning(folder.suite()), config::ConfigError) << "a suite without a tune section";
}

TEST(TuneFiles, ObjectiveAndConstraintsKnowTheirMetrics) {
  EXPECT_EQ(with("  objective: {maximize: success}\n"), "");
  EXPECT_EQ(with("  objective: {minimize: {success: -10, command_change_mean: {weight: 5, when_null: 1}}}\n"), "");
  EXPECT_SAYS(with("  objective: {minimize: sucess}\n"), "did you mean success?");
  EXPECT_SAYS(with("  objective: fast\n"), "expected default");
  EXPECT_SAYS(with("  objective: {minimize: time_to_goal_s}\n"), "time_to_goal_s is NULL unless the trial succeeds");
  EXPECT_EQ(with("  objective: {minimize: {time_to_goal_s: {weight: 1, when_null: 60}}}\n"), "");
  EXPECT_SAYS(with("  objective: {minimize: energy_j}\n"), "NULL in kinematic mode");
  EXPECT_SAYS(with("  objective: {minimize: reason}\n"), "is text");
  EXPECT_SAYS(with("  objective: {minimize: t_step_p99_us}\n"), "is a timing");
  EXPECT_SAYS(with("  objective: {minimize: success, maximize: success}\n"), "one of the keys");
  EXPECT_EQ(with("  constraints: {collision: {at_most: 0.01}, success: {at_least: 0.5}}\n"), "");
  EXPECT_SAYS(with("  constraints: {collision: 0.01}\n"), "collision");
  EXPECT_SAYS(with("  constraints: {collision: {at_most: 0.01, at_least: 0}}\n"), "one of the keys");
  EXPECT_SAYS(with("  constraints: {time_to_goal_s: {at_most: 10}}\n"), "when_null");
  EXPECT_EQ(with("  constraints: {collision: {at_most: start}}\n"), "");
  EXPECT_SAYS(with("  constraints: {collision: {at_most: begin}}\n"), "tune.constraints.collision");
}

TEST(TuneFiles, TheDefaultObjectiveKeepsTheStartsSuccess) {
  const auto bounds = [](const std::string& more) {
    const SuiteFolder folder;
    const Tuning tuning = load_tuning(folder.suite("tune:\n" + (kVariables + ("  budget: {trials: 1000}\n" + more))));
    std::vector<std::string> names;
    for (const Constraint& constraint : search_settings(tuning).constraints) names.push_back(constraint.name);
    return fmt::format("{}", fmt::join(names, ", "));
  };
  EXPECT_EQ(bounds(""), "success >= the start's");
  EXPECT_EQ(bounds("  constraints: {collision: {at_most: 0.01}}\n"), "collision <= 0.01, success >= the start's");
  EXPECT_EQ(bounds("  constraints: {success: {at_least: 0}}\n"), "success >= 0");
  EXPECT_EQ(bounds("  objective: {minimize: command_change_mean}\n"), "");
}

TEST(TuneFiles, HeldOutWorldsMayNotOverlapTheSearch) {
  EXPECT_SAYS(with("  held_out: {first: 50, count: 100}\n"), "worlds 50 to 149 overlap those of the search, 0 to 99");
  EXPECT_SAYS(with("  held_out: {first: 150, count: 100}\n"), "overlap those of the confirmation, 100 to 199");
  EXPECT_EQ(with("  held_out: {first: 200, count: 100}\n"), "");
  EXPECT_EQ(with("  held_out: {first: 0, count: 100, seed: 4}\n"), "");
  EXPECT_SAYS(with("  held_out: {first: 0, count: 100, seed: 3}\n"), "overlap") << "the suite's own seed is 3";
}

TEST(TuneFiles, ACandidateIsTheSamePointAsTheSuiteWithSetOptions) {
  const SuiteFolder folder;
  const auto file = folder.suite(
      "tune:\n  variables: {controller.k_epsilon: {range: [0.1, 5], scale: log}, controllers.plain.collision.stop: "
      "{range: [0.01, 0.2], start: 0.05}, controller.lambda_q: {range: [0.001, 1], scale: log}}\n  budget: {trials: "
      "1000}\n");
  const Tuning tuning = load_tuning(file);
  const Candidate candidate{0.731, 0.0642, 0.0123};
  const SuitePoint fast = Points(tuning).make(candidate).front();
  const Suite suite = load_suite(
      file,
      {{"controller.k_epsilon", "0.731"}, {"controller.collision.stop", "0.0642"}, {"controller.lambda_q", "0.0123"}});
  EXPECT_EQ(fast.controller_resolved, suite.points.front().controller_resolved);
  for (std::uint64_t world = 0; world < 3; ++world)
    EXPECT_EQ(trial_key(fast, world), trial_key(suite.points.front(), world));
}

TEST(TuneFiles, OtherKeysOfTheSuiteCanBeSearchedToo) {
  const SuiteFolder folder;
  const Tuning tuning =
      load_tuning(folder.suite("tune:\n  variables: {simulation.control_period: {range: [0.01, 0.1], start: 0.02}, "
                               "controller.k_epsilon: {range: [0.1, 5]}}\n"
                               "  budget: {trials: 1000}\n"));
  const Points points(tuning);
  EXPECT_FALSE(points.same_worlds());
  const SuitePoint point = points.make({0.025, 0.7}).front();
  EXPECT_EQ(point.simulation.control_period, 0.025);
  EXPECT_EQ(point.controller_params.k_epsilon, 0.7);
}

TEST(TuneFiles, ContradictionsAreRefusedAndWarnedOf) {
  const SuiteFolder folder;
  const Tuning tuning =
      load_tuning(folder.suite("tune:\n  variables: {controller.collision.stop: {range: [0.01, 0.5], start: 0.05}}\n  "
                               "budget: {trials: 1000}\n"));
  EXPECT_THROW(Points(tuning).make({0.4}), config::ConfigError) << "stop beyond influence (0.3)";
  ASSERT_FALSE(tuning.warnings.empty());
  EXPECT_SAYS(tuning.warnings.back(), "0.5 is refused while the others are at their start");
}

TEST(TuneFiles, DefaultObjectiveOrdersWhatPeopleOrder) {
  const TrialCost cost;
  const TrialCost::Scale scale{30.0, 0.1};
  TrialRow fast, slow, rough, stuck, hit, broken;
  for (TrialRow* row : {&fast, &slow, &rough, &stuck, &hit}) {
    row->command_change_mean = 0.02;
    row->manip_mean = 0.1;
  }
  fast.outcome = slow.outcome = rough.outcome = Outcome::kSuccess;
  fast.time_to_goal_s = rough.time_to_goal_s = 6.0;
  slow.time_to_goal_s = 29.0;
  rough.command_change_mean = 0.5;
  stuck.outcome = Outcome::kStuck;
  hit.outcome = Outcome::kCollision;
  EXPECT_DOUBLE_EQ(cost(fast, scale), 6.0 + 1.0);
  EXPECT_DOUBLE_EQ(cost(rough, scale), 6.0 + 25.0);
  EXPECT_LT(cost(slow, scale), cost(stuck, scale));
  EXPECT_DOUBLE_EQ(cost(hit, scale) - cost(stuck, scale), 60.0);
  TrialRow awkward = fast;
  awkward.manip_mean = 0.04;
  EXPECT_DOUBLE_EQ(cost(awkward, scale), cost(fast, scale) + 3.0);
  EXPECT_DOUBLE_EQ(cost(broken, scale), 120.0 + 50.0 + 5.0) << "no metrics at all: the worst of each";
}

TEST(TuneFiles, ANullMetricWithoutAnAnswerIsAnError) {
  TrialRow row;  // ended before its first step
  const TrialCost cost({{Metric::find("manip_mean"), 1.0, std::nullopt}});
  try {
    cost(row, {});
    FAIL();
  } catch (const NullMetric& error) {
    EXPECT_SAYS(std::string(error.what()), "manip_mean is NULL for a trial with outcome error");
  }
  EXPECT_EQ(TrialCost({{Metric::find("manip_mean"), 2.0, 0.25}})(row, {}), 0.5);
  EXPECT_EQ(TrialCost({{Metric::find("error"), 3.0, std::nullopt}})(row, {}), 3.0);
}

TEST(TuneFiles, TheFoundFileIsAControllerWithTheFoundValues) {
  const SuiteFolder folder;
  const auto file = folder.suite(
      "tune:\n  variables: {controller.k_epsilon: {range: [0.1, 5], scale: log}, controller.collision.stop: {range: "
      "[0.01, 0.2], "
      "start: 0.05}}\n  budget: {trials: 1000}\n",
      "{plain: {include: controllers/plain.yaml, collision: {influence: 0.25}, slack: {weight: inverse_error, limit: "
      ".inf}}}");
  const Tuning tuning = load_tuning(file);
  SearchResult result;
  result.found = {0.123456, 0.0777};
  const std::string text = tuned_file(tuning, result, nullptr, "Suite: with 'quotes'\nand lines");
  const auto written = folder.write("controllers/tuned.yaml", text);
  const Suite suite = load_suite(folder.suite("", "{plain: controllers/tuned.yaml}"));
  EXPECT_EQ(suite.points.front().controller_resolved, Points(tuning).make(result.found).front().controller_resolved)
      << text;
}

}  // namespace
}  // namespace moma::tune
