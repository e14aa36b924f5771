// Looking closer at a store by the real program: the best point, differences of settings, sorted summaries, metrics of
// a suite's own, trials that ended by an error.
#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "cli_fixture.h"

namespace moma::test {
namespace {

using json = nlohmann::json;

class CliLook : public CliTest {
 protected:
  /// Three points of a sweep in six worlds, with outcomes as if: the first succeeds in four and collides in two; the
  /// second succeeds in four and runs out of time in two; the third succeeds in three and ends by an error in three.
  void make_sweep() const {
    write("sweep.yaml", R"(name: sweep
robot: robots/tiny.yaml
controllers: {mine: controllers/plain.yaml}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 4}
sweep: {design: grid, axes: {controller.k_epsilon: [0.1, 0.2, 0.3]}}
metrics: {latest: max(t)}
trials: 6
)");
    good({"run", "sweep.yaml", "-o", "a.db", "-q"});
    set_outcome("", 0, "success");
    for (const auto& [label, from, outcome] :
         {std::tuple{"k_epsilon=0.1", 4, "collision"}, {"k_epsilon=0.2", 4, "timeout"}, {"k_epsilon=0.3", 3, "error"}})
      set_outcome(label, from, outcome);
  }

  /// Of the worlds from `from` on.
  void set_outcome(const std::string& label, int from, const std::string& outcome) const {
    SQLite::Database db(path("a.db").string(), SQLite::OPEN_READWRITE);
    for (const std::string table : {"trial", "point_trial"}) {
      SQLite::Statement change(
          db, "UPDATE " + table +
                  " SET outcome = ?, time_to_goal_s = NULL WHERE key IN (SELECT m.key "
                  "FROM point_trial AS m JOIN point AS p ON p.id = m.point_id WHERE p.label LIKE ? AND "
                  "m.world_index >= ?)");
      change.bind(1, outcome);
      change.bind(2, "%" + label);
      change.bind(3, from);
      change.exec();
    }
  }

  json rows(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"-f", "json"});
    return json::parse(good(arguments).out);
  }
};

TEST_F(CliLook, TheBestPointIsFoundByTheStatedCriterion) {
  make_sweep();
  json best = rows({"query", "a.db", "@best"});
  ASSERT_EQ(best.size(), 1u);
  EXPECT_NE(best[0]["by"].get<std::string>().find("success 66.7 %, collision 0.0 % of 6"), std::string::npos) << best;
  best = rows({"query", "a.db", "mine@best"});
  EXPECT_TRUE(best[0]["point"].get<std::string>().ends_with("k_epsilon=0.2")) << "fewer collisions decide: " << best;
  bad({"query", "a.db", "theirs@best"}, {"no point 'theirs@best'", "k_epsilon=0.1"});

  const std::string second = best[0]["controller"].get<std::string>() + ":" + best[0]["point"].get<std::string>();
  const std::string first = second.substr(0, second.size() - 3) + "0.1";
  const std::string compared = good({"compare", "a.db", first, "@best"}).out;
  EXPECT_NE(compared.find("B = " + second + " (best by success 66.7 %"), std::string::npos) << compared;
  // Its trials are named by their worlds, the worst of them by the point alone.
  EXPECT_NE(good({"replay", "a.db", "@best/2"}).out.find("world 2\n"), std::string::npos);
  EXPECT_NE(good({"replay", "a.db", second + "/1"}).out.find("world 1\n"), std::string::npos);
  const std::string worst = good({"replay", "a.db", "@best"}).out;
  EXPECT_TRUE(worst.find("world 4\n") != std::string::npos || worst.find("world 5\n") != std::string::npos) << worst;
  bad({"replay", "a.db", "@best/77"}, {"has no trial in world 77"});
  bad({"replay", "a.db", "theirs@best"}, {"no point 'theirs@best'"});
  EXPECT_NE(moma({"verify", "a.db", "--fraction", "1", "--point", "@best"}).out.find("6 of 18 trials replayed"),
            std::string::npos);
  bad({"verify", "a.db", "--point", "theirs"}, {"no point 'theirs'"});
}

