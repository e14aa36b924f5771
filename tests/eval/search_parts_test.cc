#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "eval/search/nlopt_run.h"
#include "eval/search/random.h"
#include "eval/search/sensitivity.h"
#include "eval/search/variables.h"
#include "eval/stats/intervals.h"
#include "tests/eval/search_objectives.h"

namespace moma::tune {
namespace {

TEST(Wilcoxon, CountsSignPatterns) {
  // All of n positive: one pattern of 2^n.
  EXPECT_DOUBLE_EQ(stats::wilcoxon_greater(std::vector<double>{1, 2, 3, 4, 5}), 1.0 / 32);
  EXPECT_DOUBLE_EQ(stats::wilcoxon_greater(std::vector<double>{-1, -2, -3, -4, -5}), 1.0);
  // W+ = 5 of 1..3: patterns {2,3}, {1,2,3}.
  EXPECT_DOUBLE_EQ(stats::wilcoxon_greater(std::vector<double>{-1, 2, 3}), 2.0 / 8);
  // Zeros do not count; nothing left is no evidence.
  EXPECT_DOUBLE_EQ(stats::wilcoxon_greater(std::vector<double>{0, -1, 2, 0, 3}), 2.0 / 8);
  EXPECT_DOUBLE_EQ(stats::wilcoxon_greater(std::vector<double>{0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(stats::wilcoxon_greater(std::vector<double>{}), 1.0);
}

// Hollander & Wolfe's depression scores, as in the manual of R's wilcox.test: V = 40, one-sided p = 0.01953.
TEST(Wilcoxon, AgreesWithAPublishedExample) {
  const std::vector<double> before{1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  const std::vector<double> after{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  std::vector<double> d;
  for (std::size_t i = 0; i < before.size(); ++i) d.push_back(before[i] - after[i]);
  EXPECT_NEAR(stats::wilcoxon_greater(d), 10.0 / 512, 1e-12);
}

double by_enumeration(const std::vector<double>& d) {
  const auto weight = [&](unsigned signs) {
    double sum = 0.0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      if (((signs >> i) & 1u) == 0) continue;
      double below = 0.0, equal = 0.0;
      for (const double other : d) {
        below += std::abs(other) < std::abs(d[i]) ? 1.0 : 0.0;
        equal += std::abs(other) == std::abs(d[i]) ? 1.0 : 0.0;
      }
      sum += below + (equal + 1.0) / 2.0;
    }
    return sum;
  };
  unsigned own = 0;
  for (std::size_t i = 0; i < d.size(); ++i) own |= d[i] > 0 ? 1u << i : 0u;
  int above = 0;
  for (unsigned signs = 0; signs < (1u << d.size()); ++signs) above += weight(signs) >= weight(own) ? 1 : 0;
  return above / static_cast<double>(1u << d.size());
}

TEST(Wilcoxon, ExactWithTiesByEnumeration) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    std::vector<double> d;
    for (std::uint64_t i = 0; i < 9; ++i) {
      double value = std::floor(7.0 * uniform(seed, SearchStream::kStarts, i)) - 2.5;
      d.push_back(value);
    }
    EXPECT_NEAR(stats::wilcoxon_greater(d), by_enumeration(d), 1e-12);
  }
}

TEST(Wilcoxon, NormalApproximationJoinsTheExactOne) {
  std::vector<double> d;
  for (int i = 1; i <= 50; ++i) d.push_back(i % 3 == 0 ? -i : i);
  const double exact = stats::wilcoxon_greater(d);
  d.push_back(0.5);  // 51 differences: the approximation; the least rank hardly matters
  EXPECT_NEAR(stats::wilcoxon_greater(d), exact, 0.1 * exact);
}

TEST(Wilcoxon, FalseAlarmsAreAsRareAsItSays) {
  int alarms = 0;
  for (std::uint64_t trial = 0; trial < 4000; ++trial) {
    std::vector<double> d;
    for (std::uint64_t i = 0; i < 40; ++i) d.push_back(uniform(trial, SearchStream::kStarts, i) - 0.5);
    alarms += stats::wilcoxon_greater(d) < 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(alarms / 4000.0, 0.05, 0.014);  // four standard errors
}

TEST(TuneVariables, UnitCubeAndBack) {
  const Variable log{"k", 0.001, 1000, Scale::kLog, 1};
  EXPECT_DOUBLE_EQ(from_unit(log, 0.5), 1.0);
  EXPECT_DOUBLE_EQ(from_unit(log, 0.0), 0.001);
  EXPECT_DOUBLE_EQ(from_unit(log, 1.0), 1000.0);
  EXPECT_NEAR(to_unit(log, 10.0), 4.0 / 6, 1e-12);
  const Variable whole{"n", 1, 9, Scale::kInteger, 1};
  EXPECT_EQ(from_unit(whole, 0.49), 5.0);
  for (double u = 0.0; u <= 1.0; u += 0.013) {
    const double value = from_unit(log, u);
    EXPECT_NEAR(to_unit(log, value), u, 1e-6);
    EXPECT_EQ(from_unit(log, to_unit(log, value)), value) << "rounded values are fixed points";
    EXPECT_EQ(std::stod(to_text(value)), value);
    EXPECT_LE(to_text(value).size(), 11u);
  }
}

TEST(TuneAlgorithms, NamesWithAndWithoutPrefix) {
  EXPECT_EQ(find_algorithm("CRS2_LM").name, "GN_CRS2_LM");
  EXPECT_EQ(find_algorithm("gn_crs2_lm").name, "GN_CRS2_LM");
  EXPECT_EQ(find_algorithm("SBPLX").name, "LN_SBPLX");
  const auto refused = [](const char* name) {
    try {
      find_algorithm(name);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused("LD_MMA").find("known are CRS2_LM, "), std::string::npos);
  EXPECT_NE(refused("BOBYQQ").find("did you mean BOBYQA?"), std::string::npos);
}

TEST(TuneRandom, ShuffleIsAPermutationDecidedBySeedAndPart) {
  std::vector<std::uint64_t> a, b, c;
  for (std::uint64_t i = 0; i < 50; ++i) a.push_back(i);
  b = c = a;
  shuffle(a, 1, 0);
  shuffle(b, 1, 0);
  shuffle(c, 1, 1);
  EXPECT_EQ(a, b);
  EXPECT_NE(a, c);
  EXPECT_EQ(std::set<std::uint64_t>(a.begin(), a.end()).size(), 50u);
}

TEST(TuneNloptScores, NoCutCandidateLooksBetterThanAFullOneInAnyOrder) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    NloptScores told;
    double worst_full = -1e300, best_cut = 1e300;
    for (std::uint64_t i = 0; i < 60; ++i) {
      const bool cut = uniform(seed, SearchStream::kStarts, 2 * i) < 0.5;
      const double value = told(10.0 * uniform(seed, SearchStream::kStarts, 2 * i + 1), cut);
      if (cut) best_cut = std::min(best_cut, value);
      if (!cut) worst_full = std::max(worst_full, value);
      EXPECT_GE(best_cut, worst_full);
    }
  }
}

TEST(TuneImportance, FindsWhatMattersAndNothingElse) {
  // y = 3 x0 + x1 + noise, x2 idle: exact first-order shares of the values are 9 : 1 : 0 with the noise's 0.5.
  std::vector<Variable> variables{
      {"x0", 0, 1, Scale::kLinear, 0}, {"x1", 0, 1, Scale::kLinear, 0}, {"x2", 0, 1, Scale::kLinear, 0}};
  std::deque<Evaluation> history;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Evaluation e;
    e.phase = Phase::kGlobal;
    for (std::uint64_t k = 0; k < 3; ++k) e.candidate.push_back(uniform(7, SearchStream::kStarts, 3 * i + k));
    e.merit = 3 * e.candidate[0] + e.candidate[1] + 0.7 * (uniform(8, SearchStream::kStarts, i) - 0.5);
    history.push_back(e);
  }
  const std::vector<double> share = importance(variables, history);
  EXPECT_NEAR(share[0], 0.86, 0.06);
  EXPECT_NEAR(share[1], 0.096, 0.04);
  EXPECT_LT(share[2], 0.01);

  history.resize(20);
  EXPECT_TRUE(std::isnan(importance(variables, history)[0])) << "too few to say";
}

TEST(TuneImportance, DividesWhatGainsThatMoveTogetherExplain) {
  std::vector<Variable> variables{{"x0", 0, 1, Scale::kLinear, 0}, {"x1", 0, 1, Scale::kLinear, 0}};
  std::deque<Evaluation> history;
  for (std::uint64_t i = 0; i < 500; ++i) {
    Evaluation e;
    e.phase = Phase::kGlobal;
    const double x = uniform(7, SearchStream::kStarts, i);
    e.candidate = {x, std::clamp(x + 0.2 * (uniform(9, SearchStream::kStarts, i) - 0.5), 0.0, 1.0)};
    e.merit = e.candidate[0];
    history.push_back(e);
  }
  const std::vector<double> share = importance(variables, history);
  EXPECT_GT(share[0], 0.85) << "x1 only follows x0";
  EXPECT_LT(share[0] + share[1], 1.0 + 1e-9);
}

TEST(TuneSensitivity, SeesCurvatureAndInteraction) {
  // Cost (u - 1/2)^2 ... with a cross term 4 (x - .5)(y - .5): interaction at +-0.1 is 4 * 0.01.
  testing::TestObjective objective([](const Candidate& c, std::uint64_t world) {
    const double x = c[0] - 0.5, y = c[1] - 0.5;
    return std::vector<double>{10 * x * x + 5 * y * y + 4 * x * y + static_cast<double>(world % 5)};
  });
  testing::MemoryLog log;
  SearchSettings settings;
  settings.variables = {
      {"x", 0, 1, Scale::kLinear, 0.5}, {"y", 0, 1, Scale::kLinear, 0.5}, {"z", 0, 1, Scale::kLinear, 1.0}};
  for (std::uint64_t w = 0; w < 20; ++w) settings.worlds.push_back(w);
  settings.budget = 1000;
  Evaluator evaluator(settings, objective, log);
  const Candidate found{0.5, 0.5, 1.0};
  evaluator.score(found, Phase::kStart, 0);
  const Sensitivity result = sensitivity({}, found, evaluator);
  ASSERT_EQ(result.steps.size(), 4u + 4u + 2u) << "a gain at its bound moves to one side only";
  for (const SensitivityStep& step : result.steps) {
    const double d = step.value - found[step.variable];
    EXPECT_NEAR(step.change, step.variable == 0 ? 10 * d * d : step.variable == 1 ? 5 * d * d : 0.0, 1e-9);
    EXPECT_NEAR(step.error, 0.0, 1e-9) << "the worlds' own differences cancel in pairs";
  }
  ASSERT_FALSE(result.pairs.empty());
  EXPECT_NEAR(result.pairs.front().interaction, 0.04, 1e-9);
}

}  // namespace
}  // namespace moma::tune
