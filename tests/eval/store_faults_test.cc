// Disks that fill up or break at any moment, memory that is short, and programs that are killed: each time a message
// and an exit code that say so, a store that is sound, and the same results once the program runs again.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>

#include "cli_fixture.h"
#include "eval/batch/cluster.h"
#include "eval/store/contents.h"
#include "eval/store/database.h"
#include "eval/store/reader.h"
#include "tests/support/mpi.h"
#include "tests/support/sanitized.h"

namespace moma::test {
namespace {

class CliFaults : public CliTest {
 protected:
  /// A suite of trials that take no time.
  static std::string quick(const std::string& name, const std::string& more) {
    return "name: " + name + R"(
robot: robots/tiny.yaml
controllers: {plain: controllers/plain.yaml}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 0.4}
success: {dwell: 0.1}
)" + more;
  }
  static constexpr const char* kTune = R"(trials: 2
samples: none
tune:
  controller: plain
  variables: {controller.k_epsilon: {range: [0.1, 5], scale: log, start: 1}, controller.lambda_q: {range: [0.001, 0.1], scale: log}}
  objective: {maximize: manip_mean}
  budget: {trials: 40}
  worlds: 2
  confirm: {candidates: 1, worlds: 1}
  sensitivity: none
  held_out: {count: 2}
  seed: 1
)";

  void SetUp() override {
#if MOMA_SANITIZED && !defined(__clang__)
    GTEST_SKIP() << "gcc's sanitizers are libraries that have to be the first ones; clang's are part of the program";
#endif
    CliTest::SetUp();
    write("tiny.yaml", quick("small", "trials: 3\nsamples: all\nmetrics: {fastest: \"max(abs(command0))\"}\n"));
    write("tune.yaml", quick("searched", kTune));
  }

  std::vector<std::string> failing(const std::string& call, long at, bool on,
                                   std::vector<std::string> arguments) const {
    std::vector<std::string> all{"/usr/bin/env",
                                 "LD_PRELOAD=" MOMA_BINARY_DIR "/tests/fail_nth.so",
                                 "MOMA_FAIL_CALL=" + call,
                                 fmt::format("MOMA_FAIL_AT={}", at),
                                 fmt::format("MOMA_FAIL_ON={}", on ? 1 : 0),
                                 "MOMA_FAIL_LOG=" + path(".calls").string()};
    for (std::string& word : command(std::move(arguments))) all.push_back(std::move(word));
    return all;
  }

  /// Sanitizers have memory of their own, which does not run out.
  static constexpr bool kMemoryFails = !MOMA_SANITIZED;

  long calls() const {
    std::ifstream log(path(".calls"));
    long n = 0;
    log >> n;
    return n;
  }

  /// Everything that can be said of a store without simulating.
  void expect_sound(const std::string& db, const std::string& what) const {
    const store::Reader reader(path(db));
    for (const std::string& problem : reader.integrity_problems()) ADD_FAILURE() << what << ": " << problem;
    store::check_contents(path(db), [&](const std::string& finding) { ADD_FAILURE() << what << ": " << finding; });
  }
  std::string result(const std::string& db) const { return store::Reader(path(db)).result_hash(); }

  void remove_store(const std::string& db) const {
    for (const char* suffix : {"", "-wal", "-shm", "-journal", "-lock", ".part", ".part-wal", ".part-shm", ".part-in"})
      fs::remove(path(db + suffix));
  }

  /// Which of `all` calls fail, each alone in turn (or, `on`, with all later ones): a number spread over them, the
  /// first and the last among them, those of the two ways between each other; with MOMA_FAULTS=all every one, but of
  /// more than a thousand a thousand.
  static std::vector<long> chosen(long all, bool on) {
    constexpr long kUsual = 16, kMost = 1000;
    const char* const wanted = std::getenv("MOMA_FAULTS");
    const long some = wanted != nullptr && std::string(wanted) == "all" ? kMost : kUsual;
    const bool every = all <= some;
    std::vector<long> calls;
    for (long i = 0; i < (every ? all : some); ++i)
      calls.push_back(every ? i + 1 : 1 + (2 * i + (on && i + 1 < some ? 1 : 0)) * (all - 1) / (2 * (some - 1)));
    return calls;
  }

  /// Commands that only look at tiny.yaml or a.db; a page is a.html.
  inline static const std::vector<std::vector<std::string>> kReaders = {
      {"check", "tiny.yaml"},
      {"query", "a.db", "@summary"},
      {"query", "a.db", "SELECT count(*), sum(s.t) FROM v_trials AS t, samples(t.trial) AS s"},
      {"report", "a.db", "-o", "a.html"},
      {"verify", "a.db"}};

  /// Lets call n of a kind fail, for the chosen n of those that a reader comes to: it is done all the same, and what it
  /// says is the same, or it ends with a message and its code.
  void fail_every_of_a_reader(const std::string& call, const std::vector<std::string>& arguments) {
    SCOPED_TRACE(call + " of " + arguments.front());
    const auto page = [&] { return fs::exists(path("a.html")) ? fs::file_size(path("a.html")) : 0; };
    fs::remove(path("a.html"));
    const ProcessResult whole = Process(failing(call, 0, false, arguments), folder_.root()).wait();
    ASSERT_EQ(whole.code, 0) << whole.err;
    const long all = calls();
    const std::uintmax_t whole_page = page();
    ASSERT_GT(all, 0) << "the shim saw no " << call;
    int refused = 0;
    for (const bool on : {false, true}) {
      for (const long n : chosen(all, on)) {
        const std::string what = fmt::format("{} of {}{}", n, all, on ? " and all later ones" : "");
        fs::remove(path("a.html"));
        const ProcessResult failed = Process(failing(call, n, on, arguments), folder_.root()).wait();
        EXPECT_EQ(failed.signal, 0) << what << ": " << failed.err;
        EXPECT_TRUE(failed.code == 0 || failed.code == 2)
            << what << ": " << failed.code << ": " << failed.err << failed.out;
        for (const char* bug : {"internal error", "terminate"})
          EXPECT_EQ(failed.err.find(bug), std::string::npos) << what << ": " << failed.err;
        if (failed.code != 0) {
          ++refused;
          EXPECT_NE(failed.err.find("moma: "), std::string::npos) << what << " said nothing: " << failed.err;
        } else if (arguments.front() == "query") {
          EXPECT_EQ(failed.out, whole.out) << what;
        }
        // Whole or not there; it may be there where only the word of it could not be said.
        EXPECT_TRUE(page() == whole_page || (failed.code != 0 && page() == 0)) << what << ": " << page();
        if (HasFailure()) return;
      }
    }
    EXPECT_GT(refused, 0) << "no failing " << call << " was ever told";
  }

  /// Lets call n of a kind fail, for the chosen n of those that `arguments` come to. `reset` makes the place as it was.
  void fail_every(const std::string& call, const std::vector<std::string>& arguments, const std::string& db,
                  const std::function<void()>& reset) {
    reset();
    ASSERT_EQ(Process(failing(call, 0, false, arguments), folder_.root()).wait().code, 0);
    const long all = calls();
    const std::string whole = result(db);
    ASSERT_GT(all, 0) << "the shim saw no " << call;
    int refused = 0;
    for (const bool on : {false, true}) {
      for (const long n : chosen(all, on)) {
        const std::string what = fmt::format("{} {} of {}{}", call, n, all, on ? " and all later ones" : "");
        reset();
        const ProcessResult failed = Process(failing(call, n, on, arguments), folder_.root()).wait();
        EXPECT_EQ(failed.signal, 0) << what << failed.err;
        EXPECT_TRUE(failed.code == 0 || failed.code == 2 || failed.code == 3)
            << what << ": " << failed.code << failed.err;
        for (const char* bug : {"internal error", "terminate"})
          EXPECT_EQ(failed.err.find(bug), std::string::npos) << what << ": " << failed.err;
        if (failed.code != 0) {
          ++refused;
          EXPECT_NE(failed.err.find("moma: "), std::string::npos) << what << " said nothing: " << failed.err;
        }
        if (store_there(db)) {
          expect_sound(db, what);
          if (failed.code == 0) {
            EXPECT_EQ(result(db), whole) << what << " lost something in silence";
          }
        } else {
          EXPECT_NE(failed.code, 0) << what;
        }
        const ProcessResult again = Process(command(arguments), folder_.root()).wait();
        ASSERT_EQ(again.code, 0) << what << ", then again: " << again.err;
        ASSERT_EQ(result(db), whole) << what;
        if (HasFailure()) return;
      }
    }
    EXPECT_GT(refused, 0) << "no failing " << call << " was ever told";
  }

  bool store_there(const std::string& db) const {
    try {
      const store::Reader reader(path(db));
      return true;
    } catch (const store::StoreError& error) {
      const std::string words = error.what();
      const bool nothing_yet = words.find("no such file") != std::string::npos ||
                               words.find("empty database") != std::string::npos ||
                               words.find("not an SQLite database") != std::string::npos;
      EXPECT_TRUE(nothing_yet) << words;
      return false;
    }
  }
};

