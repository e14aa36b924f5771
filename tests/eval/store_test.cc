#include <gtest/gtest.h>

#include <map>

#include "eval/stats/intervals.h"
#include "eval/store/columns.h"
#include "eval/store/query.h"
#include "eval/store/reader.h"
#include "store_fixture.h"

namespace moma::test {
namespace {

using store::Cell;
using store::QueryResult;
using store::Reader;
using store::StoreError;
using store::Writer;

std::int64_t integer(const QueryResult& result, std::size_t row = 0, std::size_t column = 0) {
  return std::get<std::int64_t>(result.rows.at(row).at(column));
}

std::vector<std::string> texts(const QueryResult& result) {
  std::vector<std::string> all;
  for (const auto& row : result.rows) all.push_back(std::get<std::string>(row.at(0)));
  return all;
}

TEST(Store, RowsComeBackBitForBit) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one", "two"}, 70);
  const Reader reader(file);
  ASSERT_EQ(reader.keys().size(), 140u);
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::uint64_t w = 0; w < 70; ++w) {
      const store::StoredTrial trial = reader.trial(synthetic_key(p, w));
      EXPECT_EQ(store::differences(trial.row, synthetic_row(p, w)), std::vector<std::string>{});
      EXPECT_EQ(trial.world_index, w);
      EXPECT_EQ(trial.world, synthetic_world(w).json);
      EXPECT_EQ(trial.position, p);
      EXPECT_EQ(trial.controller, p == 0 ? "one" : "two");
      EXPECT_EQ(trial.resolved_suite, synthetic_suite({"one", "two"}).resolved);
    }
  }
  EXPECT_TRUE(reader.integrity_problems().empty());
}

TEST(Store, DifferencesNameEveryColumn) {
  TrialRow row;
  Filler(1.0).fill(row);
  std::size_t columns = 0;
  for (const store::TrialColumn& column : store::trial_columns()) {
    TrialRow other = row;
    if (const auto* number = std::get_if<double TrialRow::*>(&column.member)) {
      other.*(*number) = std::nextafter(row.*(*number), 1e9);
    } else if (const auto* count = std::get_if<int TrialRow::*>(&column.member)) {
      other.*(*count) += 1;
    } else {
      other.*std::get<std::string TrialRow::*>(column.member) += "x";
    }
    const std::vector<std::string> found = store::differences(row, other);
    ASSERT_EQ(found.size(), 1u) << column.name;
    EXPECT_EQ(found[0].rfind(std::string(column.name) + ":", 0), 0u) << found[0];
    ++columns;
  }
  EXPECT_GE(columns, 39u);
}

TEST(Store, AbsentAndInfiniteAreNull) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  TrialRow row = synthetic_row(0, 1);
  row.clearance_min_m = std::numeric_limits<double>::infinity();
  row.slack_max = kAbsent;
  row.manip_min = -0.0;
  {
    Writer writer(file);
    writer.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, 2));
    writer.add(synthetic_wanted(0, 1), synthetic_world(1), row, nullptr);
    writer.finish(store::RunStatus::kFinished);
  }
  const QueryResult result = store::query(file, "SELECT clearance_min_m, slack_max, link, manip_min FROM v_trials");
  ASSERT_EQ(result.rows.size(), 1u);
  for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::holds_alternative<std::monostate>(result.rows[0][c])) << c;
  EXPECT_EQ(std::get<double>(result.rows[0][3]), 0.0);
  EXPECT_TRUE(store::differences(Reader(file).trial(synthetic_key(0, 1)).row, row).empty());
}

