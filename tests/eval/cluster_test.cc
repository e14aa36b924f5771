// moma run under Open MPI: the same store as from one process, also when a rank is killed.
#include "eval/batch/cluster.h"
#include "cli_fixture.h"
#include "tests/support/mpi.h"

namespace moma::test {
namespace {

using std::chrono::milliseconds;

class ClusterRun : public CliTest {
 protected:
  void SetUp() override {
    if (!Cluster::built()) GTEST_SKIP() << "built without MPI (libopenmpi-dev)";
    if (find_mpirun() == nullptr) GTEST_SKIP() << "there is no mpirun (openmpi-bin)";
    CliTest::SetUp();
    prepare_mpirun();
  }

  std::vector<std::string> mpirun(const std::string& ranks, const std::vector<std::string>& arguments,
                                  bool recovery = false) const {
    std::vector<std::string> all{find_mpirun(), "-n", ranks};
    // mpirun ends with 0 then, whatever the ranks end with.
    if (recovery) all.insert(all.begin() + 1, "--enable-recovery");
    const std::vector<std::string> ours = command(arguments);
    all.insert(all.end(), ours.begin(), ours.end());
    return all;
  }
  ProcessResult run(const std::string& ranks, const std::vector<std::string>& arguments) const {
    return Process(mpirun(ranks, arguments), folder_.root()).wait();
  }
  std::string rows(const std::string& db) const {
    return good({"query", db, "SELECT rowid, world_index, json FROM world", "-f", "csv"}).out +
           good({"query", db, "SELECT * FROM point_trial", "-f", "csv"}).out;
  }
};

TEST_F(ClusterRun, TheStoreIsThatOfOneProcess) {
  good({"run", "suite.yaml", "-o", "one.db", "-q", "--threads", "1", "--trials", "12", "--set", "samples=all"});
  for (const std::string ranks : {"2", "3"}) {
    const std::string db = "ranks" + ranks + ".db";
    const ProcessResult result = run(ranks, {"run", "suite.yaml", "-o", db, "--trials", "12", "--set", "samples=all"});
    EXPECT_EQ(result.code, 0) << result.out << result.err;
    EXPECT_NE(result.err.find("on " + ranks + " ranks with 1 thread each"), std::string::npos) << result.err;
    EXPECT_NE(result.out.find("success %"), std::string::npos) << result.out;
    EXPECT_EQ(hash(db), hash("one.db"));
    EXPECT_EQ(rows(db), rows("one.db"));
    EXPECT_EQ(good({"query", db, "SELECT key, n, columns, data FROM samples ORDER BY key", "-f", "csv"}).out,
              good({"query", "one.db", "SELECT key, n, columns, data FROM samples ORDER BY key", "-f", "csv"}).out);
  }
  const ProcessResult again = run("2", {"run", "suite.yaml", "-o", "ranks2.db", "--trials", "12"});
  EXPECT_NE(again.err.find("24 of 24 trials already there"), std::string::npos) << again.err;
}

TEST_F(ClusterRun, UntilAndShardsToo) {
  const std::string rule = "trials={until: {half_width: 0.2, max: 100, block: 10}}";
  good({"run", "suite.yaml", "-o", "one.db", "-q", "--set", rule});
  const ProcessResult result = run("2", {"run", "suite.yaml", "-o", "two.db", "--set", rule});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(hash("two.db"), hash("one.db"));
  good({"run", "suite.yaml", "-o", "part.db", "-q", "--shard", "2/2"});
  EXPECT_EQ(run("2", {"run", "suite.yaml", "-o", "ranks.db", "-q", "--shard", "2/2"}).code, 0);
  EXPECT_EQ(hash("ranks.db"), hash("part.db"));
}

/// Moved worlds are handed out, too; the machines of other ranks find no file of the suite.
TEST_F(ClusterRun, RiskAndBreakToo) {
  const std::vector<std::string> changes{"--set", "worlds.families={clutter: {objects: 3}}",
                                         "--set", "disturbances={joints: {noise: 0.002}}",
                                         "--set", "samples=all"};
  for (const std::string what : {"risk", "break"}) {
    std::vector<std::string> arguments{what,           "suite.yaml", "--event",  "clearance_min_m<0.1",
                                       "--particles",  "10",         "--crude",  "30",
                                       "--replicates", "2",          "--levels", "4"};
    arguments.insert(arguments.end(), changes.begin(), changes.end());
    const auto into = [&](const std::string& db) {
      std::vector<std::string> all = arguments;
      all.insert(all.end(), {"-o", db});
      return all;
    };
    const ProcessResult one = good(into(what + "1.db"));
    const ProcessResult two = run("2", into(what + "2.db"));
    EXPECT_EQ(two.code, 0) << two.err;
    EXPECT_EQ(two.out, one.out);
    for (const std::string sql : {"SELECT risk FROM invocation", "SELECT * FROM trial ORDER BY key"})
      EXPECT_TRUE(good({"query", what + "2.db", sql, "-f", "csv"}).out ==
                  good({"query", what + "1.db", sql, "-f", "csv"}).out)
          << what << ": " << sql;
  }
}

TEST_F(ClusterRun, AKilledRanksWorkIsHandedOutAgain) {
  close_gate(0);
  open_gate();
  good({"run", "gated.yaml", "-o", "one.db", "-q"});
  close_gate(0);
  Process process(mpirun("3", {"run", "gated.yaml", "-o", "killed.db", "--lost-after", "1"}, true), folder_.root());
  pid_t victim = 0;
  while ((victim = find_rank(folder_.root(), "2")) == 0 && process.running())
    std::this_thread::sleep_for(milliseconds(5));
  ASSERT_TRUE(wait_at_gate(process, victim)) << process.wait().err;
  ::kill(victim, SIGKILL);
  open_gate();
  const ProcessResult result = process.wait();
  EXPECT_EQ(result.code, 0) << result.out << result.err;
  EXPECT_NE(result.err.find("rank 2: no word for 1 s; its "), std::string::npos) << result.err;
  EXPECT_EQ(hash("killed.db"), hash("one.db")) << result.err;
  EXPECT_NE(good({"query", "killed.db", "SELECT status FROM invocation"}).out.find("finished"), std::string::npos);
}

TEST_F(ClusterRun, BadInputIsSaidOnceAndEndsAllRanks) {
  const ProcessResult result = run("3", {"run", "missing.yaml", "-o", "a.db"});
  EXPECT_EQ(result.code, 2) << result.err;
  const std::size_t first = result.err.find("missing.yaml");
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("moma: ", result.err.find("moma: ") + 1), std::string::npos) << result.err;
}

}  // namespace
}  // namespace moma::test
