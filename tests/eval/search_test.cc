#include "eval/search/search.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "tests/eval/search_objectives.h"

namespace moma::tune {
namespace {

using testing::bowl_regret;
using testing::bowl_trial;
using testing::bowl_variables;
using testing::MemoryLog;
using testing::TestObjective;

std::vector<std::uint64_t> worlds(std::uint64_t first, std::size_t count) {
  std::vector<std::uint64_t> result(count);
  std::iota(result.begin(), result.end(), first);
  return result;
}

SearchSettings bowl(std::uint64_t seed, std::uint64_t budget = 20000) {
  SearchSettings s;
  s.variables = bowl_variables();
  s.worlds = worlds(1000 * seed, 100);
  s.confirm_worlds = worlds(1000 * seed + 100, 100);
  s.budget = budget;
  s.seed = seed;
  s.sensitivity.enabled = false;
  return s;
}

SearchSettings quick(std::uint64_t seed) {
  SearchSettings s = bowl(seed, 1500);
  s.worlds.resize(20);
  s.confirm_worlds.resize(20);
  s.sensitivity.enabled = true;
  return s;
}

std::string message(const SearchSettings& settings) {
  TestObjective objective(bowl_trial, 1 + settings.constraints.size());
  MemoryLog log;
  try {
    search(settings, objective, log);
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(objective.measured, 0u) << "bad settings must be found before anything is measured";
    return error.what();
  }
  return "";
}

TEST(TuneSearch, DefaultPlanFindsTheOptimumOfANoisyObjective) {
  int found = 0;
  const double start = bowl_regret(start_of(bowl_variables()));
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    TestObjective objective(bowl_trial);
    MemoryLog log;
    const SearchSettings settings = bowl(seed);
    const SearchResult result = search(settings, objective, log);
    const double regret = bowl_regret(result.found);
    // 2 % of where it began; one percent of failures is worth 0.5.
    if (regret < 0.02 * start) ++found;
    EXPECT_LE(result.trials, settings.budget);
    EXPECT_EQ(objective.measured, result.trials) << "every measurement counts, none is made twice";
  }
  EXPECT_GE(found, 9) << "of 10 seeds";
}

TEST(TuneSearch, CuttingShortSavesAThirdAtEqualResult) {
  double with = 0.0, without = 0.0;
  std::uint64_t used = 0, saved = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SearchSettings settings = bowl(seed, 12000);
    TestObjective raced(bowl_trial);
    MemoryLog log;
    const SearchResult result = search(settings, raced, log);
    with += bowl_regret(result.found);
    used += result.trials;
    saved += result.trials_saved;
    settings.racing.enabled = false;
    TestObjective full(bowl_trial);
    MemoryLog other;
    const SearchResult plain = search(settings, full, other);
    EXPECT_EQ(plain.trials_saved, 0u);
    EXPECT_EQ(plain.evaluations_cut, 0u);
    without += bowl_regret(plain.found);
  }
  EXPECT_GE(static_cast<double>(saved), 0.3 * static_cast<double>(used + saved));
  EXPECT_LE(with, without + 0.5) << "sums of regrets over 5 seeds";
}

TEST(TuneSearch, KilledTenTimesAndResumedEqualsUndisturbed) {
  SearchSettings settings = quick(3);
  settings.starts = 2;
  TestObjective whole(bowl_trial);
  MemoryLog undisturbed;
  const SearchResult expected = search(settings, whole, undisturbed);

  MemoryLog log;
  int kills = 0;
  std::uint64_t measured = 0;
  for (std::uint64_t limit = whole.measured / 11;; ++kills) {
    TestObjective objective(bowl_trial);
    if (kills < 10) objective.stop_after = limit;
    try {
      const SearchResult resumed = search(settings, objective, log);
      measured += objective.measured;
      EXPECT_EQ(resumed, expected);
      break;
    } catch (const testing::Interrupted&) {
      measured += objective.measured;
    }
  }
  EXPECT_EQ(kills, 10);
  // What the log holds is not measured again; only the evaluation in flight is.
  EXPECT_LE(measured, whole.measured + 10 * settings.worlds.size());
  EXPECT_EQ(log.kept, undisturbed.kept);
}

