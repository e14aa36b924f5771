// The published experiments repeated by the real program, a few problems each.
#include <nlohmann/json.hpp>

#include "cli_fixture.h"

namespace moma::test {
namespace {

using nlohmann::json;

class CliReproduce : public CliTest {
 protected:
  /// A small experiment of its own: two controllers, one of which was published.
  void SetUp() override {
    CliTest::SetUp();
    write("published.yaml", kPublished);
    // Goals within such a distance are reached in some worlds.
    write("suite.yaml", std::string(kSuite) + "success: {position: 0.6, orientation: 1.5}\n");
  }
  ProcessResult reproduce(const std::string& experiment, std::vector<std::string> more) const {
    std::vector<std::string> all = {"reproduce", experiment, "--published", MOMA_SOURCE_DIR "/configs/published.yaml",
                                    "-q"};
    all.insert(all.end(), more.begin(), more.end());
    return good(all);
  }
  std::string published_with(const std::string& from, const std::string& to) const {
    std::string all = kPublished;
    return all.replace(all.find(from), from.size(), to);
  }
  std::string hash(const std::string& store) const { return good({"verify", store, "--hash", "-q"}).out; }

  static constexpr const char* kPublished = R"(small:
  suite: suite.yaml
  source: a paper
  figures: [success_rate, time_to_goal]
  pairs: [[slow, plain]]
  rows:
    - {robot: tiny, method: plain, problems: 100, success_rate: 50, time_to_goal: 1}
    - {robot: tiny, method: planner, problems: 100, success_rate: 75}
)";
};

TEST_F(CliReproduce, PutsPublishedFiguresBesideOurs) {
  const json all =
      json::parse(good({"reproduce", "small", "--published", "published.yaml", "-o", "a.db", "-f", "json", "-q"}).out);
  const json& rows = all["rows"];
  ASSERT_EQ(rows.size(), 3u) << rows;
  // By the store's own means.
  const json summary = json::parse(
      good({"query", "a.db",
            "SELECT controller, count(*) AS n, 100.0 * avg(outcome = 'success') AS rate, avg(time_to_goal_s) AS time "
            "FROM v_trials GROUP BY controller ORDER BY controller",
            "-f", "json"})
          .out);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(rows[i]["method"], summary[i]["controller"]);
    EXPECT_EQ(rows[i]["n"], summary[i]["n"]);
    EXPECT_NEAR(std::stod(rows[i]["success_rate"].get<std::string>()), summary[i]["rate"].get<double>(), 0.051);
    if (summary[i]["time"].is_null()) continue;
    EXPECT_NEAR(std::stod(rows[i]["time_to_goal"].get<std::string>()), summary[i]["time"].get<double>(), 0.0051);
  }
  EXPECT_EQ(rows[0]["success_rate published"], "50.0");
  EXPECT_NE(rows[0]["success_rate agrees"], "");
  EXPECT_EQ(rows[1]["success_rate published"], "") << "nothing was published of it";
  EXPECT_EQ(rows[1]["success_rate agrees"], "");
  EXPECT_EQ(rows[2]["method"], "planner");
  EXPECT_EQ(rows[2]["success_rate"], "") << "nothing of ours";
  ASSERT_FALSE(all["differences"].empty());
  EXPECT_EQ(all["differences"][0]["difference"], "slow - plain");
  EXPECT_EQ(all["differences"][0]["n"], 6);
  // A rate that the six trials cannot come from.
  write("published.yaml", published_with("success_rate: 50", "success_rate: 0"));
  const json far = json::parse(good({"reproduce", "small", "--published", "published.yaml", "-o", "a.db", "-f", "json",
                                     "-q", "--set", "success={position: 3, orientation: 3.1}"})
                                   .out);
  EXPECT_EQ(far["rows"][0]["success_rate"].get<std::string>().substr(0, 5), "100.0");
  EXPECT_EQ(far["rows"][0]["success_rate agrees"], "no");
}

TEST_F(CliReproduce, AnotherSettingInTheSameStoreIsNotMixedIn) {
  const std::vector<std::string> command = {"reproduce", "small", "--published", "published.yaml", "-o", "a.db", "-q"};
  const std::string first = good(command).out;
  std::vector<std::string> other = command;
  other.insert(other.end(), {"--set", "success.position=0.2"});
  EXPECT_NE(good(other).out, first);
  EXPECT_EQ(good(command).out, first);
}

TEST_F(CliReproduce, MistakesAreNamed) {
  const std::vector<std::string> command = {"reproduce", "small", "--published", "published.yaml"};
  bad({"reproduce", "smal", "--published", "published.yaml"}, {"no experiment 'smal'", "did you mean small?"});
  bad({"reproduce", "small"}, {"configs/published.yaml", "no experiment 'small'", "mmc, neo, holistic"});
  bad({"reproduce", "small", "--published", "gone.yaml"}, {"gone.yaml"});
  std::vector<std::string> averaging = command;
  averaging.insert(averaging.end(), {"--averaging", "some"});
  bad(averaging, {"--averaging some", "arrived, all, steps"});
  for (const auto& [from, to, word] :
       std::vector<std::array<const char*, 3>>{{"time_to_goal]", "time_to_gaol]", "small.figures"},
                                               {"success_rate: 50", "success_rate: 150", "small.rows.success_rate"},
                                               {"problems: 100", "problems: 0", "small.rows.problems"},
                                               {"method: planner", "method: plain", "a row of this method already"},
                                               {"[[slow, plain]]", "[slow]", "expected [method, method]"},
                                               {"source: a paper", "sauce: a paper", "source"},
                                               {"suite: suite.yaml", "suite: gone.yaml", "gone.yaml"}}) {
    write("published.yaml", published_with(from, to));
    bad(command, {word});
  }
}

TEST_F(CliReproduce, MmcIsTheSameOnAnyThreads) {
  const std::string one = reproduce("mmc", {"-o", "one.db", "--trials", "6", "--threads", "1"}).out;
  EXPECT_EQ(reproduce("mmc", {"-o", "two.db", "--trials", "6", "--threads", "2"}).out, one);
  EXPECT_EQ(hash("one.db"), hash("two.db"));
  for (const char* word : {"panda", "ur5", "rrmc", "park", "baur", "mmc", "0.0693", "mmc - rrmc"})
    EXPECT_NE(one.find(word), std::string::npos) << word << "\n" << one;
}

TEST_F(CliReproduce, Holistic) {
  const std::string out = reproduce("holistic", {"-o", "a.db", "--trials", "3", "--threads", "2"}).out;
  for (const char* word : {"frankie", "frankie_omni", "holistic - separate"})
    EXPECT_NE(out.find(word), std::string::npos) << word << "\n" << out;
}

TEST_F(CliReproduce, Neo) {
  const ProcessResult there = moma({"robot", MOMA_SOURCE_DIR "/configs/robots/examples/pr2_right_arm.yaml"});
  if (there.code != 0) GTEST_SKIP() << "the package example-robot-data is missing: " << there.err;
  const std::string out = reproduce("neo", {"-o", "a.db", "--trials", "2", "--threads", "2"}).out;
  for (const char* word : {"pr2_right_arm", "neo", "trajopt", "74.2", "85.4", "moma"})
    EXPECT_NE(out.find(word), std::string::npos) << word << "\n" << out;
}

}  // namespace
}  // namespace moma::test