TEST(Store, ViewsHaveTheDocumentedColumns) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 1);
  const std::vector<std::string> trials = {"trial",
                                           "suite",
                                           "robot",
                                           "controller",
                                           "point",
                                           "params",
                                           "family",
                                           "world",
                                           "mode",
                                           "outcome",
                                           "reason",
                                           "link",
                                           "object",
                                           "time_end_s",
                                           "time_to_goal_s",
                                           "position_error_m",
                                           "orientation_error_rad",
                                           "path_ee_m",
                                           "path_base_m",
                                           "manip_mean",
                                           "manip_min",
                                           "manip_final",
                                           "manip_all_mean",
                                           "manip_all_min",
                                           "manip_all_final",
                                           "clearance_min_m",
                                           "clearance_self_min_m",
                                           "limit_margin_min",
                                           "collision_count",
                                           "collision_time_s",
                                           "collision_depth_m",
                                           "jerk_ee_rms",
                                           "jerk_joint_rms",
                                           "command_change_mean",
                                           "energy_j",
                                           "slack_mean",
                                           "slack_max",
                                           "active_rows_mean",
                                           "qp_infeasible",
                                           "fallback_no_acceleration",
                                           "fallback_relaxed",
                                           "fallback_brake",
                                           "slip_max_m_s",
                                           "tracking_error_rms",
                                           "lcp_messages",
                                           "steps",
                                           "detector_checks",
                                           "detector_disagreements",
                                           "detector_deepest_m",
                                           "t_solve_median_us",
                                           "t_solve_p99_us",
                                           "t_solve_max_us",
                                           "t_step_median_us",
                                           "t_step_p99_us",
                                           "t_step_max_us",
                                           "t_trial_us"};
  // Metrics that came later stand among these.
  std::vector<std::string> found = store::query(file, "SELECT * FROM v_trials").columns;
  const auto remove_later = [&](const auto& columns) {
    for (const auto& column : columns)
      if (column.about.earlier == Earlier::kUnknown) {
        EXPECT_EQ(std::erase(found, column.name), 1u) << column.name;
      }
  };
  remove_later(store::trial_columns());
  remove_later(store::timing_columns());
  EXPECT_EQ(found, trials);
  const std::vector<std::string> summary = {"suite",
                                            "robot",
                                            "controller",
                                            "point",
                                            "family",
                                            "mode",
                                            "n",
                                            "errors",
                                            "success_rate",
                                            "success_low",
                                            "success_high",
                                            "success_without_errors",
                                            "collision_rate",
                                            "collision_low",
                                            "collision_high",
                                            "time_to_goal_median_s",
                                            "manip_mean",
                                            "clearance_min_m",
                                            "command_change_mean",
                                            "times_bound"};
  EXPECT_EQ(store::query(file, "SELECT * FROM v_summary").columns, summary);
}

TEST(Store, TablesAreStrictAndMarkedAsOurs) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 1);
  EXPECT_EQ(integer(store::query(file,
                                 "SELECT count(*) FROM pragma_table_list WHERE schema = 'main' AND type = 'table' "
                                 "AND NOT strict AND name NOT LIKE 'sqlite_%'")),
            0);
  EXPECT_EQ(integer(store::query(file, "PRAGMA application_id")), 0x6d6f6d61);
  EXPECT_EQ(integer(store::query(file, "PRAGMA user_version")), 4);
  EXPECT_EQ(texts(store::query(file, "PRAGMA journal_mode")), std::vector<std::string>{"wal"});
}

TEST(Store, WilsonAndMedianInSqlAreThoseOfTheProgram) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  const std::uint64_t worlds = 41;
  write_synthetic(file, {"one", "two"}, worlds);
  const QueryResult result = store::query(file, "SELECT * FROM v_summary ORDER BY controller, family");
  ASSERT_EQ(result.rows.size(), 4u);
  std::size_t i = 0;
  for (std::size_t p = 0; p < 2; ++p) {
    for (const std::string family : {"clutter", "open"}) {
      std::int64_t n = 0;
      std::int64_t successes = 0;
      std::vector<double> times;
      for (std::uint64_t w = 0; w < worlds; ++w) {
        if (synthetic_world(w).family != family) continue;
        const TrialRow row = synthetic_row(p, w);
        ++n;
        if (row.outcome != Outcome::kSuccess) continue;
        ++successes;
        times.push_back(row.time_to_goal_s);
      }
      const auto& row = result.rows[i++];
      EXPECT_EQ(std::get<std::int64_t>(row[6]), n);
      const stats::Interval success = stats::wilson(successes, n);
      const stats::Interval collision = stats::wilson(n - successes, n);
      EXPECT_EQ(std::get<std::int64_t>(row[7]), 0);
      EXPECT_NEAR(std::get<double>(row[8]), static_cast<double>(successes) / static_cast<double>(n), 1e-15);
      EXPECT_NEAR(std::get<double>(row[9]), success.low, 1e-12);
      EXPECT_NEAR(std::get<double>(row[10]), success.high, 1e-12);
      EXPECT_NEAR(std::get<double>(row[13]), collision.low, 1e-12);
      EXPECT_NEAR(std::get<double>(row[14]), collision.high, 1e-12);
      EXPECT_NEAR(std::get<double>(row[15]), stats::median(times), 1e-12);
      EXPECT_TRUE(std::holds_alternative<std::monostate>(row[17])) << "no trial has a clearance";
    }
  }
}

