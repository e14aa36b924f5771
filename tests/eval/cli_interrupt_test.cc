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
};

TEST_F(CliInterrupt, CtrlCKeepsWhatIsDoneAndTheSameCommandGoesOn) {
  const auto gated = [this](const std::string& db) {
    return command({"run", "gated.yaml", "-o", db, "--threads", "2"});
  };
  close_gate(0);
  open_gate();
  EXPECT_EQ(Process(gated("whole.db"), folder_.root()).wait().code, 0);
  const std::string whole = hash("whole.db");
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string db = signal == SIGINT ? "int.db" : "term.db";
    close_gate(40);
    Process process(gated(db), folder_.root());
    ASSERT_TRUE(wait_at_gate(process, process.pid())) << process.wait().err;
    process.kill(signal);
    open_gate();
    const ProcessResult stopped = process.wait();
    EXPECT_EQ(stopped.code, 3) << stopped.err;
    EXPECT_NE(stopped.err.find("of 300 trials are saved in " + db), std::string::npos) << stopped.err;
    EXPECT_EQ(stopped.err.find("stopped: 0 of"), std::string::npos) << stopped.err;
    EXPECT_NE(stopped.err.find("to go on: "), std::string::npos) << stopped.err;
    EXPECT_FALSE(fs::exists(path(db + "-wal"))) << "the store was not closed";
    EXPECT_NE(good({"query", db, "SELECT status FROM invocation"}).out.find("stopped"), std::string::npos);
    const ProcessResult on = Process(gated(db), folder_.root()).wait();
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

// A choice that is under way when the process dies is made anew, and comes out as it would have.
TEST_F(CliInterrupt, KilledWhileItLooksAheadGoesOnWithTheSameBits) {
  const std::string configs = MOMA_SOURCE_DIR "/configs/";
  write("looking.yaml", "name: looking\nrobot: " + configs + "robots/frankie.yaml\ncontrollers: {ahead: {include: " +
                            configs + "controllers/moma-ahead.yaml, plan: {budget: 300}}}\n" + R"(
worlds: {seed: 3, families: {clutter: {}}}
simulation: {mode: kinematic, time_limit: 6}
samples: all
trials: 24
)");
  const auto looking = [this](const std::string& db) {
    return command({"run", "looking.yaml", "-o", db, "--threads", "2"});
  };
  const auto samples = [this](const std::string& db) {
    return good({"query", db, "SELECT key, hex(data) FROM main.samples ORDER BY key", "-f", "csv"}).out;
  };
  const auto clock = std::chrono::steady_clock::now();
  EXPECT_EQ(Process(looking("whole.db"), folder_.root()).wait().code, 0);
  const auto whole_run = std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - clock);
  const std::string whole = hash("whole.db");
  const std::string whole_samples = samples("whole.db");
  ASSERT_GT(whole_samples.size(), 12u * 1000u);
  const std::string paths =
      "SELECT count(*) > 50 AS n FROM v_trials AS v JOIN samples(v.trial) AS s WHERE s.plan_mode = 1";
  EXPECT_EQ(good({"query", "whole.db", paths, "-f", "csv"}).out, "n\n1\n") << "paths are followed";
  const std::string db = "killed.db";
  for (const int share : {2, 3}) {
    Process process(looking(db), folder_.root());
    std::this_thread::sleep_for(whole_run / share);
    process.kill(SIGKILL);
    process.wait();
  }
  const ProcessResult last = Process(looking(db), folder_.root()).wait();
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_EQ(hash(db), whole);
  EXPECT_EQ(samples(db), whole_samples);
}

}  // namespace
}  // namespace moma::test
