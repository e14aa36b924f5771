#include <gtest/gtest.h>

#include <atomic>
#include <map>

#include "eval/run/store_file.h"
#include "eval/store/reader.h"
#include "eval/tune/held_out.h"
#include "eval/tune/search_record.h"
#include "eval/tune/trial_objective.h"
#include "eval/tune/tuning.h"
#include "tests/eval/search_objectives.h"
#include "tests/eval/suite_fixture.h"

namespace moma::tune {
namespace {

using moma::test::SuiteFolder;

constexpr const char* kTune = R"(tune:
  variables:
    controller.servo.position: {range: [0.2, 4], scale: log, start: 0.3}
    controller.k_epsilon: {range: [0.1, 5], scale: log}
  worlds: 8
  racing: {first: 4, block: 2, significance: 0.2}
  confirm: {candidates: 2, worlds: 4, neighbours: 2}
  sensitivity: {pairs_of: 2}
  budget: {trials: 170}
  held_out: 30
)";

/// Stops the search after some trials, as Ctrl-C or a kill would.
class Killer : public run::StoredTrials {
 public:
  Killer(store::Writer& writer, std::atomic<bool>& stop, std::uint64_t after)
      : StoredTrials(writer, Of::kSearch), stop_(stop), after_(after) {}
  void add(const SuitePoint& point, const BatchJob& job, const BatchResult& result) override {
    StoredTrials::add(point, job, result);
    if (++added == after_) stop_ = true;
  }
  std::uint64_t added = 0;