TEST_F(CliFaults, EveryWriteOfARunMayFail) {
  fail_every("write", {"run", "tiny.yaml", "-o", "a.db", "-q", "--threads", "1"}, "a.db",
             [&] { remove_store("a.db"); });
}

TEST_F(CliFaults, EverySynchronisationOfARunMayFail) {
  fail_every("fsync", {"run", "tiny.yaml", "-o", "a.db", "-q", "--threads", "1"}, "a.db",
             [&] { remove_store("a.db"); });
}

TEST_F(CliFaults, EveryWriteSynchronisationAndRenamingOfAMergeMayFail) {
  good({"run", "tiny.yaml", "-o", "one.db", "-q", "--shard", "1/2"});
  good({"run", "tiny.yaml", "-o", "two.db", "-q", "--shard", "2/2"});
  const auto reset = [&] {
    remove_store("out.db");
    fs::copy_file(path("one.db"), path("out.db"));
  };
  for (const char* call : {"write", "fsync", "rename"}) {
    SCOPED_TRACE(call);
    fail_every(call, {"merge", "out.db", "two.db"}, "out.db", reset);
    EXPECT_FALSE(fs::exists(path("out.db.part")));
  }
}

// SQLite is tested so (https://sqlite.org/testing.html, 3.1).
TEST_F(CliFaults, EveryAllocationOfARunMayFail) {
  if (!kMemoryFails) GTEST_SKIP() << "a sanitizer owns malloc";
  fail_every("malloc", {"run", "tiny.yaml", "-o", "a.db", "-q", "--threads", "1"}, "a.db",
             [&] { remove_store("a.db"); });
}

