#include <random>

#include "cli_fixture.h"

namespace moma::test {
namespace {

using std::chrono::milliseconds;

// Enough work for several tenths of a second on two threads, so that signals come in the middle.
class CliInterrupt : public CliTest {
 protected:
  std::vector<std::string> run(const std::string& db) const {
    return command({"run", "suite.yaml", "-o", db, "--threads", "2", "--trials", "300"});
  }
  std::string undisturbed() const {
    EXPECT_EQ(Process(run("whole.db"), folder_.root()).wait().code, 0);
    return hash("whole.db");
  }
  /// Lets the program begin its work.
  void wait_for_rows(Process& process, const std::string& db) const {
    while (process.running() && !fs::exists(path(db + "-wal"))) std::this_thread::sleep_for(milliseconds(2));
    std::this_thread::sleep_for(milliseconds(60));
  }
};

TEST_F(CliInterrupt, CtrlCKeepsWhatIsDoneAndTheSameCommandGoesOn) {
  const std::string whole = undisturbed();
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string db = signal == SIGINT ? "int.db" : "term.db";
    Process process(run(db), folder_.root());
    wait_for_rows(process, db);
    process.kill(signal);
    const ProcessResult stopped = process.wait();
    if (stopped.code == 0) GTEST_SKIP() << "the machine was too quick to be interrupted";
    EXPECT_EQ(stopped.code, 3) << stopped.err;
    EXPECT_NE(stopped.err.find("of 600 trials are saved in " + db), std::string::npos) << stopped.err;
    EXPECT_NE(stopped.err.find("to go on: "), std::string::npos) << stopped.err;
    EXPECT_FALSE(fs::exists(path(db + "-wal"))) << "the store was not closed";
    EXPECT_NE(good({"query", db, "SELECT status FROM invocation"}).out.find("stopped"), std::string::npos);
    const ProcessResult on = Process(run(db), folder_.root()).wait();
    EXPECT_EQ(on.code, 0) << on.err;
    EXPECT_EQ(hash(db), whole);
  }
}

TEST_F(CliInterrupt, KilledAtAnyMomentNothingIsBroken) {
  const std::string whole = undisturbed();
  std::mt19937 random(7);
  const std::string db = "killed.db";
  for (int i = 0; i < 8; ++i) {
    Process process(run(db), folder_.root());
    std::this_thread::sleep_for(milliseconds(5 + random() % 150));
    process.kill(SIGKILL);
    process.wait();
    if (!fs::exists(path(db))) continue;
    const ProcessResult verify = moma({"verify", db, "--fraction", "0", "-q"});
    const bool nothing_yet = verify.err.find("empty database") != std::string::npos ||
                             verify.err.find("not an SQLite database") != std::string::npos;
    EXPECT_TRUE(verify.code == 0 || nothing_yet) << verify.out << verify.err;
  }
  const ProcessResult last = Process(run(db), folder_.root()).wait();
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_EQ(hash(db), whole);
}

}  // namespace
}  // namespace moma::test
