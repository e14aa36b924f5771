// Many trials by the real program: shards, sequential runs, two runs on one store, full disks, metrics of a suite.
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "cli_fixture.h"
#include "tests/support/small_disk.h"

namespace moma::test {
namespace {

using nlohmann::json;

class CliBatch : public CliTest {};

TEST_F(CliBatch, EverythingAtOnceIsTheSameOnAnyThreads) {
  // Every family, what moves in every way, three robots, both plants, disturbances: the 300 trials of mixed.yaml cut
  // down to one world of each family (two of the last) and the first 0.3 s of each trial, with all samples.
  const std::string suite = MOMA_SOURCE_DIR "/configs/suites/mixed.yaml";
  const std::vector<std::string> cut = {
      "run", suite, "-q", "--trials", "9", "--set", "simulation.time_limit=0.3", "--set", "samples=all"};
  const auto with = [&cut](std::vector<std::string> more) {
    more.insert(more.begin(), cut.begin(), cut.end());
    return more;
  };
  good(with({"-o", "one.db", "--threads", "1"}));
  good(with({"-o", "four.db", "--threads", "4"}));
  EXPECT_NE(hash("one.db"), "");
  EXPECT_EQ(hash("four.db"), hash("one.db"));
  const json rows = json::parse(
      good(
          {"query", "one.db",
           "SELECT count(*) AS n, count(DISTINCT family) AS families, count(DISTINCT robot) AS robots, "
           "count(DISTINCT mode) AS modes, count(DISTINCT controller) AS controllers, sum(outcome = 'error') AS errors "
           "FROM v_trials",
           "-f", "json"})
          .out)[0];
  EXPECT_EQ(rows["n"], 12 * 18);
  EXPECT_EQ(rows["families"], 8);
  EXPECT_EQ(rows["robots"], 3);
  EXPECT_EQ(rows["modes"], 2);
  EXPECT_EQ(rows["controllers"], 4);
  EXPECT_EQ(rows["errors"], 0);
}

TEST_F(CliBatch, CheckCountsWhyWorldsAreRejected) {
  const std::string text =
      good({"check", "suite.yaml", "--no-time", "--set", "worlds.families.open.tip_height=0.7"}).out;
  EXPECT_NE(text.find("tries each"), std::string::npos) << text;
  EXPECT_NE(text.find("goal: too low (tip_height)"), std::string::npos) << text;
  EXPECT_EQ(text.find("us each"), std::string::npos) << text;
  EXPECT_EQ(good({"check", "suite.yaml", "--no-time", "--set", "worlds.families.open.tip_height=0.7"}).out, text)
      << "the same every time";
  const std::string timed = good({"check", "suite.yaml", "--worlds", "3", "--seconds", "0.1"}).out;
  EXPECT_NE(timed.find("% of a trial"), std::string::npos) << timed;
  bad({"check", "suite.yaml", "--worlds", "0"}, {"--worlds"});
  // A family that has no world here: the others are still looked at, and it is a warning.
  const ProcessResult half = good({"check", "suite.yaml", "--no-time", "--set",
                                   "worlds.families={open: {}, moving: {tip_height: 9}}", "--set", "worlds.tries=5"});
  EXPECT_NE(half.err.find("worlds.families.moving"), std::string::npos) << half.err;
}

TEST_F(CliBatch, AProfileIsPrintedAndChangesNothing) {
  const ProcessResult plain = good({"run", "suite.yaml", "-o", "plain.db", "-q"});
  const ProcessResult told = good({"run", "suite.yaml", "-o", "told.db", "-q", "--profile"});
  EXPECT_EQ(hash("told.db"), hash("plain.db"));
  ASSERT_EQ(told.out.substr(0, plain.out.size()), plain.out) << "the same table first";
  const std::string table = told.out.substr(plain.out.size());
  for (const char* word : {"share %", "world", "solve", "ODE collide", "metrics", "store", "whole", "12 trials"})
    EXPECT_NE(table.find(word), std::string::npos) << word << table;
  EXPECT_EQ(table.find("ODE step"), std::string::npos) << "kinematic\n" << table;
  const ProcessResult again = good({"run", "suite.yaml", "-o", "told.db", "-q", "--profile"});
  EXPECT_NE(again.out.find("no trial was computed"), std::string::npos) << again.out;
}

TEST_F(CliBatch, ShardsMergedInAnyOrderAreOneRun) {
  good({"run", "suite.yaml", "-o", "whole.db", "-q", "--threads", "1", "--trials", "11"});
  const std::string whole = hash("whole.db");
  good({"run", "suite.yaml", "-o", "two.db", "-q", "--threads", "2", "--trials", "11"});
  good({"run", "suite.yaml", "-o", "four.db", "-q", "--threads", "4", "--trials", "11"});
  EXPECT_EQ(hash("two.db"), whole);
  EXPECT_EQ(hash("four.db"), whole);
  for (const std::string i : {"1", "2", "3"})
    good({"run", "suite.yaml", "-o", "s" + i + ".db", "-q", "--trials", "11", "--shard", i + "/3"});
  std::vector<std::vector<std::string>> orders = {{"s1.db", "s2.db", "s3.db"},
                                                  {"s3.db", "s1.db", "s2.db"},
                                                  {"s2.db", "s3.db", "s1.db"},
                                                  {"s3.db", "s2.db", "s1.db"}};
  const std::string summary = good({"query", "whole.db", "@summary"}).out;
  for (std::size_t k = 0; k < orders.size(); ++k) {
    const std::string out = "merged" + std::to_string(k) + ".db";
    orders[k].insert(orders[k].begin(), {"merge", out});
    good(orders[k]);
    EXPECT_EQ(hash(out), whole) << k;
    EXPECT_EQ(good({"query", out, "@summary"}).out, summary) << k;
  }
  // A merged store is a store like any other.
  EXPECT_NE(good({"run", "suite.yaml", "-o", "merged0.db", "--trials", "11"}).err.find("22 of 22 trials already there"),
            std::string::npos);
  const json counts = json::parse(
      good({"query", "s2.db", "SELECT count(*) AS n, min(world) AS first FROM v_trials", "-f", "json"}).out);
  EXPECT_EQ(counts[0]["n"], 2 * 4);
  EXPECT_EQ(counts[0]["first"], 1);
}

TEST_F(CliBatch, ShardsAreNamedAndChecked) {
  good({"run", "suite.yaml", "-q", "--shard", "2/3"});
  EXPECT_TRUE(fs::exists(path("results/small.shard-2-of-3.db")));
  for (const char* wrong : {"0/3", "4/3", "1", "1/", "/3", "a/b", "1/3x", "-1/3", "1/0"})
    bad({"run", "suite.yaml", "-o", "x.db", "--shard", wrong}, {"--shard", "I/N"});
  bad({"run", "suite.yaml", "-o", "x.db", "--shard", "1/2", "--set", "trials={until: {half_width: 0.1, max: 9}}"},
      {"--shard", "fixed number"});
}

TEST_F(CliBatch, UntilEndsByTheRowsAlone) {
  // Goals within such a distance are reached in some worlds, so that hits count.
  write("until.yaml", std::string(kSuite) + "success: {position: 0.6, orientation: 1.5}\n");
  const std::string rule = "trials={until: {metric: success, half_width: 0.15, max: 200, block: 10}}";
  const ProcessResult first = good({"run", "until.yaml", "-o", "a.db", "--threads", "1", "--set", rule});
  ASSERT_NE(first.err.find("reached after "), std::string::npos) << first.err;
  good({"run", "until.yaml", "-o", "b.db", "--threads", "4", "-q", "--set", rule});
  EXPECT_EQ(hash("a.db"), hash("b.db"));
  const json rates =
      json::parse(good({"query", "a.db", "SELECT avg(outcome = 'success') AS rate FROM v_trials", "-f", "json"}).out);
  EXPECT_GT(rates[0]["rate"], 0.2);
  EXPECT_LT(rates[0]["rate"], 0.8);
  // Some of it there already, and more of it: the rule ends where it did.
  good({"run", "until.yaml", "-o", "c.db", "-q", "--trials", "13"});
  good({"run", "until.yaml", "-o", "c.db", "-q", "--set", rule});
  EXPECT_EQ(hash("c.db"), hash("a.db"));
  const ProcessResult again = good({"run", "until.yaml", "-o", "a.db", "--set", rule});
  const std::string end = first.err.substr(first.err.find("reached after "), 18);
  EXPECT_NE(again.err.find(end), std::string::npos) << again.err;
  good({"run", "a.db", "--rerun", "small", "-o", "d.db", "-q"});
  EXPECT_EQ(hash("d.db"), hash("a.db"));
  const ProcessResult most =
      good({"run", "until.yaml", "-o", "e.db", "--set", "trials={until: {half_width: 0.001, max: 25, block: 10}}"});
  EXPECT_NE(most.err.find("NOT reached after 25 worlds: 50 trials"), std::string::npos) << most.err;
  bad({"check", "suite.yaml", "--set", "trials={until: {half_width: 0.1}}"}, {"trials.until", "max"});
  bad({"check", "suite.yaml", "--set", "trials={until: {max: 10}}"}, {"trials.until", "half_width"});
  bad({"check", "suite.yaml", "--set", "trials={until: {metric: speed, half_width: 0.1, max: 9}}"},
      {"trials.until.metric", "speed", "success"});
  EXPECT_NE(good({"check", "suite.yaml", "--set", rule}).out.find("at most 400 trials"), std::string::npos);
}

TEST_F(CliBatch, TwoRunsOnOneStoreComputeNothingTwice) {
  good({"run", "suite.yaml", "-o", "whole.db", "-q", "--trials", "60"});
  const fs::path other = path("second");
  fs::create_directories(other);
  Process first(command({"run", path("suite.yaml").string(), "-o", path("a.db").string(), "--trials", "60"}),
                folder_.root());
  Process second(command({"run", path("suite.yaml").string(), "-o", path("a.db").string(), "--trials", "60"}), other);
  const ProcessResult a = first.wait();
  const ProcessResult b = second.wait();
  EXPECT_EQ(a.code, 0) << a.err;
  EXPECT_EQ(b.code, 0) << b.err;
  const json done = json::parse(
      good({"query", "a.db", "SELECT sum(trials_done) AS done, count(*) AS runs FROM invocation", "-f", "json"}).out);
  EXPECT_EQ(done[0]["done"], 120);
  EXPECT_EQ(done[0]["runs"], 2);
  EXPECT_EQ(hash("a.db"), hash("whole.db"));
  EXPECT_FALSE(fs::exists(path("a.db-lock")));
}

TEST_F(CliBatch, AFullDiskStopsWithWhatIsSavedAndGoesOn) {
  const std::vector<std::string> run = {"run", "suite.yaml", "-q", "--trials", "150", "--set", "samples=all"};
  const SmallDisk disk(path("disk"), 1200);
  if (!disk.mounted()) GTEST_SKIP() << "mounting a small file system needs root: " << std::strerror(errno);
  std::vector<std::string> there = run;
  there.insert(there.end(), {"-o", "disk/a.db"});
  const ProcessResult full = moma(there);
  EXPECT_EQ(full.code, 3) << full.err;
  EXPECT_NE(full.err.find("disk is full"), std::string::npos) << full.err;
  EXPECT_NE(full.err.find("trials of this run are saved"), std::string::npos) << full.err;
  for (const std::string suffix : {"", "-wal"})
    if (fs::exists(path("disk/a.db" + suffix))) fs::copy_file(path("disk/a.db" + suffix), path("b.db" + suffix));
  std::vector<std::string> on = run;
  on.insert(on.end(), {"-o", "b.db"});
  good(on);
  on.back() = "whole.db";
  good(on);
  EXPECT_EQ(hash("b.db"), hash("whole.db"));
}

TEST_F(CliBatch, ALockedStoreStopsWithWhatIsSaved) {
  good({"run", "suite.yaml", "-o", "a.db", "-q", "--trials", "2"});
  if (!fs::exists("/usr/bin/sqlite3")) GTEST_SKIP() << "there is no sqlite3 to hold the lock";
  // Another program holds the store; moma waits ten seconds for it.
  Process holder(
      {"/usr/bin/sqlite3", path("a.db").string(), "BEGIN IMMEDIATE; SELECT 1;", ".shell sleep 14", "COMMIT;"},
      path("robots"));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const ProcessResult locked = moma({"run", "suite.yaml", "-o", "a.db", "-q", "--trials", "4"});
  EXPECT_EQ(locked.code, 3) << locked.err;
  EXPECT_NE(locked.err.find("locked by another program"), std::string::npos) << locked.err;
  holder.kill(SIGKILL);
  holder.wait();
  good({"run", "suite.yaml", "-o", "a.db", "-q", "--trials", "4"});
  good({"run", "suite.yaml", "-o", "b.db", "-q", "--trials", "4"});
  EXPECT_EQ(hash("a.db"), hash("b.db"));
}

TEST_F(CliBatch, NotesChangeNoTrial) {
  good({"run", "suite.yaml", "-o", "a.db", "-q"});
  const std::string before = hash("a.db");
  write("noted.yaml", std::string(kSuite) + "notes: |\n  # Why\n  One *more* look.\n");
  EXPECT_NE(good({"run", "noted.yaml", "-o", "a.db"}).err.find("12 of 12 trials already there"), std::string::npos);
  EXPECT_EQ(hash("a.db"), before);
  const json rows = json::parse(good({"query", "a.db",
                                      "SELECT (SELECT count(*) FROM point) AS points, (SELECT count(*) FROM suite) AS "
                                      "suites, (SELECT json_extract(u.resolved, '$.notes') FROM invocation AS i JOIN "
                                      "resolved_suite AS u ON u.id = i.resolved_suite_id ORDER BY i.id DESC LIMIT 1) "
                                      "AS notes",
                                      "-f", "json"})
                                    .out)[0];
  good({"run", "suite.yaml", "-o", "b.db", "-q"});
  EXPECT_EQ(rows["points"],
            json::parse(good({"query", "b.db", "SELECT count(*) AS n FROM point", "-f", "json"}).out)[0]["n"]);
  EXPECT_EQ(rows["suites"], 1);
  EXPECT_EQ(rows["notes"], "# Why\nOne *more* look.\n");
}

TEST_F(CliBatch, ASuitesOwnMetrics) {
  write("metrics.yaml", std::string(kSuite) +
                            "samples: none\nmetrics:\n  fastest: max(abs(command0))\n"
                            "  half_way_s: min(iif(base_x > 0.1, t, NULL))\n");
  good({"run", "metrics.yaml", "-o", "a.db", "-q", "--threads", "1"});
  good({"run", "metrics.yaml", "-o", "b.db", "-q", "--threads", "4"});
  EXPECT_EQ(hash("a.db"), hash("b.db"));
  // The same as over stored samples.
  good({"run", "suite.yaml", "-o", "c.db", "-q", "--set", "samples=all"});
  const json trials = json::parse(
      good({"query", "a.db", "SELECT trial, value FROM v_metrics WHERE metric = 'fastest'", "-f", "json"}).out);
  ASSERT_EQ(trials.size(), 12u);
  const std::string trial = trials[3]["trial"];
  const json found = json::parse(
      good({"query", "c.db", "SELECT max(abs(command0)) AS v FROM samples('" + trial + "')", "-f", "json"}).out);
  EXPECT_EQ(found[0]["v"], trials[3]["value"]);
  // A store without the values is completed; the rows stay.
  good({"run", "suite.yaml", "-o", "d.db", "-q"});
  good({"run", "metrics.yaml", "-o", "d.db", "-q"});
  EXPECT_EQ(hash("d.db"), hash("a.db"));
  EXPECT_NE(good({"run", "metrics.yaml", "-o", "d.db"}).err.find("12 of 12 trials already there"), std::string::npos);
  bad({"run", "metrics.yaml", "-o", "x.db", "--set", "metrics.fastest=max(speed)"},
      {"metrics.fastest", "no such column: speed"});
  bad({"run", "metrics.yaml", "-o", "x.db", "--set", "metrics.fastest=t"}, {"metrics.fastest", "aggregate"});
}

}  // namespace
}  // namespace moma::test