TEST(TuneSearch, EveryAlgorithmRunsRepeatsAndResumes) {
  for (const AlgorithmInfo& info : algorithms()) {
    SCOPED_TRACE(info.name);
    SearchSettings settings = quick(5);
    settings.sensitivity.enabled = false;
    settings.plan = {&info};
    TestObjective first(bowl_trial), second(bowl_trial), resumed(bowl_trial);
    MemoryLog a, b;
    const SearchResult result = search(settings, first, a);
    EXPECT_GT(result.history.size(), 10u);
    EXPECT_LE(result.finalists.front().search_merit, result.history.front().merit);
    EXPECT_EQ(search(settings, second, b), result);
    EXPECT_EQ(search(settings, resumed, a), result);
    EXPECT_EQ(resumed.measured, 0u) << "all of it was in the log";
    for (const Evaluation& e : result.history) {
      for (std::size_t i = 0; i < e.candidate.size(); ++i) {
        ASSERT_GE(e.candidate[i], settings.variables[i].lower);
        ASSERT_LE(e.candidate[i], settings.variables[i].upper);
      }
    }
  }
}

TEST(TuneSearch, SeedDecidesThePathOfRandomAlgorithms) {
  SearchSettings settings = quick(1);
  TestObjective a(bowl_trial), b(bowl_trial);
  MemoryLog la, lb;
  const SearchResult one = search(settings, a, la);
  settings.seed = 2;
  EXPECT_NE(search(settings, b, lb).history, one.history);
}

TEST(TuneSearch, CutCandidatesAreNeitherBestNorFinalists) {
  SearchSettings settings = bowl(2, 8000);
  TestObjective objective(bowl_trial);
  MemoryLog log;
  const SearchResult result = search(settings, objective, log);
  EXPECT_GT(result.evaluations_cut, 5u);
  for (const Finalist& finalist : result.finalists) {
    const auto found = std::find_if(result.history.begin(), result.history.end(),
                                    [&](const Evaluation& e) { return e.candidate == finalist.candidate; });
    ASSERT_NE(found, result.history.end());
    EXPECT_FALSE(found->cut);
  }
  double best = 1e300;
  for (const Evaluation& e : result.history) {
    if (e.phase != Phase::kGlobal && e.phase != Phase::kLocal && e.phase != Phase::kStart) continue;
    if (e.cut) {
      EXPECT_GT(e.merit, best) << "a cut candidate's estimate is worse than the best of its time";
    } else {
      best = std::min(best, e.merit);
    }
  }
}

TEST(TuneSearch, PrefersAPlateauToASpike) {
  // A needle of cost 3 in a bowl whose flat bottom, elsewhere, costs 4. Each candidate has its own luck in each
  // world; without it every other candidate would rightly be cut short against the needle.
  const auto function = [](const Candidate& c, std::uint64_t world) -> std::vector<double> {
    const double needle = std::max(std::abs(c[0] - 0.5), std::abs(c[1] - 0.5));
    const double wide = std::max({0.0, std::abs(c[0] - 0.15) - 0.1, std::abs(c[1] - 0.8) - 0.1});
    const double cost = needle < 0.015 ? 3.0 : 4.0 + 8.0 * wide;
    return {cost + 1.5 * testing::normal(testing::noise(c, world, 1), testing::noise(c, world, 2))};
  };
  SearchSettings settings;
  settings.variables = {{"x", 0.0, 1.0, Scale::kLinear, 0.5}, {"y", 0.0, 1.0, Scale::kLinear, 0.5}};
  settings.worlds = worlds(0, 30);
  settings.confirm_worlds = worlds(30, 30);
  settings.budget = 12000;
  TestObjective objective(function);
  MemoryLog log;
  const SearchResult result = search(settings, objective, log);
  EXPECT_NEAR(result.found[0], 0.15, 0.15) << "the start is the needle itself, and has the best score of all";
  EXPECT_NEAR(result.found[1], 0.8, 0.15);

  settings.confirmation.candidates = 0;
  settings.confirmation.neighbours = 0;
  MemoryLog other;
  const SearchResult greedy = search(settings, objective, other);
  EXPECT_NEAR(greedy.found[0], 0.5, 0.02) << "without neighbours the needle wins: the test can fail";
}

