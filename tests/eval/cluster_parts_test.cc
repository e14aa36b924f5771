// Parts of distributed runs that need no MPI: what goes over the wire, computers that get lost, the sequential rule.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <set>
#include <thread>

#include "eval/batch/sequential.h"
#include "eval/batch/wire.h"
#include "eval/stats/intervals.h"
#include "eval/store/columns.h"
#include "store_fixture.h"
#include "suite_fixture.h"
#include "tests/support/filled.h"
#include "world/world_json.h"

namespace moma::test {
namespace {

TEST(Wire, EveryBitArrives) {
  const SuiteFolder folder;
  const Suite suite = load_suite(folder.suite());
  BatchResult result;
  result.world = std::make_shared<const World>(suite.points[0].worlds.make(suite.points[0].robot->model, 3));
  Filler filler(1.0);
  filler.fill(result.output.row);
  result.output.row.reason.clear();
  result.output.row.clearance_min_m = std::nextafter(0.1, 1.0);
  result.output.row.slack_max = kAbsent;
  result.output.trace.resize(9);
  for (Sample& sample : result.output.trace) filler.fill(sample);
  result.output.trace[4].least_distance = std::numeric_limits<double>::infinity();
  result.metrics = {0.1, kAbsent, -0.0};
  result.profile.trials = 1;
  result.profile.steps = 8;
  for (std::size_t i = 0; i < Profile::kParts; ++i)
    result.profile.parts[i] = {static_cast<std::int64_t>(1000 + i), static_cast<std::int64_t>(i)};
  const Bytes bytes = encode_result(77, result);
  const DecodedResult back = decode_result(bytes);
  EXPECT_EQ(back.place, 77u);
  EXPECT_EQ(to_json(*back.result.world).dump(), to_json(*result.world).dump());
  // By the description, which names every member (row_test.cc).
  EXPECT_EQ(bits_of(back.result.output.row), bits_of(result.output.row));
  ASSERT_EQ(back.result.output.trace.size(), 9u);
  for (std::size_t k = 0; k < 9; ++k)
    EXPECT_EQ(bits_of(back.result.output.trace[k]), bits_of(result.output.trace[k])) << k;
  ASSERT_EQ(back.result.metrics.size(), 3u);
  EXPECT_EQ(back.result.metrics[0], 0.1);
  EXPECT_TRUE(std::isnan(back.result.metrics[1]));
  EXPECT_EQ(back.result.profile.steps, 8);
  EXPECT_EQ(back.result.profile[TrialPart::kStore].nanoseconds, static_cast<std::int64_t>(1000 + Profile::kParts - 1));
  EXPECT_EQ(encode_result(77, back.result), bytes);
  for (std::size_t cut = 0; cut < bytes.size(); cut += 7)
    EXPECT_THROW(decode_result(std::span(bytes).first(cut)), std::exception) << cut;
  // The outcome, a word, lies behind the place and the world.
  const std::size_t outcome = 16 + to_json(*result.world).dump().size();
  for (const int wrong : {-1, 1000}) {
    Bytes other = bytes;
    std::memcpy(other.data() + outcome, &wrong, sizeof wrong);
    EXPECT_THROW(decode_result(other), std::runtime_error) << wrong;
  }
}

// Takes jobs as a rank would, and gives some back as a lost one's would be.
class FakeRanks final : public RemoteCompute {
 public:
  FakeRanks(const Suite& suite, bool loses) : suite_(suite), loses_(loses) {}
  std::size_t capacity() const override { return 4; }
  void serve(JobBoard& board) override {
    std::set<std::size_t> given_back;
    while (!board.closed()) {
      const auto place = board.try_take();
      if (!place) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      ++taken;
      if (loses_ && given_back.insert(*place).second && *place % 3 == 0) {
        board.give_back(*place);
        continue;
      }
      const BatchJob& job = board.job(*place);
      board.put(*place, compute_job(suite_.points[job.point], job, options_));
    }
  }
  std::size_t taken = 0;

