// Detours, vortex and end rows in real trials: the same bits for any number of threads, in rows and in traces.
#include <gtest/gtest.h>

#include <bit>

#include "eval/batch/batch.h"
#include "tests/eval/suite_fixture.h"

namespace moma::test {
namespace {

struct Trials {
  std::vector<TrialOutput> trials;
  long on_detour = 0, circling = 0;
};

Trials run(const Suite& suite, int threads) {
  Trials out;
  BatchOptions options;
  options.threads = threads;
  run_batch(suite.points, make_jobs(suite), options, [&](const BatchJob&, BatchResult&& result) {
    for (const Sample& sample : result.output.trace) {
      out.on_detour += sample.escape.detour ? 1 : 0;
      out.circling += sample.escape.circulation != 0 ? 1 : 0;
    }
    out.trials.push_back(std::move(result.output));
    return true;
  });
  return out;
}

TEST(EscapeBatch, OneAndFourThreadsGiveTheSameBits) {
  SuiteFolder folder;
  const std::string configs = MOMA_SOURCE_DIR "/configs/";
  const Suite suite = load_suite(folder.write("escape.yaml", "robot: " + configs + "robots/frankie.yaml\n" +
                                                                 "controllers: {moma: " + configs +
                                                                 "controllers/moma-reactive.yaml}\n" + R"(
worlds: {seed: 3, families: {clutter: {weight: 3}, moving: {weight: 1}}}
simulation: {mode: kinematic, time_limit: 10}
trials: 12
)"));
  const Trials one = run(suite, 1);
  const Trials four = run(suite, 4);
  EXPECT_GT(one.on_detour, 50);
  EXPECT_GT(one.circling, 50);
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
    }
  }
}

}  // namespace
}  // namespace moma::test
