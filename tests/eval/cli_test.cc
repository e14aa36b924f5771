#include "cli_fixture.h"

#include <fstream>
#include <nlohmann/json.hpp>

namespace moma::test {
namespace {

using nlohmann::json;

class Cli : public CliTest {};

TEST_F(Cli, EveryCommandHasHelpWithAnExample) {
  const ProcessResult help = good({"--help"});
  for (const std::string name : {"run", "query", "report", "replay", "verify", "compare", "merge", "world", "import",
                                 "robot", "solve", "check"}) {
    EXPECT_NE(help.out.find("\n  " + name), std::string::npos) << name;
    const ProcessResult one = good({name, "--help"});
    EXPECT_NE(one.out.find("Example"), std::string::npos) << name;
    EXPECT_NE(one.out.find("moma " + name), std::string::npos) << name;
  }
  EXPECT_EQ(good({"--version"}).out.rfind("moma ", 0), 0u);
  EXPECT_EQ(good({"-V"}).out, good({"--version"}).out);
  EXPECT_EQ(good({"help", "run"}).out, good({"run", "--help"}).out);
}

TEST_F(Cli, WrongWordsGetASuggestion) {
  bad({"rnu", "suite.yaml"}, {"unknown command 'rnu'", "did you mean run?"});
  bad({"frobnicate"}, {"unknown command 'frobnicate'", "the commands are init, run, "});
  bad({"run"}, {"SUITE", "moma run --help"});
  bad({"run", "suite.yaml", "--thread", "2"}, {"unknown option --thread", "did you mean --threads?"});
  bad({"run", "suite.yaml", "--threads", "none"}, {"--threads"});
  bad({"run", "suite.yaml", "--threads", "0"}, {"--threads"});
  bad({"run", "suite.yaml", "second"}, {"one argument too many: 'second'"});
  bad({"run", "suite.yaml", "--set", "nothing"}, {"--set nothing", "KEY=VALUE"});
  bad({"query", "a.db", "SELECT 1", "--format", "xml"}, {"--format"});
  bad({"\x1b[31mred"}, {"\\x1b[31mred"});
}

TEST_F(Cli, RunStoresResumesAndShows) {
  const ProcessResult first = good({"run", "suite.yaml", "-o", "a.db", "--threads", "2"});
  EXPECT_NE(first.out.find("success %"), std::string::npos) << first.out;
  EXPECT_NE(first.out.find("plain"), std::string::npos);
  EXPECT_NE(first.err.find("12 trials to do, on 2 threads"), std::string::npos) << first.err;
  const ProcessResult second = good({"run", "suite.yaml", "-o", "a.db"});
  EXPECT_NE(second.err.find("12 of 12 trials already there: nothing left to do"), std::string::npos) << second.err;
  EXPECT_EQ(second.out, first.out);
  const ProcessResult more = good({"run", "suite.yaml", "-o", "a.db", "--trials", "8"});
  EXPECT_NE(more.err.find("12 of 16 trials already there, 4 to do"), std::string::npos) << more.err;
  const ProcessResult quiet = good({"run", "suite.yaml", "-o", "b.db", "--quiet"});
  EXPECT_EQ(quiet.err, "");
  // The default place, and the same rows for another number of threads.
  good({"run", "suite.yaml", "--threads", "1", "-q"});
  EXPECT_EQ(hash("results/small.db"), hash("b.db"));
  EXPECT_NE(hash("a.db"), hash("b.db"));
}

TEST_F(Cli, SetIsCheckedLikeTheFile) {
  good({"check", "suite.yaml", "--set", "controller.k_epsilon=0.7", "--set", "trials=3"});
  EXPECT_NE(good({"check", "suite.yaml", "--trials", "3"}).out.find("6 trials = 3 worlds x 2 controllers"),
            std::string::npos);
  bad({"check", "suite.yaml", "--set", "simulation.mode=fast"}, {"simulation.mode", "kinematic"});
  bad({"check", "suite.yaml", "--set", "simulatoin.mode=kinematic"}, {"simulatoin", "simulation"});
  bad({"check", "suite.yaml", "--trials", "-3"}, {"trials"});
  bad({"check", "suite.yaml", "--seed", "many"}, {"seed"});
}

TEST_F(Cli, QueryFormats) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  EXPECT_EQ(good({"query", "a.db", "SELECT 1 AS one, 'a,b' AS two, NULL AS three", "--format", "csv"}).out,
            "one,two,three\n1,\"a,b\",\n");
  EXPECT_EQ(json::parse(good({"query", "a.db", "SELECT 0.1 + 0.2 AS x, 'ü' AS y, NULL AS z", "-f", "json"}).out),
            json::parse(R"([{"x": 0.30000000000000004, "y": "ü", "z": null}])"));
  EXPECT_EQ(good({"query", "a.db", "SELECT 1 AS n, 'a|b' AS t", "--format", "markdown"}).out,
            "|   n | t    |\n| --: | ---- |\n|   1 | a\\|b |\n");
  EXPECT_EQ(
      good({"query", "a.db", R"(SELECT 1 AS n, 'a_b & 5% \x {y} | z' AS "t [m]" UNION SELECT 2, '[')", "-f", "latex"})
          .out,
      R"(% Needs \usepackage{booktabs}.
\begin{tabular}{rl}
\toprule
n & t {[}m{]} \\
\midrule
1 & a\_b \& 5\% \textbackslash{}x \{y\} \textbar{} z \\
2 & {[} \\
\bottomrule
\end{tabular}
)");
  EXPECT_EQ(good({"query", "a.db", "SELECT 12 AS n, 'ü' AS t"}).out, " n  t\n--  -\n12  ü\n");
  for (const std::string name : {"@summary", "@list", "@failures", "@pairs", "@worst"}) {
    for (const std::string format : {"table", "csv", "json", "markdown", "latex"}) {
      EXPECT_NE(good({"query", "a.db", name, "--format", format}).out, "") << name;
    }
  }
  const json summary = json::parse(good({"query", "a.db", "@summary", "-f", "json"}).out);
  ASSERT_EQ(summary.size(), 2u);
  EXPECT_EQ(summary[0]["n"], 6);
  bad({"query", "a.db", "@sumary"}, {"unknown query @sumary", "@summary", "@worst"});
  bad({"query", "a.db", "SELECT outcme FROM v_trials"}, {"no such column: outcme"});
  bad({"query", "a.db", "DELETE FROM trial"}, {"reading only"});
  bad({"query", "missing.db", "@summary"}, {"missing.db", "no such file"});
}

TEST_F(Cli, StoredTextCannotActOnTheTerminal) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  const ProcessResult result =
      good({"query", "a.db", "SELECT char(27) || '[2J' || char(10) || char(8238) || x'ff' AS t"});
  EXPECT_EQ(result.out.find('\x1b'), std::string::npos);
  EXPECT_NE(result.out.find("\\x1b[2J\\n\\u202e"), std::string::npos) << result.out;
}

TEST_F(Cli, ReplayTellsWhatTheControllerRemembered) {
  write("memory.yaml", R"(name: memory
robot: robots/tiny.yaml
controllers: {away: {include: controllers/plain.yaml, escape: {patience: 0.1}}}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 2}
trials: 1
samples: all
)");
  good({"run", "memory.yaml", "-o", "m.db", "-q"});
  const std::string trial =
      json::parse(good({"query", "m.db", "SELECT trial FROM v_trials", "-f", "json"}).out)[0]["trial"];
  const json samples = json::parse(good({"replay", "m.db", trial, "--json"}).out)["samples"];
  const std::size_t k = samples.size() - 2;
  good({"replay", "m.db", trial, "--case", path("step.json").string(), "--step", std::to_string(k)});
  std::ifstream file(path("step.json"));
  EXPECT_EQ(samples[k]["escape"], json::parse(file)["state"]["escape"]) << "as a case of the same step has it";
  EXPECT_NE(samples[k]["escape"], samples[0]["escape"]) << "nothing was there to be remembered";
  // The step is solved from the store as from its case, and gives the command that was stored.
  const std::string solved = good({"solve", "m.db", trial, "--step", std::to_string(k)}).out;
  EXPECT_EQ(solved, good({"solve", "step.json"}).out);
  EXPECT_EQ(json::parse(solved)["qdot"], samples[k]["command"]);
  bad({"solve", "m.db", trial, "--step", "100000"}, {"no control step 100000", "it ends after"});
  bad({"solve", "m.db", "none"}, {"none"});
  bad({"solve", "step.json", "--step", "3"}, {"TRIAL"});
}

