// Results and keys of a fixed suite, written down: a change of either must be meant.
//
// If rows changed on purpose, raise kSimulationVersion (eval/trial/trial.h), run this program with
// MOMA_UPDATE_GOLDEN=1 and commit the file it writes. Stored trials then keep their old keys.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "eval/batch/batch.h"
#include "tests/eval/suite_fixture.h"

namespace moma::test {
namespace {

using nlohmann::ordered_json;

constexpr const char* kFile = MOMA_SOURCE_DIR "/tests/data/golden/kinematic_rows.json";
// Libraries and compilers round differently; a change of what is computed shows far above this.
constexpr double kRelative = 1e-6;

ordered_json value(double number) { return std::isnan(number) ? ordered_json(nullptr) : ordered_json(number); }

ordered_json row_json(const BatchJob& job, const std::string& controller, const TrialRow& row) {
  return {{"controller", controller},
          {"world", job.world},
          {"key", job.key},
          {"outcome", to_string(row.outcome)},
          {"steps", row.steps},
          {"time_to_goal_s", value(row.time_to_goal_s)},
          {"position_error_m", value(row.position_error_m)},
          {"path_ee_m", value(row.path_ee_m)},
          {"path_base_m", value(row.path_base_m)},
          {"manip_mean", value(row.manip_mean)},
          {"manip_all_min", value(row.manip_all_min)},
          {"clearance_min_m", value(row.clearance_min_m)},
          {"clearance_self_min_m", value(row.clearance_self_min_m)},
          {"limit_margin_min", value(row.limit_margin_min)},
          {"jerk_joint_rms", value(row.jerk_joint_rms)},
          {"command_change_mean", value(row.command_change_mean)},
          {"slack_mean", value(row.slack_mean)},
          {"active_rows_mean", value(row.active_rows_mean)}};
}

ordered_json computed() {
  SuiteFolder folder;
  const Suite suite = load_suite(folder.write("golden.yaml", R"(robot: robots/tiny.yaml
controllers:
  published: {error_norm: {kind: l1}, collision: {self: {enabled: false}}}
  constant: {base_weight: 0.1, slack: {weight: 100}, servo: {position: 3, max_linear: 1}, limits: {acceleration: 5}}
  baseline: {method: rrmc}
worlds: {seed: 11, families: {open: {weight: 1, distance: {uniform: [0.5, 1.5]}}, clutter: {weight: 1, objects: 3}}}
simulation: {mode: kinematic, time_limit: 8}
success: {position: 0.4, orientation: 3}
trials: 6
)"));
  ordered_json rows = ordered_json::array();
  run_batch(suite.points, make_jobs(suite.points, 0, suite.trials), {}, [&](const BatchJob& job, BatchResult&& result) {
    rows.push_back(row_json(job, suite.points[job.point].controller, result.output.row));
    return true;
  });
  return {{"simulation_version", kSimulationVersion}, {"rows", rows}};
}

TEST(TrialGolden, RowsAndKeysAreThoseWrittenDown) {
  const ordered_json now = computed();
  if (std::getenv("MOMA_UPDATE_GOLDEN") != nullptr) {
    std::ofstream(kFile) << now.dump(1) << '\n';
    GTEST_SKIP() << "wrote " << kFile;
  }
  std::ifstream in(kFile);
  ASSERT_TRUE(in) << kFile;
  const ordered_json golden = ordered_json::parse(in);
  EXPECT_EQ(golden["simulation_version"], now["simulation_version"]);
  ASSERT_EQ(golden["rows"].size(), now["rows"].size());
  for (std::size_t i = 0; i < now["rows"].size(); ++i) {
    const ordered_json& row = now["rows"][i];
    for (const auto& [name, old] : golden["rows"][i].items()) {
      const std::string where = name + " of " + row["controller"].get<std::string>() + ", world " + row["world"].dump();
      if (old.is_number_float() && row[name].is_number_float()) {
        EXPECT_NEAR(row[name].get<double>(), old.get<double>(), 1e-9 + kRelative * std::abs(old.get<double>()))
            << where;
      } else {
        EXPECT_EQ(row[name], old) << where;
      }
    }
  }
}

}  // namespace
}  // namespace moma::test