TEST_F(CliLook, ErrorsAreSaidBesideTheRates) {
  make_sweep();
  const std::string table = good({"query", "a.db", "@summary"}).out;
  EXPECT_NE(table.find("n  errors  success"), std::string::npos) << table;
  EXPECT_NE(table.find("without errors %"), std::string::npos) << table;
  EXPECT_NE(table.find("6       3   50.0"), std::string::npos) << table;
  const json points = rows({"query", "a.db", "@summary"});
  const auto name = [&](std::size_t i) { return "mine:" + points[i]["point"].get<std::string>(); };
  const std::string compared = good({"compare", "a.db", name(0), name(2)}).out;
  EXPECT_NE(compared.find("In 3 of these worlds a trial ended by an error (A 0, B 3), which is no success"),
            std::string::npos)
      << compared;
  const json data = json::parse(good({"compare", "a.db", name(0), name(2), "--json"}).out);
  EXPECT_EQ(data["n"], 6);
  EXPECT_EQ(data["errors_b"], 3);
  EXPECT_EQ(data["rates"][0]["b"], 0.5) << data;
  EXPECT_EQ(data["rates"][2]["rate"], "success without errors");
  EXPECT_EQ(data["rates"][2]["n"], 3);
  EXPECT_EQ(data["rates"][2]["b"], 1.0) << data;
  EXPECT_EQ(moma({"compare", "a.db", name(0), name(2), "--fail-if-worse", "0"}).code, 1) << "leaving is losing";
  for (const json& pair : rows({"query", "a.db", "@pairs"})) EXPECT_EQ(pair["n"], 6) << pair;
  set_outcome("k_epsilon=0.3", 0, "error");
  EXPECT_NE(good({"query", "a.db", "@summary", "-f", "csv"}).out.find(",kinematic,6,6,0,0,"), std::string::npos);
  // Without errors there is no column of them.
  good({"run", "suite.yaml", "-o", "b.db", "-q"});
  EXPECT_EQ(good({"query", "b.db", "@summary"}).out.find("errors"), std::string::npos);
}

// A median of the successes in a summary, a mean of worlds in a comparison: the heads say which.
TEST_F(CliLook, TimesToTheGoalAreCalledMedianOrMean) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  const std::string summary = good({"query", "a.db", "@summary"}).out;
  for (const char* head : {"  median time to goal s", "  mean manip."})
    EXPECT_NE(summary.find(head), std::string::npos) << head << "\n" << summary;
  const std::string compared = good({"compare", "a.db", "plain", "slow"}).out;
  const std::string heads = compared.substr(compared.find("metric (both have it)"));
  for (const char* word : {"mean A", "mean B", "manip_mean"})
    EXPECT_NE(heads.find(word), std::string::npos) << word << "\n" << compared;
}

TEST_F(CliLook, NotesStandOnEveryPage) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  write("why.md", "Seen *twice*.");
  const std::string noted = R"("notes":"Seen *twice*.")";
  const auto text = [&](const char* name) {
    std::ifstream in(path(name));
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  good({"report", "a.db", "-o", "b.html", "--notes", "why.md"});
  EXPECT_NE(text("b.html").find(noted), std::string::npos);
  starter_ = {"/usr/bin/env", "BROWSER=true"};
  good({"open", "a.db", "--notes", "why.md"});
  EXPECT_NE(text("a.html").find(noted), std::string::npos);
  starter_ = {};
  for (const char* command : {"report", "open", "view"})
    bad({command, "a.db", "--notes", "missing.md"}, {"--notes missing.md", "Markdown"});

  Process server(command({"view", "a.db", "--port", "0", "--notes", "why.md"}), folder_.root());
  while (text(".stdout").find('\n') == std::string::npos && server.running())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const std::string address = text(".stdout").substr(0, text(".stdout").find('\n'));
  fs::create_directory(path("client"));
  const std::string served =
      Process({"/usr/bin/env", "python3", "-c",
               "import sys, urllib.request as r; print(r.urlopen(sys.argv[1]).read().decode())", address + "data.json"},
              path("client"))
          .wait()
          .out;
  EXPECT_NE(served.find(noted), std::string::npos) << served.substr(0, 500);
  server.kill(SIGINT);
  EXPECT_EQ(server.wait().code, 0);
}