/// Ten worlds of one family: point 0 ends by an error in 0, 4 and 8, collides in 1 and 5, is out of time in 9, and
/// succeeds in 2, 3, 6, 7; point 1 ends by an error in all.
void write_with_errors(const fs::path& file) {
  store::SuiteRecord suite = synthetic_suite({"mostly", "never"});
  suite.metrics = {{"own", "max(t)"}};
  const std::vector<store::Wanted> jobs = synthetic_jobs(2, 10);
  Writer writer(file);
  writer.begin(suite, {}, jobs);
  for (const store::Wanted& job : jobs) {
    store::WorldRecord world = synthetic_world(job.world);
    world.family = "open";
    TrialRow row = synthetic_row(job.point, job.world);
    const bool error = job.point == 1 || job.world % 4 == 0;
    row.outcome = error                ? Outcome::kError
                  : job.world % 4 == 1 ? (job.world == 9 ? Outcome::kTimeout : Outcome::kCollision)
                                       : Outcome::kSuccess;
    row.time_to_goal_s = row.outcome == Outcome::kSuccess ? static_cast<double>(job.world) : kAbsent;
    row.manip_mean = error ? 1000.0 : static_cast<double>(job.world);
    const double own[] = {row.manip_mean};
    writer.add(job, world, row, nullptr, own);
  }
  writer.finish(store::RunStatus::kFinished);
}

TEST(Store, TrialsThatEndByAnErrorDidNotSucceed) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_with_errors(file);
  const QueryResult result =
      store::query(file,
                   "SELECT n, errors, success_rate, success_low, success_high, success_without_errors, collision_rate, "
                   "collision_low, "
                   "collision_high, time_to_goal_median_s, manip_mean FROM v_summary ORDER BY controller");
  ASSERT_EQ(result.rows.size(), 2u);
  const auto& mostly = result.rows[0];
  EXPECT_EQ(std::get<std::int64_t>(mostly[0]), 10);
  EXPECT_EQ(std::get<std::int64_t>(mostly[1]), 3);
  const stats::Interval success = stats::wilson(4, 10);
  const stats::Interval collision = stats::wilson(2, 10);
  const double mean = (1 + 2 + 3 + 5 + 6 + 7 + 9 + 3 * 1000) / 10.0;
  const double expected[] = {0.4, success.low, success.high, 4.0 / 7.0, 0.2, collision.low, collision.high, 4.5, mean};
  for (std::size_t i = 0; i < std::size(expected); ++i)
    EXPECT_NEAR(std::get<double>(mostly[2 + i]), expected[i], 1e-12) << result.columns[2 + i];
  const auto& never = result.rows[1];
  EXPECT_EQ(std::get<std::int64_t>(never[0]), 10);
  EXPECT_EQ(std::get<std::int64_t>(never[1]), 10);
  EXPECT_EQ(std::get<double>(never[2]), 0.0);
  EXPECT_NEAR(std::get<double>(never[4]), stats::wilson(0, 10).high, 1e-12);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(never[5])) << "without errors there is no trial";

  const QueryResult own = store::query(file, "SELECT controller, metric, n, mean FROM v_metric_summary");
  ASSERT_EQ(own.rows.size(), 2u);
  EXPECT_EQ(own.rows[0][0], Cell{std::string("mostly")});
  EXPECT_EQ(own.rows[0][2], Cell{std::int64_t{10}});
  EXPECT_NEAR(std::get<double>(own.rows[0][3]), mean, 1e-12) << "as v_summary has moma's metrics";

  EXPECT_EQ(integer(store::query(file, "SELECT sum(success_a) FROM v_pairs")), 4);
  EXPECT_EQ(integer(store::query(file, "SELECT sum(success_b) FROM v_pairs")), 0);
}