// Cost falls with x, violations begin at x = 0.6: the optimum is on the edge.
std::vector<double> edge(const Candidate& c, std::uint64_t world) {
  const double u = testing::noise({}, world, 9);
  const double chance = std::clamp(0.1 + (c[0] - 0.6), 0.0, 1.0);
  const double other = (c[1] - 0.3) * (c[1] - 0.3);
  return {10.0 - 5.0 * c[0] + 10 * other + 0.2 * testing::normal(u, testing::noise({}, world, 8)),
          u < chance ? 1.0 : 0.0};
}

TEST(TuneSearch, ConstraintsAreKept) {
  for (const char* name : {"GN_CRS2_LM", "LN_SBPLX"}) {
    SCOPED_TRACE(name);
    SearchSettings settings;
    settings.variables = {{"x", 0.0, 1.0, Scale::kLinear, 0.2}, {"y", 0.0, 1.0, Scale::kLinear, 0.9}};
    settings.worlds = worlds(0, 100);
    settings.confirm_worlds = worlds(100, 100);
    settings.constraints = {{"collision", 0.1}};
    settings.budget = 30000;
    settings.plan = {&find_algorithm(name)};
    TestObjective objective(edge, 2);
    MemoryLog log;
    const SearchResult result = search(settings, objective, log);
    EXPECT_LT(result.found[0], 0.66);
    EXPECT_GT(result.found[0], 0.45);
    EXPECT_NEAR(result.found[1], 0.3, 0.15);
    ASSERT_FALSE(result.notes.empty());
    EXPECT_NE(result.notes.front().find("constraints by penalty"), std::string::npos);
  }
}

// Cheaper the smoother (x), by more than the successes are worth that smoothness costs beyond x = 0.4. The start has
// success in half of the worlds, as has all before 0.4.
std::vector<double> trade(const Candidate& c, std::uint64_t world) {
  const double chance = 0.5 - std::clamp(c[0] - 0.4, 0.0, 0.4);
  const bool success = testing::noise({}, world, 9) < chance;
  return {40.0 - 30.0 * c[0] + (success ? 0.0 : 10.0), success ? -1.0 : 0.0};
}

TEST(TuneSearch, NothingIsBoughtWithWhatTheStartHas) {
  for (const char* name : {"GN_CRS2_LM", "LN_BOBYQA"}) {
    for (const bool kept : {true, false}) {
      SCOPED_TRACE(fmt::format("{}, {}", name, kept));
      SearchSettings settings;
      settings.variables = {{"x", 0.0, 1.0, Scale::kLinear, 0.1}, {"y", 0.0, 1.0, Scale::kLinear, 0.9}};
      settings.worlds = worlds(0, 100);
      settings.confirm_worlds = worlds(100, 100);
      if (kept)
        settings.constraints = {{"success >= the start's", 0.0, true}};
      else
        settings.constraints = {{"success >= 0", 0.0}};
      settings.budget = 20000;
      settings.plan = {&find_algorithm(name)};
      TestObjective objective(trade, 2);
      MemoryLog log;
      const SearchResult result = search(settings, objective, log);
      if (!kept) {
        EXPECT_GT(result.found[0], 0.7);
        continue;
      }
      // 0.4 and what no world of the hundred tells from it.
      EXPECT_LT(result.found[0], 0.44);
      EXPECT_GT(result.found[0], 0.3);
      for (const Evaluation& e : result.history) {
        if (!e.cut && e.constraints[0] > 0.0) {
          EXPECT_GE(e.merit, result.history.front().merit) << e.candidate[0];
        }
      }
      TestObjective again(trade, 2);
      EXPECT_EQ(search(settings, again, log), result) << "from the log";
      EXPECT_EQ(again.measured, 0u);
    }
  }
}

