// Stores from strangers, and what the program owes to its own: what was changed is found, what is not looked at is
// said, code is not run because a store names it, nothing takes all memory or for ever, and other people's files stay.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zstd.h>

#include "cli_fixture.h"
#include "eval/store/columns.h"
#include "tests/support/sanitized.h"

namespace moma::test {
namespace {

#if MOMA_SANITIZED
const std::string kLimit;  // sanitizers map terabytes
#else
const std::string kLimit = "ulimit -v 4194304; ";  // KiB: four times what the program maps
#endif

class CliTrust : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write("suite.yaml", std::string(kSuite) + "samples: all\nmetrics: {top: max(abs(command0))}\n");
    write("short.yaml", std::string(kSuite) + "samples: all\n");
  }

  /// Changes a store as moma itself never would.
  void change(const std::string& db, const std::vector<std::string>& sql) const {
    SQLite::Database store(path(db).string(), SQLite::OPEN_READWRITE);
    store.exec("PRAGMA ignore_check_constraints = ON; PRAGMA foreign_keys = OFF");
    for (const std::string& statement : sql) store.exec(statement);
  }
  void copy(const std::string& from, const std::string& to) const {
    fs::copy_file(path(from), path(to), fs::copy_options::overwrite_existing);
  }
  std::string text(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  ProcessResult shell(const std::string& script) const {
    return Process({"/bin/sh", "-c", script, "sh", MOMA_BINARY_DIR "/moma"}, folder_.root()).wait();
  }
};

TEST_F(CliTrust, VerifyComparesEveryCopyHashSampleAndMetric) {
  good({"run", "suite.yaml", "-o", "whole.db", "-q", "--trials", "3"});
  const ProcessResult sound = good({"verify", "whole.db", "--fraction", "1"});
  EXPECT_NE(sound.out.find("6 of 6 trials replayed: all the same"), std::string::npos) << sound.out;
  EXPECT_NE(sound.out.find("not checked: how long trials took"), std::string::npos) << sound.out;
  EXPECT_EQ(sound.out.find("not checked: values of"), std::string::npos) << sound.out;
  const std::string one = " WHERE key = (SELECT min(key) FROM trial)";
  struct Tampering {
    std::string sql, told;
    std::string fraction = "0";
  };
  std::vector<Tampering> all = {
      {"UPDATE point_trial SET outcome = 'success'", "differs in: outcome"},
      {"UPDATE point_trial SET time_to_goal_s = 0.5" + one, "time_to_goal_s"},
      {"UPDATE point_trial SET family = 'clutter'" + one, "family"},
      {"UPDATE world SET goal_distance_m = goal_distance_m + 1 WHERE id = 1", "world 1: goal_distance_m"},
      {"UPDATE world SET seed = '2' WHERE id = 1", "world 1: seed"},
      {"UPDATE world SET json = json_set(json, '$.extra', 1) WHERE id = 1", "world 1: its text has another hash"},
      {"UPDATE controller SET resolved = json_set(resolved, '$.k_epsilon', 7) WHERE id = 1", "controller 1: its text"},
      {"UPDATE point SET controller = 'better' WHERE id = 1", "point 1 is shown as better, but its name is plain"},
      {"UPDATE suite SET name = 'other'", "suite 1 is shown as other"},
      {"UPDATE suite SET name = 'other', file_name = 'other'", "suite 1: its name is other, but that of its resolved"},
      {"UPDATE metric SET name = 'bottom'", "metric 1 is shown as bottom"},
      {"UPDATE point SET label = 'x' WHERE id = 1", "label not as its resolved suite says"},
      {"UPDATE point SET success_position_m = 5 WHERE id = 1", "success_position_m not as"},
      {"UPDATE point SET params = '{\"a\": 1}' WHERE id = 1", "params not as"},
      {"UPDATE point_trial SET world_index = world_index + 10", "its content gives another key"},
      {"UPDATE samples SET n = n - 1" + one, "samples of trial"},
      {"UPDATE samples SET data = x'00'" + one, "samples of trial"},
      {"DROP VIEW v_trials; CREATE VIEW v_trials AS SELECT 1 AS trial", "view v_trials is not the one"},
      {"CREATE TRIGGER t AFTER INSERT ON invocation BEGIN DELETE FROM trial; END", "trigger t on invocation"},
      {"UPDATE metric_value SET value = value + 1" + one, "metric top", "1"},
      {"UPDATE trial SET steps = steps + 1" + one, "steps", "1"},
  };
  for (const store::TrialColumn& column : store::trial_columns())
    if (column.about.averaged())
      all.push_back({fmt::format("UPDATE point_trial SET {0} = coalesce({0}, 0) + 1{1}", column.name, one),
                     fmt::format("differs in: {}", column.name)});
  for (const Tampering& tampering : all) {
    copy("whole.db", "a.db");
    change("a.db", {tampering.sql});
    const ProcessResult found = moma({"verify", "a.db", "-q", "--fraction", tampering.fraction});
    EXPECT_EQ(found.code, 1) << tampering.sql << found.out << found.err;
    EXPECT_NE(found.err.find(tampering.told), std::string::npos) << tampering.sql << "\n" << found.err;
    EXPECT_EQ(found.out.find("sound"), std::string::npos) << found.out;
  }
  // Views of another build are its own affair, and said; one that is missing is not.
  const std::string other_build = "UPDATE invocation SET git_commit = 'another', moma_version = '0.0.1'";
  copy("whole.db", "a.db");
  change("a.db", {other_build, "DROP VIEW v_trials; CREATE VIEW v_trials AS SELECT 1 AS trial"});
  const ProcessResult views = moma({"verify", "a.db", "--fraction", "0"});
  EXPECT_EQ(views.code, 1) << views.out << views.err;
  EXPECT_NE(views.out.find("could not be checked: views v_trials, which"), std::string::npos) << views.out;
  change("a.db", {"DROP VIEW v_trials"});
  const ProcessResult gone = moma({"verify", "a.db", "-q", "--fraction", "0"});
  EXPECT_EQ(gone.code, 1) << gone.out;
  EXPECT_NE(gone.err.find("view v_trials is missing"), std::string::npos) << gone.err;
  // Samples that unpack and have the right length, of another trial.
  copy("whole.db", "a.db");
  change("a.db",
         {"UPDATE samples SET (n, data) = (SELECT n, data FROM samples WHERE key = (SELECT max(key) FROM trial))" + one,
          "UPDATE trial SET steps = (SELECT n FROM samples AS s WHERE s.key = trial.key)"});
  const ProcessResult found = moma({"verify", "a.db", "-q", "--fraction", "1"});
  EXPECT_EQ(found.code, 1);
  EXPECT_NE(found.err.find("samples: "), std::string::npos) << found.err;
}

TEST_F(CliTrust, NothingReplayedIsNotAllTheSame) {
  good({"run", "short.yaml", "-o", "a.db", "-q", "--trials", "3"});
  const ProcessResult none = good({"verify", "a.db", "--fraction", "0"});
  EXPECT_EQ(none.out.find("all the same"), std::string::npos) << none.out;
  EXPECT_NE(none.out.find("0 of 6 trials replayed: nothing is known of the results"), std::string::npos) << none.out;
  EXPECT_NE(none.out.find("not checked: results of 6 trials"), std::string::npos) << none.out;
  change("a.db", {"UPDATE point SET simulation_version = 99"});
  const ProcessResult old = moma({"verify", "a.db", "--fraction", "1"});
  EXPECT_EQ(old.code, 1) << old.out;
  EXPECT_NE(old.out.find("none of the 6 chosen ones can be"), std::string::npos) << old.out;
  EXPECT_NE(old.out.find("6 chosen trials of another version of the simulation"), std::string::npos) << old.out;
}

TEST_F(CliTrust, AStoresPluginIsLoadedOnlyWhereTheUserSaysSo) {
  fs::copy_file(MOMA_BINARY_DIR "/tests/plugins/witness.so", path("witness.so"));
  write("plugged.yaml",
        "name: plugged\nrobot: robots/tiny.yaml\ncontrollers: {mine: {method: plugin, path: witness.so}}\n"
        "worlds: {seed: 1, families: {open: {}}}\nsimulation: {mode: kinematic, time_limit: 0.2}\n"
        "success: {dwell: 0.1}\ntrials: 2\nsamples: none\n");
  good({"run", "plugged.yaml", "-o", "a.db", "-q"});
  ASSERT_TRUE(fs::exists(path("witness"))) << "the plugin does not tell that it is loaded";
  const std::string trial = nlohmann::json::parse(
      good({"query", "a.db", "SELECT trial FROM v_trials LIMIT 1", "-f", "json"}).out)[0]["trial"];
  EXPECT_NE(
      good({"query", "a.db", "SELECT resolved FROM resolved_suite", "-f", "csv"}).out.find(path("witness.so").string()),
      std::string::npos)
      << "the path is not kept in full";
  const std::vector<std::vector<std::string>> commands = {{"replay", "a.db", trial},
                                                          {"run", "a.db", "--rerun", "plugged", "-o", "b.db", "-q"},
                                                          {"verify", "a.db", "--fraction", "1"}};
  for (std::vector<std::string> arguments : commands) {
    fs::remove(path("witness"));
    const ProcessResult refused = moma(arguments);
    EXPECT_EQ(refused.code, arguments[0] == "verify" ? 1 : 2) << arguments[0] << refused.out << refused.err;
    EXPECT_NE((refused.out + refused.err).find("--allow-plugins"), std::string::npos) << refused.out << refused.err;
    EXPECT_FALSE(fs::exists(path("witness"))) << arguments[0] << " loaded it";
    arguments.emplace_back("--allow-plugins");
    good(arguments);
    EXPECT_TRUE(fs::exists(path("witness"))) << arguments[0];
  }
  // Another library under its name is not even loaded, and neither is one by a path of the working folder.
  std::ofstream(path("witness.so"), std::ios::app | std::ios::binary) << "another build";
  fs::remove(path("witness"));
  bad({"replay", "a.db", trial, "--allow-plugins"}, {"is not that of these trials"});
  EXPECT_FALSE(fs::exists(path("witness")));
  change("a.db", {"UPDATE resolved_suite SET resolved = replace(resolved, '" + path("witness.so").string() +
                  "', 'witness.so')"});
  bad({"replay", "a.db", trial, "--allow-plugins"}, {"absolute path"});
  EXPECT_FALSE(fs::exists(path("witness")));
}

TEST_F(CliTrust, OutputsGoThroughLinksAndNeverReplaceWhatIsNoFile) {
  good({"run", "short.yaml", "-o", "a.db", "-q", "--trials", "2"});
  fs::create_directory(path("elsewhere"));
  write("elsewhere/page.html", "before");
  fs::permissions(path("elsewhere/page.html"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("elsewhere/page.html", path("link.html"));
  fs::create_symlink("elsewhere/new.html", path("new.html"));
  for (const char* name : {"link.html", "new.html"}) {
    good({"report", "a.db", "-o", name, "--force"});  // a text that is no page of moma's
    EXPECT_TRUE(fs::is_symlink(path(name))) << name;
    EXPECT_GT(fs::file_size(path(name)), 1000u);
  }
  EXPECT_EQ(fs::status(path("elsewhere/page.html")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  // The store itself behind a link: merged into where it leads, locked there as well.
  fs::create_symlink("elsewhere/all.db", path("all.db"));
  good({"merge", "all.db", "a.db"});
  EXPECT_TRUE(fs::is_symlink(path("all.db")));
  EXPECT_EQ(hash("elsewhere/all.db"), hash("a.db"));
  // A FIFO gets the page; a device stays one.
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const ProcessResult piped = shell("cat pipe > read.html & \"$1\" report a.db -o pipe; code=$?; wait; exit $code");
  EXPECT_EQ(piped.code, 0) << piped.err;
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  EXPECT_EQ(text("read.html"), text("elsewhere/page.html"));
  good({"report", "a.db", "-o", "/dev/null"});
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  bad({"merge", "pipe", "a.db"}, {"pipe", "not a regular file"});
  bad({"report", "pipe", "-o", "b.html"}, {"pipe", "no regular file"});  // would wait for a writer
  bad({"report", "/dev/zero", "-o", "b.html"}, {"/dev/zero", "no regular file"});
  // A lock that leads to another file would have that written.
  write("victim.txt", "precious");
  fs::create_symlink("victim.txt", path("a.db-lock"));
  const ProcessResult locked = moma({"run", "short.yaml", "-o", "a.db", "-q", "--trials", "2"});
  EXPECT_EQ(locked.code, 2) << locked.err;
  EXPECT_NE(locked.err.find("no plain file"), std::string::npos) << locked.err;
  EXPECT_EQ(text("victim.txt"), "precious");
}

TEST_F(CliTrust, AHangUpStopsAsOtherSignalsDo) {
  close_gate(4);
  Process process(command({"run", "gated.yaml", "-o", "a.db", "-q", "--threads", "2"}), folder_.root());
  ASSERT_TRUE(wait_at_gate(process, process.pid())) << process.wait().err;
  process.kill(SIGHUP);
  open_gate();
  const ProcessResult stopped = process.wait();
  EXPECT_EQ(stopped.code, 3) << stopped.signal << stopped.err;
  EXPECT_EQ(good({"query", "a.db", "SELECT status FROM invocation", "-f", "csv"}).out, "status\nstopped\n");
  // Under nohup it is ignored.
  close_gate(4);
  const ProcessResult ignored = shell(
      "trap '' HUP; \"$1\" run gated.yaml -o b.db -q --threads 1 --trials 8 & pid=$!; "
      "while [ ! -e gate.$pid ]; do kill -0 $pid || exit 9; sleep 0.01; done; kill -HUP $pid; sleep 0.1; rm gate; wait "
      "$pid");
  EXPECT_EQ(ignored.code, 0) << ignored.err;
}

TEST_F(CliTrust, WithNobodyToHearItTheRunEndsAndSaysSoInTheStore) {
  for (const char* how : {"2>&-", ">&- 2>&-", "<&- >&- 2>&-", "2>&1 | true"}) {
    fs::remove(path("a.db"));
    shell(std::string("\"$1\" run short.yaml -o a.db ") + how);
    EXPECT_EQ(good({"query", "a.db", "SELECT status, trials_done FROM invocation", "-f", "csv"}).out,
              "status,trials_done\nfinished,12\n")
        << how;
    const ProcessResult verify = good({"verify", "a.db", "--fraction", "0"});
    EXPECT_NE(verify.out.find("sound"), std::string::npos) << how << verify.out;
  }
}

TEST_F(CliTrust, ARunThatWasKilledIsToldFromOneAtWork) {
  close_gate(4);
  Process process(command({"run", "gated.yaml", "-o", "a.db", "-q", "--threads", "2"}), folder_.root());
  ASSERT_TRUE(wait_at_gate(process, process.pid())) << process.wait().err;
  EXPECT_NE(moma({"verify", "a.db", "--fraction", "0"}).err.find("is at work"), std::string::npos);
  process.kill(SIGKILL);
  process.wait();
  open_gate();
  EXPECT_NE(moma({"verify", "a.db", "--fraction", "0"}).err.find("was killed"), std::string::npos);
  // A copy without the lock cannot be told from one that was taken meanwhile.
  fs::copy_file(path("a.db"), path("copy.db"));
  fs::copy_file(path("a.db-wal"), path("copy.db-wal"));
  const std::string copied = moma({"verify", "copy.db", "--fraction", "0"}).err;
  EXPECT_NE(copied.find("a copy that was taken meanwhile lacks the trials of its -wal file"), std::string::npos)
      << copied;
  const ProcessResult next = good({"run", "gated.yaml", "-o", "a.db", "--trials", "5"});
  EXPECT_NE(next.err.find("was killed; its saved trials are there"), std::string::npos) << next.err;
  EXPECT_EQ(good({"query", "a.db", "SELECT status FROM invocation ORDER BY id", "-f", "csv"}).out,
            "status\nfailed\nfinished\n");
}

TEST_F(CliTrust, AHostileStoreTakesNeitherMemoryNorTimeNorTheProgram) {
  good({"run", "short.yaml", "-o", "whole.db", "-q", "--trials", "1"});
  // 4 GiB of zeros, of which the store says that they are samples.
  std::vector<char> zeros(std::size_t{1} << 20);
  ZSTD_CCtx* const context = ZSTD_createCCtx();
  constexpr std::uint64_t kBomb = std::uint64_t{4} << 30;
  ZSTD_CCtx_setPledgedSrcSize(context, kBomb);
  std::vector<char> bomb(ZSTD_compressBound(kBomb / 4096));
  ZSTD_outBuffer out{bomb.data(), bomb.size(), 0};
  for (std::uint64_t done = 0; done < kBomb; done += zeros.size()) {
    ZSTD_inBuffer in{zeros.data(), zeros.size(), 0};
    ASSERT_EQ(ZSTD_isError(ZSTD_compressStream2(context, &out, &in,
                                                done + zeros.size() == kBomb ? ZSTD_e_end : ZSTD_e_continue)),
              0u);
  }
  ZSTD_freeCCtx(context);
  write("bomb", std::string(bomb.data(), out.pos));
  const std::string loose =  // every column may hold anything
      "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(replace(replace(replace(sql, ') STRICT, W', "
      "') W'), ') STRICT', ')'), "
      "' NOT NULL', ''), 'CHECK (', 'CHECK (1 OR ') WHERE type = 'table'; PRAGMA writable_schema = RESET; ";
  const std::string deep = "printf('%.*c', 200000, '[') || printf('%.*c', 200000, ']')";
  const std::vector<std::pair<std::string, std::string>> all = {
      {"bomb", "UPDATE samples SET columns = '[\"t\"]', n = 536870912, data = readfile"},
      {"many samples of no column",
       "UPDATE samples SET n = 4611686018427387904, columns = '[]', data = x'28b52ffd2000010000'"},
      {"as many samples as can be said", "UPDATE samples SET n = 9223372036854775807"},
      {"a negative number of samples", "UPDATE samples SET n = -1"},
      {"columns that are no list", "UPDATE samples SET columns = '{}'"},
      {"columns without names", "UPDATE samples SET columns = '[1, 2]'"},
      {"deep columns", loose + "UPDATE samples SET columns = " + deep},
      {"no data", loose + "UPDATE samples SET data = NULL"},
      {"garbage", "UPDATE samples SET data = randomblob(1000)"},
      {"a short key", loose + "UPDATE OR IGNORE trial SET key = x'aabb'; UPDATE OR IGNORE samples SET key = x'aabb'"},
      {"a deep world", loose + "UPDATE world SET json = '{\"index\": ' || " + deep + " || '}'"},
      {"a deep suite",
       loose + "UPDATE resolved_suite SET resolved = substr(resolved, 1, length(resolved) - 1) || ', \"x\": ' || " +
           deep + " || '}'"},
      {"deep parameters", loose + "UPDATE point SET params = " + deep},
      {"words for numbers", loose + "UPDATE trial SET time_end_s = 'soon'; UPDATE point_trial SET manip_mean = 'x'; "
                                    "UPDATE world SET seed = 'x', objects = 'x'"},
      {"nothing at all", loose + "UPDATE trial SET outcome = NULL; UPDATE point_trial SET outcome = NULL, family = "
                                 "NULL; UPDATE world SET family = NULL, json = NULL; UPDATE suite SET name = NULL; "
                                 "UPDATE point SET controller = NULL, params = NULL"},
      {"an unknown outcome", loose + "UPDATE trial SET outcome = 'x'"},
      {"a table that is a view without end",
       "ALTER TABLE point_trial RENAME TO other; CREATE VIEW point_trial AS WITH RECURSIVE c (x) AS (SELECT 1 UNION "
       "ALL "
       "SELECT x + 1 FROM c) SELECT o.* FROM other AS o, c"},
      {"no tables", "DROP TABLE samples"},
      {"a version that never was", "PRAGMA user_version = -5"},
  };
  const std::string trial = nlohmann::json::parse(
      good({"query", "whole.db", "SELECT trial FROM v_trials LIMIT 1", "-f", "json"}).out)[0]["trial"];
  for (const auto& [name, sql] : all) {
    copy("whole.db", "a.db");
    if (name == "bomb") {
      SQLite::Database store(path("a.db").string(), SQLite::OPEN_READWRITE);
      SQLite::Statement put(store, "UPDATE samples SET columns = '[\"t\"]', n = 536870912, data = ?");
      put.bind(1, bomb.data(), static_cast<int>(out.pos));
      put.exec();
    } else {
      change("a.db", {sql});
    }
    const std::vector<std::string> commands = {
        "query a.db @summary",
        "query a.db 'SELECT count(*) FROM (SELECT 1 FROM main.trial AS t, samples(t.trial) LIMIT 1000)'",
        "report a.db -o a.html",
        "verify a.db --fraction 1 -q --threads 1",
        "replay a.db " + trial,
        "merge out.db a.db"};
    for (const std::string& one : commands) {
      fs::remove(path("out.db"));
      // The minute is only for a hang.
      const ProcessResult result = shell(kLimit + "exec timeout -s KILL 60 \"$1\" " + one);
      EXPECT_TRUE(result.signal == 0 && result.code >= 0 && result.code <= 3)
          << name << ": " << one << ": exit " << result.code << " signal " << result.signal << "\n"
          << result.err;
      EXPECT_EQ(result.err.find("internal error"), std::string::npos) << name << ": " << one << "\n" << result.err;
      EXPECT_EQ(result.err.find("out of memory"), std::string::npos) << name << ": " << one << "\n" << result.err;
    }
  }
}

}  // namespace
}  // namespace moma::test