 private:
  const Suite& suite_;
  bool loses_;
  BatchOptions options_;
};

std::vector<TrialRow> rows_of(const Suite& suite, const BatchOptions& options) {
  std::vector<TrialRow> rows;
  const std::vector<BatchJob> jobs = make_jobs(suite.points, 0, suite.trials);
  const BatchSummary summary = run_batch(suite.points, jobs, options, [&](const BatchJob& job, BatchResult&& result) {
    EXPECT_EQ(job.key, jobs[rows.size()].key) << "in the order of the jobs";
    rows.push_back(std::move(result.output.row));
    return true;
  });
  EXPECT_EQ(summary.delivered, jobs.size());
  EXPECT_FALSE(summary.stopped);
  return rows;
}

TEST(RemoteCompute, RowsAndTheirOrderAreThoseOfOneProcess) {
  const SuiteFolder folder;
  const Suite suite = load_suite(folder.suite("samples: none\n"), {{"trials", "12"}, {"simulation.time_limit", "1"}});
  BatchOptions alone;
  alone.threads = 1;
  const std::vector<TrialRow> expected = rows_of(suite, alone);
  for (const bool loses : {false, true}) {
    FakeRanks ranks(suite, loses);
    BatchOptions options;
    options.threads = 2;
    options.remote = &ranks;
    const std::vector<TrialRow> rows = rows_of(suite, options);
    ASSERT_EQ(rows.size(), expected.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      EXPECT_EQ(store::differences(rows[i], expected[i]), std::vector<std::string>{}) << i;
  }
}

TEST(Sequential, ErrorsAreNoSuccess) {
  SequentialRule rule({"success", 0.08, 1000, 100}, 1);
  for (int i = 0; i < 100; ++i) rule.add(0, i < 60 ? Outcome::kError : i < 80 ? Outcome::kSuccess : Outcome::kStuck);
  rule.end_block(100);
  const stats::Interval interval = stats::wilson(20, 100);
  EXPECT_DOUBLE_EQ(rule.half_width(), (interval.high - interval.low) / 2) << "of a hundred trials, not of forty";
}

TEST(Sequential, LooksOnlyAtTheEndsOfBlocks) {
  SequentialRule rule({"success", 0.1, 1000, 100}, 2);
  EXPECT_EQ(rule.next_block(), 100u);
  for (int w = 0; w < 100; ++w) {
    rule.add(0, Outcome::kSuccess);                                     // narrow at once
    rule.add(1, w % 2 == 0 ? Outcome::kSuccess : Outcome::kCollision);  // the widest there is
  }
  rule.end_block(100);
  // 1.96 sqrt(0.25 / (100 + 1.96^2)), Wilson at one half.
  EXPECT_NEAR(rule.half_width(), 1.959963984540054 * 0.5 / std::sqrt(100 + 3.8414588206941245), 1e-12);
  EXPECT_TRUE(rule.reached());
  EXPECT_EQ(rule.next_block(), 0u);
  SequentialRule narrow({"success", 0.01, 250, 100}, 1);
  std::vector<std::uint64_t> blocks;
  for (std::uint64_t n = narrow.next_block(); n > 0; n = narrow.next_block()) {
    blocks.push_back(n);
    for (std::uint64_t w = 0; w < n; ++w) narrow.add(0, w % 2 == 0 ? Outcome::kSuccess : Outcome::kStuck);
    narrow.end_block(n);
  }
  EXPECT_EQ(blocks, (std::vector<std::uint64_t>{100, 100, 50}));
  EXPECT_FALSE(narrow.reached());
}

/// What the rule does to one point whose metric has the rate `p`: exact, by running the distribution of the count
/// from look to look. O(max^2).
struct StoppedCoverage {
  double coverage = 0.0;     ///< probability that the interval at the end holds p
  double mean_worlds = 0.0;  ///< expected worlds
};
StoppedCoverage stopped_coverage(const UntilRule& rule, double p) {
  StoppedCoverage result;
  std::vector<double> open{1.0};  // probability of each count among the samples that go on
  for (std::uint64_t n = 0; n < rule.max;) {
    const std::uint64_t block = std::min(rule.block, rule.max - n);
    for (std::uint64_t i = 0; i < block; ++i) {  // one more world
      open.push_back(0.0);
      for (std::size_t k = open.size() - 1; k > 0; --k) open[k] = open[k] * (1.0 - p) + open[k - 1] * p;
      open[0] *= 1.0 - p;
    }
    n += block;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const stats::Interval interval = stats::wilson(static_cast<std::int64_t>(k), static_cast<std::int64_t>(n));
      if (n < rule.max && (interval.high - interval.low) / 2 > rule.half_width) continue;
      if (interval.low <= p && p <= interval.high) result.coverage += open[k];
      result.mean_worlds += static_cast<double>(n) * open[k];
      open[k] = 0.0;
    }
  }
  return result;
}

TEST(Sequential, CoverageIsExactAndNearTheFixedOne) {
  // With one look it is the coverage of Wilson's interval, a sum of binomial probabilities.
  const UntilRule one_look{"success", 0.001, 50, 50};
  EXPECT_NEAR(stopped_coverage(one_look, 0.5).mean_worlds, 50.0, 1e-9);
  EXPECT_NEAR(stopped_coverage(one_look, 0.5).coverage, 0.9350913529, 1e-9);  // binomial pmf, summed apart
  // The default rule: what docs/reference/store.md states.
  const UntilRule usual{"success", 0.02, 3000, 100};
  for (const double p : {0.5, 0.7, 0.9, 0.95, 0.98}) {
    const StoppedCoverage found = stopped_coverage(usual, p);
    EXPECT_GT(found.coverage, 0.93) << p;
    EXPECT_LT(found.coverage, 0.975) << p;
  }
}

}  // namespace
}  // namespace moma::test