TEST_F(Cli, ReplayVerifyAndRerunNeedNothingButTheStore) {
  good({"run", "suite.yaml", "-o", "a.db", "-q", "--set", "samples=all"});
  const std::string before = hash("a.db");
  for (const char* gone : {"suite.yaml", "robots", "controllers"}) fs::remove_all(path(gone));
  const json trials =
      json::parse(good({"query", "a.db", "SELECT trial, outcome, steps FROM v_trials", "-f", "json"}).out);
  for (const json& trial : trials) {
    const ProcessResult check = good({"replay", "a.db", trial["trial"], "--check"});
    EXPECT_NE(check.err.find("bit for bit"), std::string::npos);
  }
  const json trace = json::parse(good({"replay", "a.db", trials[0]["trial"], "--json"}).out);
  for (const char* key : {"trial", "outcome", "robot", "success", "stuck", "infeasible", "controller", "world",
                          "simulation", "samples"}) {
    EXPECT_TRUE(trace.contains(key)) << key;
  }
  EXPECT_EQ(trace["outcome"], trials[0]["outcome"]);
  EXPECT_EQ(trace["samples"].size(), trials[0]["steps"]);
  for (const char* key : {"t", "base", "q", "qdot", "command", "error", "slack", "manipulability", "least_distance",
                          "status", "fallback", "active_rows", "escape"}) {
    EXPECT_TRUE(trace["samples"][0].contains(key)) << key;
  }
  for (const char* key : {"best", "idle", "stagnations", "side", "detour", "remaining", "target"}) {
    EXPECT_TRUE(trace["samples"][0]["escape"].contains(key)) << key << " of what the controller remembered";
  }
  EXPECT_TRUE(trace["robot"].contains("urdf_text"));
  EXPECT_NE(good({"verify", "a.db", "--fraction", "1"}).out.find("12 of 12 trials replayed: all the same"),
            std::string::npos);
  EXPECT_NE(good({"run", "a.db", "--rerun", "small"}).err.find("12 of 12 trials already there"), std::string::npos);
  good({"run", "a.db", "--rerun", "small", "-o", "b.db", "-q"});
  EXPECT_EQ(hash("b.db"), before);
  bad({"run", "a.db", "--rerun", "smal"}, {"no suite 'smal'", "small"});
  bad({"run", "a.db"}, {"is a store", "--rerun"});
  bad({"replay", "a.db", "zz"}, {"'zz' is no trial"});
  bad({"replay", "a.db", "0000000000"}, {"no trial that begins with 0000000000"});
}

