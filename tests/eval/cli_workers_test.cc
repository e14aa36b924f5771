#include <SQLiteCpp/SQLiteCpp.h>

#include <fstream>

#include "cli_fixture.h"

// Controllers in processes of their own: what a busy machine does to them is no result, and none of them outlives moma.
namespace moma::test {
namespace {

class CliWorkers : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    fs::copy_file(MOMA_BINARY_DIR "/tests/processes/odd_process", path("odd"));
  }
  void write_suite(const std::string& deed, const std::string& limits, int trials) const {
    write("foreign.yaml",
          "name: foreign\nrobot: robots/tiny.yaml\n"
          "controllers: {plain: controllers/plain.yaml, odd: {method: process, command: [./odd, " +
              deed + "]" + limits +
              "}}\n"
              "worlds: {seed: 1, families: {open: {}}}\nsimulation: {mode: kinematic, time_limit: 1}\ntrials: " +
              std::to_string(trials) + "\n");
  }
  std::string answer(const std::string& db, const std::string& sql) const {
    std::string text = good({"query", db, sql, "-f", "csv"}).out;
    text.erase(0, text.find('\n') + 1);
    return text.substr(0, text.find('\n'));
  }
  /// The process numbers that the children of `odd leave` wrote.
  std::vector<pid_t> left() const {
    std::vector<pid_t> pids;
    for (const auto& entry : fs::directory_iterator(folder_.root()))
      if (entry.path().stem() == "left") pids.push_back(std::stoi(entry.path().extension().string().substr(1)));
    return pids;
  }
  /// False where one of them still is after a time that no machine needs.
  static bool all_end(const std::vector<pid_t>& pids) {
    for (int tries = 0; tries < 3000; ++tries) {
      bool any = false;
      for (const pid_t pid : pids) {
        std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
        std::string line;
        any = any || (std::getline(stat, line) && line.find(") Z") == std::string::npos);
      }
      if (!any) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
};

TEST_F(CliWorkers, WhatABusyMachineDidIsNoResult) {
  write_suite("slow", ", start: 4", 2);
  good({"run", "foreign.yaml", "-o", "whole.db", "-q"});
  const std::string whole = hash("whole.db");
  write("busy", "");  // its resets take without end
  const ProcessResult late = moma({"run", "foreign.yaml", "-o", "a.db", "--threads", "2", "-q"});
  EXPECT_EQ(late.code, 3) << late.err;
  EXPECT_NE(late.err.find("real time ran out in 2 trials"), std::string::npos) << late.err;
  EXPECT_NE(late.err.find("gave no answer to a reset within 4 s"), std::string::npos) << late.err;
  EXPECT_EQ(answer("a.db", "SELECT count(*), sum(outcome = 'error') FROM trial"), "2,0");
  EXPECT_EQ(answer("a.db", "SELECT status FROM invocation"), "stopped");
  fs::remove(path("busy"));
  good({"merge", "m.db", "a.db", "whole.db"});
  EXPECT_EQ(hash("m.db"), whole);
  good({"run", "foreign.yaml", "-o", "a.db", "-q"});
  EXPECT_EQ(hash("a.db"), whole);
}

// Stores of earlier versions hold such errors as results.
TEST_F(CliWorkers, StoredErrorsOfABusyMachineAreTriedAgain) {
  write_suite("slow", "", 2);
  good({"run", "foreign.yaml", "-o", "whole.db", "-q"});
  const std::string whole = hash("whole.db");
  fs::copy_file(path("whole.db"), path("old.db"));
  {
    SQLite::Database db(path("old.db").string(), SQLite::OPEN_READWRITE);
    const std::string of =
        " WHERE key IN (SELECT key FROM point_trial AS m JOIN point AS p ON p.id = m.point_id WHERE controller = "
        "'odd')";
    db.exec(
        "UPDATE trial SET outcome = 'error', reason = 'the plugin does not start: its process gave no answer to a "
        "reset within 60 s "
        "and was killed'" +
        of);
    db.exec("UPDATE point_trial SET outcome = 'error'" + of);
  }
  fs::copy_file(path("old.db"), path("again.db"));
  for (const auto& [out, first, second] :
       std::vector<std::array<std::string, 3>>{{"m.db", "old.db", "whole.db"}, {"n.db", "whole.db", "old.db"}}) {
    const ProcessResult merged = good({"merge", out, first, second});
    EXPECT_EQ(hash(out), whole) << merged.err;
    EXPECT_EQ(answer(out, "SELECT count(*), sum(outcome = 'error') FROM point_trial"), "4,0");
  }
  EXPECT_NE(hash("again.db"), whole);
  good({"run", "foreign.yaml", "-o", "again.db", "-q"});
  EXPECT_EQ(hash("again.db"), whole);
  EXPECT_EQ(answer("again.db", "SELECT count(*), sum(outcome = 'error') FROM point_trial"), "4,0");
}

TEST_F(CliWorkers, NothingOfThemIsLeftAfterwards) {
  write_suite("leave", "", 1);
  good({"run", "foreign.yaml", "-o", "a.db", "-q"});
  EXPECT_GE(left().size(), 2u);
  EXPECT_TRUE(all_end(left()));
}

TEST_F(CliWorkers, NothingOfThemOutlivesAKill) {
  write_suite("leave_and_hang", "", 1);
  Process process(command({"run", "foreign.yaml", "-o", "a.db", "-q"}), folder_.root());
  while (!fs::exists(path("hangs"))) {
    ASSERT_TRUE(process.running()) << process.wait().err;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  process.kill(SIGKILL);
  process.wait();
  EXPECT_GE(left().size(), 3u) << "itself, its child, and one that left the group";
  EXPECT_TRUE(all_end(left()));
}

TEST_F(CliWorkers, StartNoWorkersOfTheirOwn) {
  write_suite("fast", "", 1);
  starter_ = {"/usr/bin/env", "MOMA_WORKER=1"};
  bad({"run", "foreign.yaml", "-o", "a.db"}, {"starts controllers in turn", "__main__"});
}

}  // namespace
}  // namespace moma::test