TEST_F(CliFaults, EveryAllocationOfARunWithPhysicsMayFail) {
  if (!kMemoryFails) GTEST_SKIP() << "a sanitizer owns malloc";
  fail_every("malloc", {"run", "tiny.yaml", "-o", "a.db", "-q", "--threads", "1", "--set", "simulation.mode=dynamic"},
             "a.db", [&] { remove_store("a.db"); });
}

TEST_F(CliFaults, EveryAllocationOfReadersMayFail) {
  if (!kMemoryFails) GTEST_SKIP() << "a sanitizer owns malloc";
  good({"run", "tiny.yaml", "-o", "a.db", "-q"});
  for (const std::vector<std::string>& arguments : kReaders) fail_every_of_a_reader("malloc", arguments);
  expect_sound("a.db", "after all that");
}

TEST_F(CliFaults, EveryReadOfReadersMayFail) {
  good({"run", "tiny.yaml", "-o", "a.db", "-q"});
  for (const std::vector<std::string>& arguments : kReaders) fail_every_of_a_reader("read", arguments);
  expect_sound("a.db", "after all that");
}

TEST_F(CliFaults, AReportThatCannotBeWrittenLeavesTheOneThatIsThere) {
  good({"run", "tiny.yaml", "-o", "a.db", "-q"});
  write("a.html", "the one from before");
  for (const char* call : {"write", "fsync", "rename"}) {
    const ProcessResult failed =
        Process(failing(call, 1, true, {"report", "a.db", "-o", "a.html", "--force"}), folder_.root()).wait();
    EXPECT_EQ(failed.code, 2) << call << failed.err;
    // The reading connection writes, too: the index of SQLite's write-ahead log.
    EXPECT_TRUE(failed.err.find("a.html: cannot be written") != std::string::npos ||
                failed.err.find("a.db: cannot be read") != std::string::npos)
        << call << ": " << failed.err;
    EXPECT_EQ(fs::file_size(path("a.html")), std::string("the one from before").size()) << call;
    for (const auto& entry : fs::directory_iterator(folder_.root()))
      EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
  }
}

/// Something that is killed on its way to a store.
struct Work {
  std::string name;
  std::vector<std::string> command;
  std::string db;                        ///< what it writes
  std::function<void()> before = [] {};  ///< makes the place as it was
  bool ranks = false;                    ///< of mpirun: any of its processes may be the one that is killed
  std::string whole = {};                ///< what is there when nothing went wrong
  std::chrono::milliseconds took = {};
};