TEST_F(Cli, VerifyAndReplayFindAChangedRow) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  const std::string trial =
      json::parse(good({"query", "a.db", "SELECT trial FROM v_trials LIMIT 1", "-f", "json"}).out)[0]["trial"];
  // moma itself cannot change a row.
  ASSERT_EQ(Process({"/usr/bin/sqlite3", path("a.db").string(),
                     "UPDATE trial SET path_ee_m = path_ee_m + 1e-12 WHERE trial = '" + trial + "'"},
                    folder_.root())
                .wait()
                .code,
            0);
  const ProcessResult replay = moma({"replay", "a.db", trial, "--check"});
  EXPECT_EQ(replay.code, 1);
  EXPECT_NE(replay.err.find("path_ee_m"), std::string::npos) << replay.err;
  const ProcessResult verify = moma({"verify", "a.db", "--fraction", "1", "-q"});
  EXPECT_EQ(verify.code, 1);
  EXPECT_NE(verify.err.find(trial), std::string::npos) << verify.err;
  EXPECT_NE(verify.out.find("1 findings"), std::string::npos) << verify.out;
}

TEST_F(Cli, ShardsMergeToTheWhole) {
  good({"run", "suite.yaml", "-o", "whole.db", "-q"});
  good({"run", "suite.yaml", "-o", "few.db", "-q", "--trials", "4"});
  good({"run", "suite.yaml", "-o", "other.db", "-q", "--seed", "2"});
  good({"merge", "all.db", "few.db", "whole.db"});
  EXPECT_EQ(hash("all.db"), hash("whole.db"));
  good({"merge", "all.db", "other.db"});
  const ProcessResult list = good({"query", "all.db", "@list"});
  EXPECT_NE(list.out.find("small@2"), std::string::npos) << list.out;
  EXPECT_NE(good({"verify", "all.db", "--fraction", "1"}).out.find("24 of 24"), std::string::npos);
  bad({"merge", "all.db", "suite.yaml"}, {"suite.yaml", "not an SQLite database"});
  bad({"merge", "all.db", "all.db"}, {"input and output"});
}

TEST_F(Cli, CompareAndReport) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  const ProcessResult compare = good({"compare", "a.db", "plain", "slow"});
  EXPECT_NE(compare.out.find("6 worlds that both met"), std::string::npos) << compare.out;
  EXPECT_NE(compare.out.find("McNemar"), std::string::npos);
  EXPECT_EQ(good({"compare", "a.db", "plain", "plain", "--fail-if-worse", "0"}).code, 0);
  bad({"compare", "a.db", "plain", "fast"}, {"no point 'fast'", "plain, slow"});
  good({"report", "a.db", "-o", "a.html"});
  EXPECT_GT(fs::file_size(path("a.html")), 1000u);
  EXPECT_FALSE(fs::exists(path("a.db-wal"))) << "a report leaves nothing beside the store";
  bad({"report", "suite.yaml", "-o", "b.html"}, {"suite.yaml"});
  bad({"report", "missing.db"}, {"missing.db"});
}