TEST_F(CliLook, ControllersAreComparedUnderEqualConditions) {
  write("conditions.yaml", R"(name: conditions
robot: robots/tiny.yaml
controllers: {mine: controllers/plain.yaml, theirs: controllers/plain.yaml}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 4}
sweep: {points: [{disturbances: none}, {disturbances: {joints: {noise: 0.001}}}]}
trials: 6
)");
  good({"run", "conditions.yaml", "-o", "a.db", "-q"});
  set_outcome("", 0, "success");
  SQLite::Database(path("a.db").string(), SQLite::OPEN_READWRITE)
      .exec(
          "UPDATE trial SET outcome = 'timeout' WHERE key IN (SELECT m.key FROM point_trial AS m JOIN point AS p ON "
          "p.id = m.point_id WHERE p.controller = 'mine' AND p.label <> 'disturbances=none')");
  const json both = json::parse(good({"compare", "a.db", "mine", "theirs", "--json"}).out);
  EXPECT_EQ(both["n"], 12);
  ASSERT_EQ(both["pairs"].size(), 2u) << both;
  for (const json& pair : both["pairs"])
    EXPECT_EQ(pair["a"].get<std::string>().substr(4), pair["b"].get<std::string>().substr(6));
  EXPECT_EQ(both["rates"][0]["a"], 0.5) << both;
  const std::string table = good({"compare", "a.db", "mine", "theirs"}).out;
  EXPECT_NE(table.find("\n  mine:"), std::string::npos) << table;
  EXPECT_EQ(table.find("\\n"), std::string::npos) << "line ends in words: " << table;
  const std::string one = both["pairs"][0]["a"].get<std::string>(), other = both["pairs"][1]["b"].get<std::string>();
  EXPECT_EQ(json::parse(good({"compare", "a.db", one, "theirs", "--json"}).out)["n"], 6) << "its condition alone";
  const std::string crossed = good({"compare", "a.db", one, other}).out;
  EXPECT_NE(crossed.find("not under the same conditions"), std::string::npos) << crossed;
  EXPECT_EQ(good({"compare", "a.db", "mine", "theirs"}).out.find("not under the same"), std::string::npos);
  // Points that differ in gains are candidates: one has to be chosen.
  fs::remove(path("a.db"));
  make_sweep();
  bad({"compare", "a.db", "mine", "@best"},
      {"several points of mine under the same conditions", "k_epsilon=0.1", "mine@best"});
}

TEST_F(CliLook, RobotsAreAColumnWhereThereAreSeveral) {
  write("robots.yaml", R"(name: robots
robot: robots/tiny.yaml
controllers: {plain: controllers/plain.yaml}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 4}
sweep: {design: grid, axes: {robot: [robots/tiny.yaml, robots/other.yaml]}}
trials: 2
)");
  write("robots/other.yaml", "include: tiny.yaml\nname: other\n");
  const std::string table = good({"run", "robots.yaml", "-o", "a.db", "-q"}).out;
  EXPECT_NE(table.find("robot"), std::string::npos) << table;
  EXPECT_NE(table.find("robots  other  plain"), std::string::npos) << table;
  const std::string one = good({"run", "suite.yaml", "-o", "b.db", "-q"}).out;
  EXPECT_EQ(one.find("robot"), std::string::npos) << one;
}

TEST_F(CliLook, MetricsOfASuiteAreWhereMomasAre) {
  make_sweep();
  EXPECT_NE(good({"query", "a.db", "@summary"}).out.find("latest"), std::string::npos);
  const json points = rows({"query", "a.db", "@summary"});
  const json mean = rows({"query", "a.db",
                          "SELECT avg(value) AS mean FROM v_metrics WHERE outcome <> 'error' AND point = '" +
                              points[2]["point"].get<std::string>() + "'"});
  EXPECT_DOUBLE_EQ(points[2]["latest"].get<double>(), mean[0]["mean"].get<double>());
  const std::string compared = good({"compare", "a.db", "mine:" + points[0]["point"].get<std::string>(),
                                     "mine:" + points[1]["point"].get<std::string>()})
                                   .out;
  EXPECT_NE(compared.find("\nlatest "), std::string::npos) << compared;
  const std::string summary = good({"query", "a.db", "@summary", "-f", "csv"}).out;
  EXPECT_TRUE(summary.substr(0, summary.find('\n')).ends_with(",latest")) << summary;
  good({"report", "a.db", "-o", "a.html"});
  const std::string tex = good({"query", "a.db", "@summary", "-f", "latex"}).out;
  EXPECT_NE(tex.find("& mean change & latest \\\\\n"), std::string::npos) << tex;
  std::ifstream page(path("a.html"));
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  EXPECT_NE(text.find("\"key\":\"latest\""), std::string::npos);
}

}  // namespace
}  // namespace moma::test