// MOMA_KILLS: how many; 20 where it is not set.
TEST_F(CliFaults, KilledAtAnyMomentNothingIsLost) {
  const char* const wanted = std::getenv("MOMA_KILLS");
  const int kills = wanted != nullptr ? std::atoi(wanted) : 20;
  good({"run", "tiny.yaml", "-o", "one.db", "-q", "--shard", "1/2", "--trials", "40"});
  good({"run", "tiny.yaml", "-o", "two.db", "-q", "--shard", "2/2", "--trials", "40"});
  good({"tune", "tune.yaml", "-o", "search.db", "-q", "--gains", "g.yaml"});
  std::vector<Work> works;
  works.push_back(
      {"run", command({"run", "tiny.yaml", "-o", "r.db", "-q", "--trials", "60", "--threads", "2"}), "r.db"});
  works.push_back(
      {"dynamic run",
       command({"run", "tiny.yaml", "-o", "d.db", "-q", "--trials", "20", "--set", "simulation.mode=dynamic"}),
       "d.db"});
  works.push_back({"merge", command({"merge", "m.db", "two.db", "search.db"}), "m.db",
                   [&] { fs::copy_file(path("one.db"), path("m.db")); }});
  works.push_back({"tune", command({"tune", "tune.yaml", "-o", "t.db", "-q", "--gains", "t.yaml"}), "t.db"});
  // A store of the first version, which the run brings up to date.
  works.push_back({"migration", command({"run", "tiny.yaml", "-o", "v.db", "-q", "--trials", "4"}), "v.db", [&] {
                     fs::copy_file(path("one.db"), path("v.db"));
                     SQLite::Database old(path("v.db").string(), SQLite::OPEN_READWRITE);
                     for (const char* view : {"v_trials", "v_summary", "v_pairs", "v_metrics", "v_metric_summary"})
                       old.exec(fmt::format("DROP VIEW {}", view));
                     old.exec("ALTER TABLE trial DROP COLUMN detector_deepest_m");
                   }});
  if (Cluster::built() && find_mpirun() != nullptr) {
    prepare_mpirun();
    std::vector<std::string> ranks = command({"run", "tiny.yaml", "-o", "p.db", "-q", "--trials", "200"});
    ranks.insert(ranks.begin(), {find_mpirun(), "-n", "3"});
    works.push_back({"run of three ranks", ranks, "p.db", [] {}, true});
  }
  for (Work& work : works) {
    remove_store(work.db);
    work.before();
    const auto begin = std::chrono::steady_clock::now();
    const ProcessResult done = Process(work.command, folder_.root()).wait();
    ASSERT_EQ(done.code, 0) << work.name << done.err;
    work.took = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
    work.whole = result(work.db);
  }
  std::mt19937 random(20240607);
  std::map<std::string, int> hit;
  for (int kill = 0; kill < kills; ++kill) {
    const Work& work = works[static_cast<std::size_t>(kill) % works.size()];
    remove_store(work.db);
    work.before();
    const auto after = std::chrono::milliseconds(random() % static_cast<unsigned>(work.took.count() + 1));
    std::string what = fmt::format("kill {}: {} after {} of {} ms", kill, work.name, after.count(), work.took.count());
    Process process(work.command, folder_.root());
    std::this_thread::sleep_for(after);
    // mpirun itself, the rank that writes, or one that computes.
    const unsigned whom = work.ranks ? random() % 3 : 0;
    const pid_t rank = whom == 0 ? 0 : find_rank(folder_.root(), std::to_string(whom - 1));
    if (rank != 0) what += fmt::format(", its rank {}", whom - 1);
    hit[work.name] += process.running() ? 1 : 0;
    if (rank != 0) {
      ::kill(rank, SIGKILL);
    } else {
      process.kill(SIGKILL);
    }
    process.wait();
    if (work.name != "migration" && !work.ranks && store_there(work.db)) {
      expect_sound(work.db, what);
    }
    const ProcessResult again = Process(work.command, folder_.root()).wait();
    ASSERT_EQ(again.code, 0) << what << again.err;
    expect_sound(work.db, what);
    ASSERT_EQ(result(work.db), work.whole) << what;
    const std::string running = "SELECT count(*) FROM invocation WHERE status = 'running'";
    if (work.name != "merge") {
      EXPECT_EQ(store::ReadConnection(path(work.db)).db().execAndGet(running).getInt(), 0) << what;
    }
  }
  int all = 0;
  for (const auto& [name, count] : hit) {
    std::printf("%s: %d of its kills came before its end\n", name.c_str(), count);
    all += count;
  }
  EXPECT_GT(all, kills / 4) << "most were done before they were killed";
}

TEST_F(CliFaults, AReadOnlyPlaceIsSaid) {
  if (geteuid() == 0) {  // who may write everywhere, but for this
    starter_ = {"/usr/bin/setpriv", "--bounding-set=-dac_override,-dac_read_search"};
    if (moma({"--version"}).code != 0) GTEST_SKIP() << "root may write everywhere, and cannot do without here";
  }
  good({"run", "tiny.yaml", "-o", "a.db", "-q"});
  fs::create_directory(path("closed"));
  fs::permissions(path("closed"), fs::perms::owner_read | fs::perms::owner_exec);
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"run", "tiny.yaml", "-o", "closed/a.db"},
                                                    {"merge", "closed/a.db", "a.db"},
                                                    {"report", "a.db", "-o", "closed/a.html"},
                                                    {"tune", "tune.yaml", "-o", "t.db", "--gains", "closed/g.yaml"}})
    bad(arguments, {"closed", "cannot"});
  fs::permissions(path("closed"), fs::perms::owner_all);
}

}  // namespace
}  // namespace moma::test
