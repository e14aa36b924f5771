#pragma once

#include <gtest/gtest.h>

#include <string>

#include "controller/config/node.h"
#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"
#include "eval/trial/trial.h"
#include "tests/eval/suite_fixture.h"

namespace moma::test {

/// Suites of one controller, `mine`, that is not moma's own: a plugin or a process.
class ForeignSuite : public ::testing::Test {
 protected:
  Suite load(const std::string& controller, const std::string& more = "", const Overrides& overrides = {}) {
    return load_suite(folder_.suite(more, "{mine: " + controller + "}"), overrides);
  }
  std::string error(const std::string& controller, const std::string& more = "", const Overrides& overrides = {}) {
    try {
      load(controller, more, overrides);
    } catch (const config::ConfigError& e) {
      return e.what();
    } catch (const std::exception& e) {
      return std::string("not a ConfigError: ") + e.what();
    }
    return "no error";
  }
  void expect_error(const std::string& controller, const std::string& key, const std::string& says) {
    const std::string message = error(controller);
    EXPECT_NE(message.find("suite.yaml:3:"), std::string::npos) << message;
    EXPECT_NE(message.find("controllers.mine." + key + ":"), std::string::npos) << message;
    EXPECT_NE(message.find(says), std::string::npos) << message;
  }
  TrialOutput run(const Suite& suite, std::uint64_t world = 0, std::size_t point = 0) {
    const SuitePoint& p = suite.points.at(point);
    return run_trial(p, p.worlds.make(p.robot->model, world));
  }
  /// A trial ends as an error with this reason; the next one of the same suite begins with a new process.
  void expect_failure(const std::string& controller, const std::string& says) {
    const Suite suite = load(controller);
    for (std::uint64_t world = 0; world < 2; ++world) {
      const TrialOutput output = run(suite, world);
      EXPECT_EQ(output.row.outcome, Outcome::kError) << controller;
      EXPECT_NE(output.row.reason.find(says), std::string::npos) << controller << ": " << output.row.reason;
    }
  }
  /// What a stored suite names now is not what its trials were computed by.
  static void expect_other_code(const nlohmann::ordered_json& stored) {
    try {
      suite_from_resolved(stored, Plugins::kOfStore);
      ADD_FAILURE() << "other code was taken for that of the stored trials";
    } catch (const config::ConfigError& e) {
      EXPECT_NE(std::string(e.what()).find("is not that of these trials"), std::string::npos) << e.what();
    }
  }
  SuiteFolder folder_;
};

}  // namespace moma::test