TEST(TuneSearch, ContradictoryCandidatesAreNotMeasuredAndNotChosen) {
  class Half : public TestObjective {
   public:
    using TestObjective::TestObjective;
    bool valid(const Candidate& c) override { return c[0] < 1.0; }
  };
  SearchSettings settings = quick(4);
  settings.variables[0].start = 0.5;
  Half objective(bowl_trial);
  MemoryLog log;
  const SearchResult result = search(settings, objective, log);
  EXPECT_LT(result.found[0], 1.0);
  int invalid = 0;
  for (const Evaluation& e : result.history) {
    if (e.valid) continue;
    ++invalid;
    EXPECT_TRUE(e.measured.empty());
  }
  EXPECT_GT(invalid, 0);
}

TEST(TuneSearch, WholeNumbersEndEvenWhenAllAreKnown) {
  SearchSettings settings;
  settings.variables = {{"n", 1, 4, Scale::kInteger, 1}};
  settings.worlds = worlds(0, 5);
  settings.budget = 100000;
  TestObjective objective([](const Candidate& c, std::uint64_t) { return std::vector<double>{std::abs(c[0] - 3)}; });
  MemoryLog log;
  EXPECT_EQ(search(settings, objective, log).found, Candidate{3});
  EXPECT_LE(objective.measured, 20u);
}

// All that CRS2 tries from a small population with its best at a bound may be cut to that same bound.
TEST(TuneSearch, OneGainAtItsBoundEnds) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SearchSettings settings;
    settings.variables = {{"slope", 0, 1, Scale::kLinear, 0.5}};
    settings.worlds = worlds(0, 1);
    settings.budget = 40;
    settings.seed = seed;
    TestObjective objective([](const Candidate& c, std::uint64_t) { return std::vector<double>{c[0]}; });
    MemoryLog log;
    EXPECT_LT(search(settings, objective, log).found[0], 0.1) << "seed " << seed;
  }
}

TEST(TuneSearch, NotesAGainAtItsBound) {
  SearchSettings settings;
  settings.variables = {{"slope", 0, 1, Scale::kLinear, 0.5}};
  settings.worlds = worlds(0, 5);
  settings.budget = 500;
  TestObjective objective([](const Candidate& c, std::uint64_t) { return std::vector<double>{-c[0]}; });
  MemoryLog log;
  const SearchResult result = search(settings, objective, log);
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes.back().find("slope = 1 is at the upper bound of its range [0, 1]"), std::string::npos)
      << result.notes.back();
}

TEST(TuneSearch, ALogOfAnotherSearchIsRefused) {
  SearchSettings settings = quick(1);
  TestObjective objective(bowl_trial);
  MemoryLog log;
  search(settings, objective, log);
  settings.seed = 2;
  EXPECT_THROW(search(settings, objective, log), ReplayError);
}

TEST(TuneSearch, BadSettingsAreNamed) {
  SearchSettings s = quick(1);
  s.variables[1].lower = 2.0;
  EXPECT_NE(message(s).find("b: range [2, 1] must have its lower end below its upper end"), std::string::npos)
      << message(s);
  s = quick(1);
  s.variables[0].lower = 0.0;
  EXPECT_NE(message(s).find("a: range [0, 10] with scale log must be above zero"), std::string::npos) << message(s);
  s = quick(1);
  s.variables[0].start = 20.0;
  EXPECT_NE(message(s).find("start 20 is outside its range [0.1, 10]"), std::string::npos) << message(s);
  s = quick(1);
  s.budget = 0;
  EXPECT_NE(message(s).find("budget.trials is 0"), std::string::npos) << message(s);
  s = quick(1);
  s.budget = 30;
  EXPECT_NE(message(s).find("does not reach for two candidates in 20 worlds"), std::string::npos) << message(s);
  s = quick(1);
  s.variables.clear();
  EXPECT_NE(message(s).find("at least one key"), std::string::npos);
}

}  // namespace
}  // namespace moma::tune