 private:
  std::atomic<bool>& stop_;
  std::uint64_t after_;
};

struct Outcome2 {
  std::optional<SearchResult> result;
  TrialCounts counts;
};

Outcome2 run(const Tuning& tuning, const std::filesystem::path& db, int threads, std::uint64_t stop_after = 0) {
  store::Writer writer(db);
  writer.begin(store::describe(searched_suite(tuning)), {{"test"}, threads}, {});
  store::TuneRecords records(writer, search_record(tuning), tuning.config.variables);
  std::atomic<bool> stop{false};
  Killer trials(writer, stop, stop_after);
  TrialObjective objective(tuning, trials, threads, &stop);
  Outcome2 out;
  try {
    out.result = search(search_settings(tuning), objective, records);
    records.finish(*out.result);
    writer.finish(store::RunStatus::kFinished);
  } catch (const Interrupted&) {
    // As after a kill: nothing is closed properly.
  }
  out.counts = objective.counts();
  return out;
}

TEST(TuneRun, ThreadsKillsAndResumesGiveTheSameBits) {
  const SuiteFolder folder;
  const Tuning tuning = load_tuning(folder.suite(kTune));
  const Outcome2 whole = run(tuning, folder.root() / "whole.db", 1);
  ASSERT_TRUE(whole.result);
  EXPECT_EQ(whole.counts.errors, 0u) << whole.counts.first_error;
  EXPECT_GT(whole.result->evaluations_cut, 0u);
  EXPECT_LE(whole.result->trials, tuning.config.budget);

  const std::filesystem::path db = folder.root() / "killed.db";
  int kills = 0;
  Outcome2 last;
  std::uint64_t computed = 0;
  for (; kills < 10; ++kills) {
    last = run(tuning, db, 1 + kills % 3, 1 + whole.counts.computed / 12);
    computed += last.counts.computed;
    if (last.result) break;
  }
  EXPECT_EQ(kills, 10) << "every run was to be killed";
  last = run(tuning, db, 2);
  computed += last.counts.computed;
  ASSERT_TRUE(last.result);
  EXPECT_EQ(*last.result, *whole.result);
  EXPECT_EQ(computed, whole.counts.computed) << "no trial is computed twice";
  EXPECT_EQ(store::Reader(db).result_hash(), store::Reader(folder.root() / "whole.db").result_hash());

  // Once more: all of it is there.
  const Outcome2 again = run(tuning, db, 1);
  EXPECT_EQ(*again.result, *whole.result);
  EXPECT_EQ(again.counts.computed, 0u);
}

TEST(TuneRun, TrialsOfASweepAreReused) {
  const SuiteFolder folder;
  const auto file = folder.suite(kTune);
  const Tuning tuning = load_tuning(file, {{"tune.sensitivity", "none"}});
  // The start gains, evaluated by an ordinary run before.
  const Suite suite = load_suite(file, {{"controller.servo.position", "0.3"}, {"trials", "8"}});
  const std::filesystem::path db = folder.root() / "shared.db";
  {
    store::Writer writer(db);
    const std::vector<BatchJob> jobs = make_jobs(suite.points, 0, suite.trials);
    std::vector<store::Wanted> wanted;
    for (const BatchJob& job : jobs) wanted.push_back({job.point, job.world, job.key});
    writer.begin(store::describe(suite), {{"test"}, 1}, wanted);
    run_batch(suite.points, jobs, {}, [&](const BatchJob& job, BatchResult&& result) {
      writer.add({job.point, job.world, job.key}, store::describe(*result.world), result.output.row, nullptr);
      return true;
    });
    writer.finish(store::RunStatus::kFinished);
  }
  const Outcome2 out = run(tuning, db, 2);
  ASSERT_TRUE(out.result);
  EXPECT_EQ(out.counts.reused, 8u);
  const Outcome2 alone = run(tuning, folder.root() / "alone.db", 2);
  EXPECT_EQ(*out.result, *alone.result) << "what the store held changes the work, not the result";
}

TEST(TuneRun, MixtureOfTwoPartsSharesOneSetOfGains) {
  const SuiteFolder folder;
  const Tuning tuning = load_tuning(
      folder.suite(std::string(kTune) + "  mixture: [{worlds.families.open.weight: 2}, {simulation.time_limit: 4}]\n",
                   "{plain: controllers/plain.yaml}"),
      {{"tune.budget.trials", "100"}, {"tune.sensitivity", "none"}});
  EXPECT_EQ(tuning.suites.size(), 2u);
  EXPECT_EQ(search_settings(tuning).worlds.size(), 16u);
  const Outcome2 out = run(tuning, folder.root() / "mixture.db", 2);
  ASSERT_TRUE(out.result);
  const HeldOut held_out = make_held_out(tuning, out.result->found);
  EXPECT_EQ(held_out.suite.points.size(), 6u) << "preset, start and found in each part";
  EXPECT_EQ(held_out.part_names[1], "simulation.time_limit=4");
}

// Rows made by hand: what the verdict says must follow from them.
class Judged : public ::testing::Test {
 protected:
  Judged() : tuning(load_tuning(folder.suite(std::string(kTune) + "  constraints: {collision: {at_most: 0.1}}\n"))) {
    held_out = make_held_out(tuning, {1.0, 1.0});
  }
  // outcome(controller, world)
  template <typename F>
  HeldOutVerdict judged(const F& outcome) {
    std::vector<TrialRow> rows;
    for (const BatchJob& job : held_out.jobs) {
      TrialRow row;
      row.outcome = outcome(held_out.suite.points[job.point].controller, job.world);
      if (row.outcome == Outcome::kSuccess) row.time_to_goal_s = 3.0;
      row.command_change_mean = 0.02;
      row.manip_mean = 0.05;
      rows.push_back(row);
    }
    return judge(tuning, held_out, rows);
  }
  const store::TuneComparisonRecord& row(const HeldOutVerdict& v, const std::string& other, const std::string& metric) {
    for (const auto& r : v.rows) {
      if (r.other == other && r.metric == metric && r.family == "all") return r;
    }
    throw std::out_of_range(metric);
  }
  SuiteFolder folder;
  Tuning tuning;
  HeldOut held_out;
};

TEST_F(Judged, HeldOutWorldsAreThoseAndOnlyThose) {
  EXPECT_EQ(held_out.found, "plain-tuned");
  EXPECT_EQ(held_out.others, (std::vector<std::string>{"plain", "plain-start"}));
  EXPECT_EQ(held_out.jobs.size(), 3u * 30u);
  for (const BatchJob& job : held_out.jobs) EXPECT_GE(job.world, 12u) << "8 of the search, 4 of the confirmation";
}

TEST_F(Judged, BetterWhenItSucceedsMoreOften) {
  const HeldOutVerdict v = judged([](const std::string& name, std::uint64_t world) {
    return name == "plain-tuned" || world % 3 == 0 ? Outcome::kSuccess : Outcome::kStuck;
  });
  EXPECT_EQ(v.overall, Verdict::kBetter);
  EXPECT_EQ(v.against, "plain");
  const auto& r = row(v, "plain", "success");
  EXPECT_EQ(r.n, 30);
  EXPECT_DOUBLE_EQ(r.found, 1.0);
  EXPECT_NEAR(r.theirs, 1.0 / 3, 1e-12);
  EXPECT_LT(r.found_low, 1.0);
  EXPECT_LT(r.p, 1e-4);
  EXPECT_GT(r.p, 2.0 * std::pow(0.5, 20) * 0.99) << "Holm's correction makes it larger than the plain one";
  EXPECT_EQ(row(v, "plain", "time_to_goal_s").n, 10) << "only worlds where both arrive";
  ASSERT_EQ(v.constraints.size(), 1u);
  EXPECT_NE(v.constraints[0].find("collision <= 0.1: 0"), std::string::npos) << v.constraints[0];
  EXPECT_NE(v.constraints[0].find("kept"), std::string::npos);
  EXPECT_NE(table(v).find("better"), std::string::npos);
}

TEST_F(Judged, NoDifferenceShownByAHandfulOfWorlds) {
  const HeldOutVerdict v = judged([](const std::string& name, std::uint64_t world) {
    return world % 2 == 0 || (name == "plain-tuned" && world < 17) ? Outcome::kSuccess : Outcome::kStuck;
  });
  EXPECT_EQ(row(v, "plain", "success").verdict, Verdict::kNoDifference);
}

TEST_F(Judged, WorseWhenItCollides) {
  const HeldOutVerdict v = judged([](const std::string& name, std::uint64_t world) {
    if (name == "plain-tuned") return world % 2 == 0 ? Outcome::kCollision : Outcome::kSuccess;
    return world % 2 == 0 ? Outcome::kTimeout : Outcome::kStuck;
  });
  EXPECT_EQ(row(v, "plain", "success").verdict, Verdict::kBetter);
  EXPECT_EQ(row(v, "plain", "collision").verdict, Verdict::kWorse);
  EXPECT_EQ(v.overall, Verdict::kWorse) << "more successes do not pay for collisions";
  EXPECT_NE(v.constraints[0].find("broken"), std::string::npos);
}

TEST_F(Judged, ATrialThatEndsByAnErrorIsNoSuccess) {
  // Ten worlds by an error of the found gains, five others by one of theirs; of the rest all succeed.
  const HeldOutVerdict v = judged([&](const std::string& name, std::uint64_t world) {
    const std::uint64_t i = world - held_out.jobs.front().world;
    if (name == "plain-tuned") return i < 10 ? Outcome::kError : Outcome::kSuccess;
    return i >= 10 && i < 15 ? Outcome::kError : Outcome::kSuccess;
  });
  const auto& r = row(v, "plain", "success");
  EXPECT_EQ(r.n, 30);
  EXPECT_EQ(r.found, 20.0 / 30);
  EXPECT_EQ(r.theirs, 25.0 / 30);
  ASSERT_TRUE(v.success_without_errors.has_value());
  EXPECT_EQ(v.success_without_errors->n, 15);
  EXPECT_EQ(v.success_without_errors->b.rate, 1.0);
  EXPECT_EQ(v.errors, 15);
  EXPECT_NE(table(v).find("in 15 worlds a trial ended by an error, which is no success; without these worlds success "
                          "is 100.0 % against 100.0 %"),
            std::string::npos)
      << table(v);
  const HeldOutVerdict none = judged([](const std::string&, std::uint64_t) { return Outcome::kError; });
  EXPECT_EQ(row(none, "plain", "success").n, 30);
  EXPECT_EQ(row(none, "plain", "success").found, 0.0);
  EXPECT_NE(table(none).find("success is of none against of none"), std::string::npos) << table(none);
  EXPECT_EQ(none.overall, Verdict::kNoDifference);
}

TEST_F(Judged, WorseWhenItSucceedsLessOften) {
  const HeldOutVerdict v = judged([](const std::string& name, std::uint64_t) {
    return name == "plain-tuned" ? Outcome::kTimeout : Outcome::kSuccess;
  });
  EXPECT_EQ(v.overall, Verdict::kWorse);
  EXPECT_EQ(v.why, "success");
}

}  // namespace
}  // namespace moma::tune