TEST(Store, PairsAreOnTheSameWorldAndOnce) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one", "two", "three"}, 6);
  EXPECT_EQ(integer(store::query(file, "SELECT count(*) FROM v_pairs")), 3 * 6);
  EXPECT_EQ(integer(store::query(file,
                                 "SELECT count(*) FROM v_pairs AS p JOIN v_trials AS t ON t.trial = p.trial_b "
                                 "WHERE t.world = p.world AND t.controller = p.controller_b "
                                 "AND t.outcome = p.outcome_b AND p.success_b = (t.outcome = 'success')")),
            3 * 6);
  EXPECT_EQ(integer(store::query(file,
                                 "SELECT count(*) FROM v_pairs WHERE controller_a = 'two' "
                                 "AND controller_b = 'one'")),
            0);
}

TEST(Store, ResumeSkipsAndMoreTrialsKeepTheNames) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  EXPECT_EQ(write_synthetic(file, {"one"}, 5), 0u);
  EXPECT_EQ(write_synthetic(file, {"one", "two"}, 8), 5u) << "a controller and three worlds more";
  EXPECT_EQ(write_synthetic(file, {"one", "two"}, 8), 16u);
  EXPECT_EQ(texts(store::query(file, "SELECT DISTINCT suite || '/' || controller FROM v_trials ORDER BY 1")),
            (std::vector<std::string>{"synthetic/one", "synthetic/two"}));
  EXPECT_EQ(integer(store::query(file, "SELECT count(*) FROM v_trials")), 16);
  EXPECT_EQ(integer(store::query(file, "SELECT count(*) FROM invocation WHERE status = 'finished'")), 3);
  EXPECT_EQ(integer(store::query(file, "SELECT trials_done FROM invocation ORDER BY id LIMIT 1 OFFSET 1")), 11);
}

TEST(Store, OtherSettingsAndParametersAreKeptApart) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 2, "a");
  write_synthetic(file, {"one"}, 2, "b");
  store::SuiteRecord changed = synthetic_suite({"one"}, "a");
  changed.points[0].content_hash = store::hash_text("other gains");
  {
    Writer writer(file);
    writer.begin(changed, {}, synthetic_jobs(1, 2));
    EXPECT_EQ(writer.suite_name(), "synthetic");
    EXPECT_EQ(writer.controller_name(0), "one@2");
    writer.finish(store::RunStatus::kFinished);
  }
  EXPECT_EQ(texts(store::query(file, "SELECT DISTINCT suite || '/' || controller FROM v_trials ORDER BY 1")),
            (std::vector<std::string>{"synthetic/one", "synthetic/one@2", "synthetic@2/one"}));
}

TEST(Store, SharedTrialsAreLinkedToEveryPoint) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  std::vector<store::Wanted> jobs = {{0, 0, synthetic_key(0, 0)}, {1, 0, synthetic_key(0, 0)}};
  Writer writer(file);
  writer.begin(synthetic_suite({"one", "same"}), {}, jobs);
  writer.add(jobs[0], synthetic_world(0), synthetic_row(0, 0), nullptr);  // a batch computes a key once
  writer.finish(store::RunStatus::kFinished);
  EXPECT_EQ(texts(store::query(file, "SELECT controller FROM v_trials ORDER BY 1")),
            (std::vector<std::string>{"one", "same"}));
  EXPECT_EQ(integer(store::query(file, "SELECT count(*) FROM trial")), 1);
}

