// Batches: order, stop, skip, errors, and the same rows for any number of threads.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstring>
#include <new>
#include <stdexcept>
#include <thread>

#include "eval/batch/batch.h"
#include "tests/eval/suite_fixture.h"
#include "tests/eval/trial_fixture.h"
#include "tests/support/filled.h"

namespace moma::test {
namespace {

SuitePoint tiny_point() { return {tiny_spec(), "scripted", "", nlohmann::ordered_json::object(), {}}; }

/// Trials that take no time: the scripted robot drives at a speed that depends on the world.
struct FastBatch {
  std::vector<SuitePoint> points{tiny_point(), tiny_point()};
  std::vector<BatchJob> jobs;
  BatchOptions options;

  explicit FastBatch(std::size_t worlds = 40) {
    for (std::uint64_t world = 0; world < worlds; ++world)
      for (std::size_t point = 0; point < points.size(); ++point)
        jobs.push_back({point, world, fmt::format("{}/{}", world, point)});
    options.world = [](const SuitePoint&, std::uint64_t index) {
      World world = tiny_world(0.1 + 0.001 * static_cast<double>(index));
      world.index = index;
      return std::make_shared<const World>(world);
    };
    options.parts.plant = [](const TrialSpec& p, const World& w) {
      return std::make_unique<FakePlant>(p.robot->model, w);
    };
    options.parts.controller = [](const TrialSpec& p) {
      return std::make_unique<ScriptedController>(
          p.robot->model->num_velocities(),
          [](const Observation& o, StepResult& r) { r.command[0] = o.goal.X_WG.translation().x() - 0.9 - o.base.x(); });
    };
  }

  std::size_t successes = 0;

