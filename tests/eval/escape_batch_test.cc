// Detours and looking ahead in real trials: the same bits for any number of threads, and for a run
// that was stopped and gone on with, in rows and in traces.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "eval/batch/batch.h"
#include "tests/eval/suite_fixture.h"
#include "tests/support/filled.h"

namespace moma::test {
namespace {

struct Trials {
  std::vector<TrialOutput> trials;
  long on_detour = 0;
};

// From the `first` job on, and no more than `most` results.
void run(const Suite& suite, int threads, Trials& out, std::size_t first = 0, std::size_t most = 1000) {
  BatchOptions options;
  options.threads = threads;
  std::vector<BatchJob> jobs = make_jobs(suite.points, 0, suite.trials);
  jobs.erase(jobs.begin(), jobs.begin() + static_cast<std::ptrdiff_t>(first));
  std::size_t taken = 0;
  run_batch(suite.points, jobs, options, [&](const BatchJob&, BatchResult&& result) {
    if (taken++ >= most) return false;
    for (const Sample& sample : result.output.trace) out.on_detour += sample.escape.detour ? 1 : 0;
    out.trials.push_back(std::move(result.output));
    return true;
  });
}

Suite load(SuiteFolder& folder, const std::string& controller, const std::string& changes = "") {
  const std::string configs = MOMA_SOURCE_DIR "/configs/";
  return load_suite(folder.write(controller + "-suite.yaml",
                                 "robot: " + configs + "robots/frankie.yaml\n" + "controllers: {one: {include: " +
                                     configs + "controllers/" + controller + ".yaml" + changes + "}}\n" + R"(
worlds: {seed: 3, families: {clutter: {weight: 3}, moving: {weight: 1}}}
simulation: {mode: kinematic, time_limit: 20}
trials: 12
)"));
}

void expect_equal(const Trials& one, const Trials& four) {
  ASSERT_EQ(one.trials.size(), four.trials.size());
  for (std::size_t i = 0; i < one.trials.size(); ++i) {
    const TrialOutput& a = one.trials[i];
    const TrialOutput& b = four.trials[i];
    EXPECT_EQ(a.row.outcome, b.row.outcome) << i;
    ASSERT_EQ(a.trace.size(), b.trace.size()) << i;
    for (std::size_t k = 0; k < a.trace.size(); ++k) {
      ASSERT_EQ(a.trace[k].command, b.trace[k].command) << "trial " << i << " step " << k;
      ASSERT_EQ(a.trace[k].q, b.trace[k].q) << "trial " << i << " step " << k;
      ASSERT_EQ(std::bit_cast<std::uint64_t>(a.trace[k].escape.best),
                std::bit_cast<std::uint64_t>(b.trace[k].escape.best));
      ASSERT_EQ(a.trace[k].escape.target_W, b.trace[k].escape.target_W);
      ASSERT_EQ(a.trace[k].escape.stagnations, b.trace[k].escape.stagnations);
      ASSERT_EQ(bits_of(a.trace[k].plan), bits_of(b.trace[k].plan)) << "trial " << i << " step " << k;
    }
  }
}

TEST(EscapeBatch, OneAndFourThreadsGiveTheSameBits) {
  SuiteFolder folder;
  const Suite suite = load(folder, "moma-reactive");
  Trials one, four;
  run(suite, 1, one);
  run(suite, 4, four);
  EXPECT_GT(one.on_detour, 50);
  expect_equal(one, four);
}

/// What the samples say of the plan goes together with itself and with where the robot is.
void expect_told(const Trials& trials) {
  int following = 0, choices = 0;
  double moves = 0.0;
  for (const TrialOutput& trial : trials.trials) {
    const Trace& trace = trial.trace;
    for (std::size_t k = 1; k < trace.size(); ++k) {
      const PlanBrief& plan = trace[k].plan;
      const PlanVerdict& choice = plan.choice;
      const std::string where = "step " + std::to_string(k) + " of " + std::to_string(trace.size());
      if (trace[k - 1].plan.choice.tried != choice.tried || trace[k - 1].plan.choice.kind != choice.kind) ++choices;
      ASSERT_EQ(choice.tried > 0, choice.kind != PlanKind::kNone) << where;
      ASSERT_NE(choice.kind, PlanKind::kDetour) << where;
      const double times[] = {kInfinity, choice.policy, kInfinity, choice.by_path};
      for (const double time : times)
        if (choice.tried > 0 && time >= 0.0) {
          ASSERT_LE(times[static_cast<int>(choice.kind)], time) << "the quickest was chosen: " << where;
        }
      if (plan.mode == PlanMode::kDirect) {
        ASSERT_EQ(plan.duration, 0.0) << where;
        ASSERT_EQ(plan.target.norm() + plan.end.norm(), 0.0) << where;
      }
      if (plan.mode != PlanMode::kFollow) continue;
      ++following;
      if (plan.reason != PlanReason::kDirectWay) {
        ASSERT_EQ(choice.kind, PlanKind::kPath) << where;
      }
      ASSERT_GT(plan.duration, 0.0) << where;
      ASSERT_LE(plan.clock, plan.duration) << where;
      // The base is as far from where the path has it as it is said to lag, but for the way of a period or two. A path
      // that is chosen while the robot slows down begins where it will stand.
      if (trace[k - 1].plan.mode != PlanMode::kFollow) continue;
      ASSERT_LE((trace[k].base - plan.target).head<2>().norm(), plan.lag + 0.08) << where;
      // And the path ends no further away than it can be driven in what is left of it.
      constexpr double kFastest = 2.0;  // [m/s]
      ASSERT_LE((plan.end - plan.target).head<2>().norm(), kFastest * (plan.duration - plan.clock) + 1e-9) << where;
      moves = std::max(moves, (plan.end - plan.target).head<2>().norm());
    }
  }
  EXPECT_GT(following, 50);
  EXPECT_GT(moves, 0.5);
  EXPECT_GT(choices, 4);
}

TEST(AheadBatch, OneAndFourThreadsAndARunInTwoPartsGiveTheSameBits) {
  SuiteFolder folder;
  const Suite suite = load(folder, "moma-ahead");
  Trials one, four, parts, without;
  run(suite, 1, one);
  expect_told(one);
  run(suite, 4, four);
  expect_equal(one, four);
  run(suite, 2, parts, 0, 5);
  ASSERT_EQ(parts.trials.size(), 5u);
  run(suite, 3, parts, 5);
  expect_equal(one, parts);
  // It did look ahead: most of these trials are others without.
  run(load(folder, "moma-ahead", ", plan: {enabled: false}"), 4, without);
  int others = 0;
  for (std::size_t i = 0; i < one.trials.size(); ++i)
    others += one.trials[i].trace.size() != without.trials[i].trace.size() ? 1 : 0;
  EXPECT_GT(others, 4);
}

}  // namespace
}  // namespace moma::test