TEST(Store, TheSameKeyWithAnotherResultIsAContradiction) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 3);
  const std::string before = Reader(file).result_hash();
  TrialRow other = synthetic_row(0, 1);
  other.manip_mean = std::nextafter(other.manip_mean, 1e9);
  {
    Writer writer(file);
    writer.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, 3));
    writer.add(synthetic_wanted(0, 0), synthetic_world(0), synthetic_row(0, 0), nullptr);
    writer.flush();  // the same again is fine
    try {
      writer.add(synthetic_wanted(0, 1), synthetic_world(1), other, nullptr);
      writer.flush();
      FAIL() << "a contradiction was taken";
    } catch (const StoreError& error) {
      EXPECT_EQ(error.kind(), StoreError::Kind::kContradiction);
      EXPECT_NE(std::string(error.what()).find("manip_mean"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(Reader(file).result_hash(), before);
}

TEST(Store, AnyUniqueBeginningNamesATrial) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 40);
  const Reader reader(file);
  const std::string key = synthetic_key(0, 17);
  for (const std::size_t digits : {7u, 8u, 16u, 31u, 32u}) EXPECT_EQ(reader.trial(key.substr(0, digits)).key, key);
  const auto fails_with = [&](const std::string& prefix, const std::string& word) {
    try {
      reader.trial(prefix);
      ADD_FAILURE() << prefix << " was found";
    } catch (const StoreError& error) {
      EXPECT_EQ(error.kind(), StoreError::Kind::kNotFound);
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  fails_with("", "hex digits");
  fails_with("xyz", "hex digits");
  fails_with(key + "0", "hex digits");
  // Forty keys over sixteen first digits: some digit has two, and some prefix none.
  std::map<char, int> first;
  for (const std::string& k : reader.keys()) ++first[k[0]];
  for (const auto& [digit, n] : first) {
    if (n > 1) return fails_with(std::string(1, digit), "several");
  }
}

TEST(Store, SamplesComeBackBitForBit) {
  Trace trace(50);
  for (int k = 0; k < 50; ++k) {
    Sample& s = trace[static_cast<std::size_t>(k)];
    s.q = VectorX::Zero(7);
    s.qdot = s.command = VectorX::Zero(9);
    Filler(k).fill(s);
    s.t = 0.02 * k;
    s.slack[2] = 1e-300;
    s.least_distance = k % 2 == 0 ? std::numeric_limits<double>::infinity() : 0.3;
    s.status = k % 5 == 0 ? StepStatus::kInfeasible : StepStatus::kSolved;
    s.fallback = k % 5 == 0 ? Fallback::kBrake : Fallback::kNone;
    s.escape.detour = k % 3 > 0;
  }
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  {
    Writer writer(file);
    writer.begin(synthetic_suite({"one"}), {}, synthetic_jobs(1, 1));
    writer.add(synthetic_wanted(0, 0), synthetic_world(0), synthetic_row(0, 0), &trace);
    writer.finish(store::RunStatus::kFinished);
  }
  const store::StoredTrial trial = Reader(file).trial(synthetic_key(0, 0));
  ASSERT_TRUE(trial.samples.has_value());
  const Trace back = store::decode_samples(*trial.samples);
  ASSERT_EQ(back.size(), trace.size());
  for (std::size_t k = 0; k < trace.size(); ++k) {
    EXPECT_EQ(bits_of(back[k]), bits_of(trace[k])) << k;
  }
  store::EncodedSamples damaged = *trial.samples;
  damaged.data.resize(damaged.data.size() / 2);
  EXPECT_THROW(store::decode_samples(damaged), std::runtime_error);
  damaged = *trial.samples;
  damaged.n *= 1000000000;
  EXPECT_THROW(store::decode_samples(damaged), std::runtime_error);
  EXPECT_NO_THROW(store::decode_samples(store::encode_samples({})));
}

TEST(Store, ProvenanceIsComplete) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a.db";
  write_synthetic(file, {"one"}, 1);
  const QueryResult result = store::query(file, "SELECT * FROM invocation");
  ASSERT_EQ(result.rows.size(), 1u);
  for (std::size_t c = 0; c < result.columns.size(); ++c) {
    const std::string& name = result.columns[c];
    if (name.rfind("git_", 0) == 0) continue;  // built from an archive
    if (name == "risk") continue;              // found by moma risk alone
    const Cell& cell = result.rows[0][c];
    EXPECT_FALSE(std::holds_alternative<std::monostate>(cell)) << name;
    if (const auto* text = std::get_if<std::string>(&cell)) {
      EXPECT_FALSE(text->empty()) << name;
    }
  }
}

}  // namespace
}  // namespace moma::test
