#include <SQLiteCpp/SQLiteCpp.h>

#include "cli_fixture.h"

// What somebody changed in a store is found by `moma verify`, or is at least not called sound.
namespace moma::test {
namespace {

struct Tampering {
  const char* what;
  const char* sql;
  const char* says;
  bool hashes;  ///< and the lines of --hash are others
};

constexpr Tampering kTamperings[] = {
    {"failures unlinked", "DELETE FROM point_trial WHERE outcome <> 'success'", "trials belong to no point", true},
    {"failures deleted",
     "CREATE TEMP TABLE k AS SELECT key FROM point_trial WHERE outcome <> 'success'; DELETE FROM execution WHERE key "
     "IN k; "
     "DELETE FROM metric_value WHERE key IN k; DELETE FROM samples WHERE key IN k; DELETE FROM point_trial WHERE key "
     "IN k; "
     "DELETE FROM trial WHERE key IN k",
     "a run finished with 12 trials", true},
    {"results that another version is said to have",
     "UPDATE point SET simulation_version = 1; UPDATE trial SET outcome = 'success'; UPDATE point_trial SET outcome = "
     "'success'",
     "could not be checked", true},
    {"a view, and a commit to cover it",
     "UPDATE invocation SET git_commit = 'aaaaaaaaaaaa'; DROP VIEW v_summary; CREATE VIEW v_summary AS SELECT 1 AS n",
     "could not be checked: views v_summary", false},
    {"a metric's expression",
     "UPDATE metric SET expression = 'max(t) * 0.1'; UPDATE metric_value SET value = 0.1 * value",
     "no value of metric last", true},
    {"a metric's values", "DELETE FROM metric_value", "no value of metric last", true},
    {"a column that later versions have", "UPDATE trial SET redone_steps = 999, separation_margin_min_m = 0.77",
     "redone_steps: 999 != nan", true},
    {"values of columns that earlier versions lack",
     "UPDATE trial SET separation_margin_min_m = NULL, acceleration_max = NULL, latency_joints_s = NULL, "
     "tracking_error_rms = NULL",
     "trials have no value and come out with one", true},
    {"the hash of a suite's setting", "UPDATE suite SET setting_hash = zeroblob(16)", "setting_hash not as", true},
    {"a world without a number", "UPDATE point_trial SET world_index = 100000000007 WHERE world_index = 3",
     "its content gives another key", true},
};

constexpr const char* kTune = R"(name: tuned
robot: robots/tiny.yaml
controllers: {plain: controllers/plain.yaml}
worlds: {seed: 1, families: {open: {}}}
simulation: {mode: kinematic, time_limit: 4}
trials: 2
tune:
  variables: {controller.k_epsilon: {range: [0.05, 2]}}
  worlds: 3
  budget: {trials: 12}
  held_out: 4
  confirm: none
  sensitivity: none
)";

class CliTamper : public CliTest {
 protected:
  void SetUp() override {
    write("two.yaml", R"(name: two
robot: robots/tiny.yaml
controllers: {plain: controllers/plain.yaml, slow: {include: controllers/plain.yaml, k_epsilon: 0.1}}
worlds: {seed: 1, families: {open: {weight: 1}, clutter: {weight: 2.5}}}
simulation: {mode: kinematic, time_limit: 4}
metrics: {last: max(t)}
trials: 6
)");
    good({"run", "two.yaml", "-o", "a.db", "-q"});
  }
  void change(const std::string& file, const std::string& sql) const {
    SQLite::Database db(path(file).string(), SQLite::OPEN_READWRITE);
    db.exec("PRAGMA foreign_keys = OFF");
    db.exec(sql);
  }
  /// With 3 GB of address space.
  ProcessResult verify(const std::string& file) {
    starter_ = {"/bin/sh", "-c", "ulimit -v 3000000; exec \"$@\"", "sh"};
    ProcessResult result = moma({"verify", file, "--fraction", "1", "--hash", "--threads", "1"});
    starter_ = {};
    return result;
  }
};

std::string hash_lines(const std::string& text) { return text.substr(std::min(text.find("results "), text.size())); }

TEST_F(CliTamper, IsFound) {
  const ProcessResult sound = verify("a.db");
  ASSERT_EQ(sound.code, 0) << sound.out << sound.err;
  ASSERT_NE(sound.out.find("the store is sound"), std::string::npos) << sound.out;
  ASSERT_NE(good({"query", "a.db", "@summary"}).out.find("slow"), std::string::npos);
  for (const Tampering& tampering : kTamperings) {
    fs::copy_file(path("a.db"), path("b.db"), fs::copy_options::overwrite_existing);
    change("b.db", tampering.sql);
    const ProcessResult found = verify("b.db");
    EXPECT_EQ(found.code, 1) << tampering.what << "\n" << found.out << found.err;
    EXPECT_NE((found.out + found.err).find(tampering.says), std::string::npos) << tampering.what << "\n"
                                                                               << found.out << found.err;
    EXPECT_EQ(found.out.find("the store is sound"), std::string::npos) << tampering.what;
    EXPECT_EQ(hash_lines(found.out) != hash_lines(sound.out), tampering.hashes) << tampering.what;
  }
}

TEST_F(CliTamper, WhatWasNotLookedAtIsNotCalledSound) {
  const std::string part = good({"verify", "a.db", "--fraction", "0.2", "-q"}).out;
  EXPECT_NE(part.find("3 of 12 trials replayed: all the same"), std::string::npos) << part;
  EXPECT_NE(part.find("of the other results nothing is known"), std::string::npos) << part;
}

TEST_F(CliTamper, WhatASearchFoundFollowsFromItsTrials) {
  write("tune.yaml", kTune);
  moma({"tune", "tune.yaml", "-o", "t.db", "--gains", "g.yaml", "-q"});
  const ProcessResult sound = verify("t.db");
  EXPECT_EQ(sound.code, 0) << sound.out << sound.err;
  EXPECT_NE(sound.out.find("the store is sound"), std::string::npos) << sound.out;
  const std::pair<const char*, const char*> changes[] = {
      {"UPDATE tune_search SET verdict = iif(verdict = 'better', 'worse', 'better')", "tune_search: verdict"},
      {"UPDATE trial SET command_change_mean = 0.5 WHERE key IN (SELECT m.key FROM point_trial AS m JOIN point AS p ON "
       "p.id = m.point_id WHERE p.controller = 'plain-tuned')",
       "tune_comparison, row "},
      {"DELETE FROM tune_evaluation WHERE evaluation = (SELECT max(evaluation) FROM tune_evaluation)",
       "tune_evaluation: the search has an end, and evaluation"},
      {"DELETE FROM execution WHERE key NOT IN (SELECT key FROM point_trial); "
       "DELETE FROM trial WHERE key NOT IN (SELECT key FROM point_trial)",
       " is missing"},
      {"DELETE FROM tune_comparison; UPDATE tune_search SET verdict = NULL", "a part of a verdict"},
      {"UPDATE tune_search SET held_out = NULL",
       "could not be checked: search 1 (plain of tuned): tune_search.held_out"},
  };
  for (const auto& [sql, says] : changes) {
    fs::copy_file(path("t.db"), path("b.db"), fs::copy_options::overwrite_existing);
    change("b.db", sql);
    const ProcessResult found = verify("b.db");
    EXPECT_EQ(found.code, 1) << sql << "\n" << found.out << found.err;
    EXPECT_NE((found.out + found.err).find(says), std::string::npos) << sql << "\n" << found.out << found.err;
    EXPECT_EQ(found.out.find("the store is sound"), std::string::npos) << sql;
  }
}

// Of a search that was stopped all is judged that is there; trials that it counted nowhere are named.
TEST_F(CliTamper, ASearchWithoutAnEndIsJudgedAsFarAsItWent) {
  write("tune.yaml", kTune);
  moma({"tune", "tune.yaml", "-o", "t.db", "--gains", "g.yaml", "-q"});
  change("t.db",
         "UPDATE tune_search SET (status, ended, verdict, held_out, held_out_suite, trials, trials_saved, "
         "evaluations_cut, runs, notes) = ('stopped', NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL); "
         "UPDATE tune_variable SET found = NULL, importance = NULL; DELETE FROM tune_finalist; "
         "DELETE FROM tune_comparison; DELETE FROM tune_evaluation WHERE evaluation > 1");
  const ProcessResult part = verify("t.db");
  EXPECT_EQ(part.code, 0) << part.out << part.err;
  EXPECT_NE(part.out.find("trials that belong to no point, nor to a search"), std::string::npos) << part.out;
  EXPECT_EQ(part.out.find("the store is sound"), std::string::npos) << part.out;
  change("t.db", "UPDATE tune_evaluation SET cost = cost + 1 WHERE evaluation = 1");
  EXPECT_EQ(verify("t.db").code, 1);
}

TEST_F(CliTamper, MergeTakesNoChangedTexts) {
  for (const char* sql : {"UPDATE world SET json = replace(json, '\"index\":1', '\"index\":1 ') WHERE world_index = 1",
                          "UPDATE controller SET resolved = resolved || ' '"}) {
    fs::copy_file(path("a.db"), path("b.db"), fs::copy_options::overwrite_existing);
    change("b.db", sql);
    const ProcessResult merged = moma({"merge", "m.db", "b.db"});
    EXPECT_EQ(merged.code, 1) << sql << merged.err;
    EXPECT_NE(merged.err.find("it was changed; nothing was merged"), std::string::npos) << merged.err;
    EXPECT_FALSE(fs::exists(path("m.db")));
  }
}

}  // namespace
}  // namespace moma::test