TEST_F(Cli, WorldPrintsWhatFrozenReads) {
  const ProcessResult printed = good({"world", "suite.yaml", "3", "--json"});
  const json world = json::parse(printed.out);
  EXPECT_EQ(world["index"], 3);
  EXPECT_EQ(printed.out.find('\n'), printed.out.size() - 1) << "one line, so that sets can be joined from it";
  EXPECT_NE(good({"world", "suite.yaml", "3"}).out.find("world 3 of family open"), std::string::npos);
  EXPECT_NE(good({"world", "suite.yaml", "3", "--seed", "9", "--json"}).out, printed.out);
  bad({"world", "suite.yaml", "-3"}, {"moma world --help"});
  bad({"world", "suite.yaml", "three"}, {"INDEX"});
}

// What another program's problems become is read as any frozen world is.
TEST_F(Cli, ImportWritesWhatFrozenReads) {
  write("own.yaml", R"(joints: [turn, bend, reach]
scenes:
  shelf:
    base: [0, 0, 0]
    boxes: {board: {size: [0.1, 0.1, 0.1], center: [2, 2, 1]}}
    configurations: [[0.1, 0.2, 0.05], [0.2, 0.4, 0.1]]
)");
  const ProcessResult imported = good({"import", "own.yaml", "--robot", "robots/tiny.yaml", "-o", "own.jsonl"});
  EXPECT_NE(imported.err.find("1 worlds: 1 shelf"), std::string::npos) << imported.err;
  const ProcessResult read =
      good({"world", "suite.yaml", "0", "--json", "--set", "worlds={frozen: own.jsonl}", "--set", "trials=1"});
  EXPECT_EQ(json::parse(read.out)["objects"][0]["name"], "board");
  EXPECT_EQ(read.out, good({"import", "own.yaml", "--robot", "robots/tiny.yaml"}).out);
  good({"import", "own.yaml", "--robot", "robots/tiny.yaml", "-o", "own.jsonl"});  // its own file
  write("mine.txt", "kept\n");
  bad({"import", "own.yaml", "--robot", "robots/tiny.yaml", "-o", "mine.txt"}, {"mine.txt", "--force"});
  bad({"import", "robots/tiny.yaml", "--robot", "robots/tiny.yaml"}, {"tiny.yaml:1:1", "planning scene"});
}

TEST_F(Cli, RobotShowsJointsAndShapes) {
  const ProcessResult text = good({"robot", "robots/tiny.yaml"});
  for (const char* word : {"turn", "bend", "reach", "capsule", "differential"}) {
    EXPECT_NE(text.out.find(word), std::string::npos) << word;
  }
  const json robot = json::parse(good({"robot", "robots/tiny.yaml", "--json"}).out);
  EXPECT_EQ(robot["joints"].size(), 3u);
  EXPECT_EQ(robot["joints"][0]["name"], "turn");
  EXPECT_EQ(robot["joints"][2]["upper"], 0.4);
}

// The controller's doubts are part of the explanation, and beside the JSON otherwise: told once either way.
TEST_F(Cli, SolveWarnsOnce) {
  const fs::path data = fs::path(MOMA_SOURCE_DIR) / "tests/data/qp_cases";
  std::ifstream file(data / "cases/frankie_119.json");
  json control_case = json::parse(file);
  control_case["robot"] = (data / "robots/frankie.yaml").string();
  control_case["controller"]["slack"]["weight"] = 0;
  write("case.json", control_case.dump());
  const std::string warning = "nothing pulls the arm to its goal";
  const auto count = [&](const std::string& text) {
    int n = 0;
    for (auto at = text.find(warning); at != std::string::npos; at = text.find(warning, at + 1)) ++n;
    return n;
  };
  const ProcessResult words = good({"solve", "case.json", "--explain"});
  EXPECT_EQ(count(words.out), 1) << words.out;
  EXPECT_EQ(count(words.err), 0) << words.err;
  const ProcessResult numbers = good({"solve", "case.json"});
  EXPECT_EQ(count(numbers.out), 0) << numbers.out;
  EXPECT_EQ(count(numbers.err), 1) << numbers.err;
}

}  // namespace
}  // namespace moma::test