  std::vector<std::size_t> run(int threads, BatchSummary* summary = nullptr) {
    options.threads = threads;
    std::vector<std::size_t> order;
    const BatchSummary done = run_batch(points, jobs, options, [&](const BatchJob& job, BatchResult&& result) {
      order.push_back(static_cast<std::size_t>(&job - jobs.data()));
      successes += result.output.row.outcome == Outcome::kSuccess ? 1 : 0;
      return true;
    });
    if (summary != nullptr) *summary = done;
    return order;
  }
};

TEST(Batch, DeliversEveryResultInOrder) {
  for (const int threads : {1, 2, 4, 16}) {
    FastBatch batch;
    BatchSummary summary;
    const std::vector<std::size_t> order = batch.run(threads, &summary);
    ASSERT_EQ(order.size(), 80u);
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
    EXPECT_EQ(summary.delivered, 80u);
    EXPECT_EQ(batch.successes, 80u);
    EXPECT_FALSE(summary.stopped);
  }
}

TEST(Batch, TheSinkIsNeverInTwoThreadsAndSlowTrialsDoNotReorder) {
  FastBatch batch(30);
  const auto quick = batch.options.world;
  batch.options.world = [quick](const SuitePoint& point, std::uint64_t index) {
    if (index % 7 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return quick(point, index);
  };
  batch.options.threads = 4;
  std::atomic<int> inside{0};
  std::size_t next = 0;
  run_batch(batch.points, batch.jobs, batch.options, [&](const BatchJob& job, BatchResult&& result) {
    EXPECT_EQ(inside.fetch_add(1), 0);
    EXPECT_EQ(&job, &batch.jobs[next++]);
    EXPECT_EQ(result.world->index, job.world);
    inside.fetch_sub(1);
    return true;
  });
  EXPECT_EQ(next, 60u);
}

TEST(Batch, SkipsKnownKeysAndComputesEqualOnesOnce) {
  FastBatch batch(10);
  batch.jobs[5].key = batch.jobs[4].key;
  const std::unordered_set<std::string> known{batch.jobs[0].key, batch.jobs[7].key, "not there"};
  batch.options.skip = &known;
  EXPECT_EQ(batch.run(2), (std::vector<std::size_t>{1, 2, 3, 4, 6, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19}));
}

TEST(Batch, StopFlagKeepsWhatIsDone) {
  for (const int threads : {1, 3}) {
    FastBatch batch(200);
    std::atomic<bool> stop{false};
    batch.options.stop = &stop;
    batch.options.threads = threads;
    std::size_t next = 0;
    const BatchSummary summary =
        run_batch(batch.points, batch.jobs, batch.options, [&](const BatchJob& job, BatchResult&&) {
          EXPECT_EQ(&job, &batch.jobs[next++]) << "a prefix of the jobs, without holes";
          if (next == 50) stop = true;
          return true;
        });
    EXPECT_TRUE(summary.stopped);
    EXPECT_EQ(summary.delivered, next);
    EXPECT_GE(next, 50u);
    EXPECT_LT(next, 100u);
  }
}

TEST(Batch, TheSinkEndsTheBatchAtTheSameJobForAnyNumberOfThreads) {
  for (const int threads : {1, 2, 8}) {
    FastBatch batch(100);
    batch.options.threads = threads;
    std::size_t seen = 0;
    const BatchSummary summary =
        run_batch(batch.points, batch.jobs, batch.options, [&](const BatchJob&, BatchResult&&) { return ++seen < 33; });
    EXPECT_EQ(seen, 33u);
    EXPECT_EQ(summary.delivered, 33u);
    EXPECT_TRUE(summary.stopped);
  }
}

TEST(Batch, AnExceptionOfTheSinkComesOut) {
  for (const int threads : {1, 4}) {
    FastBatch batch(50);
    batch.options.threads = threads;
    EXPECT_THROW(run_batch(batch.points, batch.jobs, batch.options,
                           [](const BatchJob&, BatchResult&&) -> bool { throw std::runtime_error("disk full"); }),
                 std::runtime_error);
  }
}

TEST(Batch, ATrialOrWorldThatFailsIsARow) {
  FastBatch batch(6);
  const auto good = batch.options.world;
  batch.options.world = [good](const SuitePoint& point, std::uint64_t index) {
    if (index == 2) throw GenerationError("no place for the table");
    return good(point, index);
  };
  const auto plant = batch.options.parts.plant;
  batch.options.parts.plant = [plant](const TrialSpec& point, const World& world) {
    if (world.index == 4) throw std::runtime_error("no wheels");
    return plant(point, world);
  };
  std::vector<std::string> reasons;
  std::size_t successes = 0;
  batch.options.threads = 2;
  const BatchSummary summary =
      run_batch(batch.points, batch.jobs, batch.options, [&](const BatchJob& job, BatchResult&& result) {
        if (result.output.row.outcome == Outcome::kError) reasons.push_back(result.output.row.reason);
        successes += result.output.row.outcome == Outcome::kSuccess ? 1 : 0;
        EXPECT_EQ(result.world == nullptr, job.world == 2);
        return true;
      });
  EXPECT_EQ(summary.delivered, 12u);
  EXPECT_EQ(successes, 8u);
  EXPECT_EQ(reasons, (std::vector<std::string>{"world 2: no place for the table", "world 2: no place for the table",
                                               "no wheels", "no wheels"}));
}

// A row would be kept for ever, though the machine was at fault and not the trial.
TEST(Batch, WithoutMemoryThereIsNoRow) {
  for (const int threads : {1, 3}) {
    for (const bool in_world : {false, true}) {
      FastBatch batch(20);
      batch.options.threads = threads;
      const auto world = batch.options.world;
      const auto plant = batch.options.parts.plant;
      batch.options.world = [=](const SuitePoint& point, std::uint64_t index) {
        if (in_world && index == 4) throw std::bad_alloc();
        return world(point, index);
      };
      batch.options.parts.plant = [=](const TrialSpec& spec, const World& made) {
        if (!in_world && made.index == 4) throw std::bad_alloc();
        return plant(spec, made);
      };
      std::size_t last = 0;
      EXPECT_THROW(run_batch(batch.points, batch.jobs, batch.options,
                             [&](const BatchJob& job, BatchResult&& result) {
                               EXPECT_NE(result.output.row.outcome, Outcome::kError);
                               last = std::max<std::size_t>(last, job.world);
                               return true;
                             }),
                   std::bad_alloc);
      EXPECT_LT(last, 4u);
    }
  }
}

TEST(Batch, ReportsProgressAndRefusesUnknownPoints) {
  FastBatch batch(10);
  std::size_t calls = 0;
  batch.options.progress = [&](const BatchProgress& progress) {
    EXPECT_EQ(progress.done, ++calls);
    EXPECT_EQ(progress.total, 20u);
    EXPECT_EQ(progress.successes, calls);
    EXPECT_GT(progress.rate, 0.0);
  };
  batch.run(2);
  EXPECT_EQ(calls, 20u);
  batch.jobs[3].point = 9;
  EXPECT_THROW(batch.run(1), std::invalid_argument);
}

TEST(Batch, JobsGoWorldByWorldAndPrefixesOfSeedsAgree) {
  SuiteFolder folder;
  const Suite suite = load_suite(folder.suite("", "{a: {}, b: {k_epsilon: 1}}"));
  const std::vector<BatchJob> jobs = make_jobs(suite.points, 0, suite.trials);
  ASSERT_EQ(jobs.size(), 20u);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    EXPECT_EQ(jobs[i].point, i % 2);
    EXPECT_EQ(jobs[i].world, i / 2);
    EXPECT_EQ(jobs[i].key, trial_key(suite.points[jobs[i].point], jobs[i].world));
  }
  const std::vector<BatchJob> later = make_jobs(suite.points, 4, 2);
  ASSERT_EQ(later.size(), 4u);
  EXPECT_EQ(later[0].key, jobs[8].key);
}

/// All bits of a trial but its timings.
std::string trial_bits(const BatchJob& job, const TrialOutput& output) {
  std::string text = job.key + own_bits_of(output.row);
  for (const Sample& sample : output.trace) text += bits_of(sample);
  return text;
}

std::vector<std::string> rows_of(const Suite& suite, int threads) {
  std::vector<std::string> rows;
  BatchOptions options;
  options.threads = threads;
  run_batch(suite.points, make_jobs(suite.points, 0, suite.trials), options,
            [&](const BatchJob& job, BatchResult&& result) {
              EXPECT_NE(result.output.row.outcome, Outcome::kError) << result.output.row.reason;
              rows.push_back(trial_bits(job, result.output));
              return true;
            });
  return rows;
}

TEST(Batch, ThreadsChangeNoBit) {
  for (const char* mode : {"kinematic", "dynamic"}) {
    const Suite suite = load_suite(
        MOMA_SOURCE_DIR "/configs/suites/demo.yaml",
        {{"simulation.mode", mode}, {"simulation.time_limit", "3"}, {"trials", mode[0] == 'k' ? "12" : "4"}});
    const std::vector<std::string> one = rows_of(suite, 1);
    EXPECT_EQ(one.size(), suite.points.size() * suite.trials);
    EXPECT_EQ(rows_of(suite, 2), one) << mode;
    EXPECT_EQ(rows_of(suite, 4), one) << mode;
  }
}

TEST(Batch, ResolvedSuiteGivesTheSameRows) {
  const Suite suite = load_suite(MOMA_SOURCE_DIR "/configs/suites/demo.yaml",
                                 {{"simulation.mode", "kinematic"}, {"simulation.time_limit", "3"}, {"trials", "6"}});
  const Suite again = suite_from_resolved(nlohmann::ordered_json::parse(suite.resolved.dump()));
  EXPECT_EQ(rows_of(again, 2), rows_of(suite, 2));
}

}  // namespace
}  // namespace moma::test
