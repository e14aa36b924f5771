#include "world/draws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <set>
#include <vector>

#include "controller/config/json_node.h"
#include "world/scenario/apportionment.h"
#include "world/scenario/distribution.h"
#include "world/scenario/worlds.h"
#include "world/sensing/streams.h"
#include "world/world_json.h"

namespace moma {
namespace {

config::Node node(const std::string& text) { return config::parse_yaml(text, "test.yaml"); }

TEST(Draws, ArePhilox4x64) {
  // Known answer of Random123 1.14 (kat_vectors: philox4x64 10, counter and key zero).
  EXPECT_EQ(Draws(0, 0, static_cast<Stream>(0)).bits(), 0x16554d9eca36314cULL);
}

TEST(Draws, StreamsDoNotShiftEachOther) {
  Draws alone(7, 3, Stream::kGoal);
  Draws other(7, 3, Stream::kObjects);
  for (int i = 0; i < 5; ++i) other.bits();
  Draws again(7, 3, Stream::kGoal);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(alone.bits(), again.bits());
  std::set<std::uint64_t> firsts;
  for (std::uint64_t seed = 0; seed < 3; ++seed)
    for (std::uint64_t index = 0; index < 3; ++index)
      for (std::uint64_t attempt = 0; attempt < 3; ++attempt)
        for (std::uint64_t item = 0; item < 3; ++item)
          for (const Stream s : {Stream::kStart, Stream::kGoal})
            firsts.insert(Draws(seed, index, s, attempt, item).bits());
  EXPECT_EQ(firsts.size(), 162u);
}

TEST(Draws, EveryCallTakesOneBlock) {
  Draws a(1, 2, Stream::kGoal), b(1, 2, Stream::kGoal);
  a.normal(0.0, 1.0);
  a.log_uniform(1.0, 2.0);
  a.choice(5);
  b.bits();
  b.bits();
  b.bits();
  EXPECT_EQ(a.bits(), b.bits());
}

TEST(Draws, MomentsAreRight) {
  Draws draws(11, 0, Stream::kGoal);
  const int n = 200000;
  double u1 = 0, u2 = 0, g1 = 0, g2 = 0, g4 = 0, l1 = 0;
  for (int i = 0; i < n; ++i) {
    const double u = draws.uniform(2.0, 4.0);
    ASSERT_GE(u, 2.0);
    ASSERT_LE(u, 4.0);
    u1 += u;
    u2 += (u - 3.0) * (u - 3.0);
    const double g = draws.normal(0.0, 1.0);
    g1 += g;
    g2 += g * g;
    g4 += g * g * g * g;
    const double l = draws.log_uniform(0.01, 1.0);
    ASSERT_GE(l, 0.01);
    ASSERT_LE(l, 1.0);
    l1 += std::log10(l);
  }
  // Five standard errors each.
  EXPECT_NEAR(u1 / n, 3.0, 5 * 0.577 / std::sqrt(n));
  EXPECT_NEAR(u2 / n, 1.0 / 3.0, 5 * 0.3 / std::sqrt(n));
  EXPECT_NEAR(g1 / n, 0.0, 5 / std::sqrt(n));
  EXPECT_NEAR(g2 / n, 1.0, 5 * std::sqrt(2.0) / std::sqrt(n));
  EXPECT_NEAR(g4 / n, 3.0, 5 * std::sqrt(96.0) / std::sqrt(n));
  EXPECT_NEAR(l1 / n, -1.0, 5 * 0.577 / std::sqrt(n));
}

constexpr std::uint32_t mask(Stream stream) { return 1U << static_cast<unsigned>(stream); }

/// Kolmogorov and Smirnov's distance to the uniform law, times sqrt(n): above 1.95 with probability 0.001.
double distance_to_uniform(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto k = static_cast<double>(i);
    worst = std::max({worst, values[i] - k / n, (k + 1) / n - values[i]});
  }
  return worst * std::sqrt(n);
}

TEST(Moves, NoneChangeNothing) {
  const Moves none, elsewhere = {{1, 1.0, 1.0, mask(Stream::kGoal)}};
  Draws plain(7, 3, Stream::kObjects, 2, 5), with_none(7, 3, Stream::kObjects, 2, 5, &none),
      with_others(7, 3, Stream::kObjects, 2, 5, &elsewhere);
  for (int i = 0; i < 50; ++i) {
    const std::uint64_t bits = plain.bits();
    EXPECT_EQ(with_none.bits(), bits);
    EXPECT_EQ(with_others.bits(), bits);
  }
}

TEST(Moves, KeepTheLawOfEveryWord) {
  std::vector<double> first, pairs;
  double g1 = 0.0, g2 = 0.0, g4 = 0.0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const auto index = static_cast<std::uint64_t>(i);
    const Moves moves = {{index << 2, 0.3, 1.0, mask(Stream::kObjects)},
                         {index << 2 | 1, 1.0, 0.2, mask(Stream::kObjects)},
                         {index << 2 | 2, 0.8, 0.5, mask(Stream::kObjects)},
                         {index << 2 | 3, 0.01, 1.0, mask(Stream::kObjects)}};
    Draws draws(5, index, Stream::kObjects, 0, 0, &moves);
    first.push_back(draws.uniform());
    pairs.push_back(std::fmod(first.back() + draws.uniform(), 1.0));  // uniform where two draws are independent
    const double g = draws.normal(0.0, 1.0);                          // of both words
    g1 += g;
    g2 += g * g;
    g4 += g * g * g * g;
  }
  EXPECT_LT(distance_to_uniform(first), 1.95);
  EXPECT_LT(distance_to_uniform(pairs), 1.95);
  EXPECT_NEAR(g1 / n, 0.0, 4 / std::sqrt(n));
  EXPECT_NEAR(g2 / n, 1.0, 4 * std::sqrt(2.0 / n));
  EXPECT_NEAR(g4 / n, 3.0, 4 * std::sqrt(96.0 / n));
}

/// The mean of what a normal and the moved one have in common, and the part that is moved.
TEST(Moves, StepAsFarAsTheyAre) {
  const auto normal = [](double u) { return -std::sqrt(2.0) * boost::math::erfc_inv(2.0 * (u + 0x1p-54)); };
  for (const Move move : {Move{1, 0.6, 1.0, mask(Stream::kGoal)}, Move{2, 1.0, 1.0, mask(Stream::kGoal)},
                          Move{3, 0.6, 0.25, mask(Stream::kGoal)}}) {
    const Moves moves = {move};
    Draws before(9, 1, Stream::kGoal), after(9, 1, Stream::kGoal, 0, 0, &moves);
    const int n = 20000;
    double common = 0.0;
    int moved = 0;
    for (int i = 0; i < n; ++i) {
      const double a = before.uniform(), b = after.uniform();
      moved += a != b ? 1 : 0;
      common += a != b ? normal(a) * normal(b) : 0.0;
    }
    EXPECT_NEAR(moved, move.fraction * n, 4 * std::sqrt(n) * 0.5);
    EXPECT_NEAR(common / moved, std::sqrt(1.0 - move.scale * move.scale), 5 / std::sqrt(moved));
  }
}

TEST(Moves, AreAppliedInTurn) {
  const Move step{1, 0.5, 1.0, mask(Stream::kGoal)}, anew{2, 1.0, 1.0, mask(Stream::kGoal)};
  const Moves first = {step, anew}, second = {anew}, third = {anew, step};
  Draws a(9, 1, Stream::kGoal, 0, 0, &first), b(9, 2, Stream::kGoal, 0, 0, &second),
      c(9, 1, Stream::kGoal, 0, 0, &third);
  for (int i = 0; i < 20; ++i) {
    const std::uint64_t anew_bits = a.bits();
    EXPECT_EQ(anew_bits, b.bits());  // whatever was there before
    EXPECT_NE(anew_bits, c.bits());
  }
}

TEST(Moves, MayBeManyInAFileOfAnybodys) {
  const Moves many(300000, Move{1, 0.5, 1.0, mask(Stream::kGoal)});
  Draws draws(9, 1, Stream::kGoal, 0, 0, &many);
  const double u = draws.uniform();
  EXPECT_GT(u, 0.0);
  EXPECT_LT(u, 1.0);
}

TEST(Moves, OfConstantErrorsLeaveTheNoiseOfLaterSteps) {
  const Moves moves = {{1, 1.0, 1.0, Move::kConstantErrors}};
  for (const Stream stream : {Stream::kSensing, Stream::kDisturbance}) {
    EXPECT_NE(Draws(1, 1, stream, 0, 4, &moves).bits(), Draws(1, 1, stream, 0, 4).bits());
    EXPECT_EQ(Draws(1, 1, stream, 1, 4, &moves).bits(), Draws(1, 1, stream, 1, 4).bits());
  }
  EXPECT_EQ(Draws(1, 1, Stream::kObjects, 0, 4, &moves).bits(), Draws(1, 1, Stream::kObjects, 0, 4).bits());
}

World world_of_three() {
  World world;
  world.index = 4;
  world.seed = 6;
  world.start.q = world.witness.q = VectorX::Zero(7);
  for (const char* name : {"a", "b", "c"}) {
    world.objects.emplace_back();
    world.objects.back().name = name;
    world.objects.back().shape.size = {0.1, 0.1, 0.1};
  }
  return world;
}

TEST(Moves, AreInTheWorldsFileAndInItsIdentity) {
  World world = world_of_three();
  EXPECT_FALSE(to_json(world).contains("moves"));
  EXPECT_FALSE(to_json(world)["objects"][0].contains("noise"));
  world.objects[2].noise = 9;
  world.moves = std::make_shared<Moves>(Moves{{(1ULL << 53) - 1, 0.1, 1.0 / 3.0, 3}, {2, 1.0, 1.0, 127}});
  const nlohmann::ordered_json json = to_json(world);
  const World again = world_from_json(json, "test");
  EXPECT_EQ(to_json(again), json);
  EXPECT_EQ(again.objects[2].noise, 9);
  ASSERT_EQ(again.moves->size(), 2u);
  EXPECT_EQ((*again.moves)[0].id, (1ULL << 53) - 1);
  EXPECT_EQ((*again.moves)[0].fraction, 1.0 / 3.0);

  const Worlds worlds = Worlds::read(node("{seed: 3, families: {open: {}}}"), "worlds");
  EXPECT_FALSE(worlds.identity(5).contains("moves"));
  EXPECT_EQ(worlds.identity(5, *world.moves)["moves"], json["moves"]);
  EXPECT_NE(worlds.identity(5, *world.moves), worlds.identity(5));
}

TEST(Moves, ThatAreWrongAreRefused) {
  nlohmann::ordered_json json = to_json(world_of_three());
  for (const char* bad : {"[[1, 0, 1, 1]]", "[[1, 1, 1]]", "[[1.5, 1, 1, 1]]", "[[-1, 1, 1, 1]]", "[[1, 1.1, 1, 1]]",
                          "[[1, 1, 0, 1]]", "[[1, 1, 1, 128]]", "{}", "[1]"}) {
    json["moves"] = nlohmann::ordered_json::parse(bad);
    EXPECT_THROW(world_from_json(json, "test"), config::ConfigError) << bad;
  }
}

TEST(Moves, AreInEveryDrawOfADisturbance) {
  World world = world_of_three();
  world.moves = std::make_shared<Moves>(Moves{{1, 1.0, 1.0, mask(Stream::kSensing) | mask(Stream::kDisturbance)}});
  const DisturbanceStreams plain(world_of_three(), 1), moved(world, 1);
  using enum DisturbanceSource;
  EXPECT_NE(plain.sensing(kJointNoise, 3).bits(), moved.sensing(kJointNoise, 3).bits());
  EXPECT_NE(plain.acting(kJointGain).bits(), moved.acting(kJointGain).bits());
}

TEST(ObjectNoise, GoesWithTheNumberAndNotWithThePlace) {
  World world = world_of_three();
  const DisturbanceStreams all(world, 1);
  world.objects[2].noise = 2;
  world.objects.erase(world.objects.begin() + 1);
  const DisturbanceStreams fewer(world, 1);
  using enum DisturbanceSource;
  EXPECT_EQ(fewer.sensing(kObjectPosition, 7, 0).bits(), all.sensing(kObjectPosition, 7, 0).bits());
  EXPECT_EQ(fewer.sensing(kObjectPosition, 7, 1).bits(), all.sensing(kObjectPosition, 7, 2).bits());
  EXPECT_EQ(fewer.sensing(kPhantom, 7, 3).bits(), all.sensing(kPhantom, 7, 3).bits());
}

TEST(Distribution, RoundTripsThroughJson) {
  for (const char* text : {"0.1", "{uniform: [0.1, 0.30000000000000004]}", "{log_uniform: [1e-3, 10]}",
                           "{normal: [0.5, 0.25]}", "{choice: [1, 2, 7.5]}"}) {
    const Distribution a = Distribution::read(node(text), "k", config::Range::any());
    const Distribution b = Distribution::read(config::node_from_json(a.to_json(), "json"), "k", config::Range::any());
    EXPECT_EQ(a.to_json(), b.to_json());
    Draws x(1, 1, Stream::kGoal), y(1, 1, Stream::kGoal);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(a.sample(x), b.sample(y)) << text;
  }
}

TEST(Distribution, CountsAreWholeAndEvenlySpread) {
  const Distribution d = Distribution::read(node("{uniform: [5, 15]}"), "k", {0, 100}, true);
  Draws draws(3, 0, Stream::kObjects);
  std::vector<int> seen(16, 0);
  const int n = 22000;
  for (int i = 0; i < n; ++i) {
    const int count = d.sample_count(draws);
    ASSERT_GE(count, 5);
    ASSERT_LE(count, 15);
    ++seen[static_cast<std::size_t>(count)];
  }
  for (int k = 5; k <= 15; ++k) EXPECT_NEAR(seen[static_cast<std::size_t>(k)], n / 11, 5 * std::sqrt(n / 11.0));
}

TEST(Distribution, NormalIsClippedToTheRange) {
  const Distribution d = Distribution::read(node("{normal: [0.1, 5]}"), "k", config::Range::non_negative());
  Draws draws(3, 0, Stream::kObjects);
  for (int i = 0; i < 1000; ++i) ASSERT_GE(d.sample(draws), 0.0);
}

TEST(Distribution, RefusesWhatIsWrong) {
  const auto refused = [](const char* text, const char* part, bool whole = false) {
    try {
      Distribution::read(node(text), "worlds.families.open.distance", config::Range::non_negative(), whole);
      ADD_FAILURE() << text << " was accepted";
    } catch (const config::ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("test.yaml:1:"), std::string::npos) << error.what();
    }
  };
  refused("-1", "distance");
  refused("abc", "distance");
  refused(".nan", "distance");
  refused("{uniform: [2, 1]}", "must not exceed");
  refused("{uniform: [1]}", "uniform");
  refused("{uniform: [-1, 1]}", "uniform");
  refused("{log_uniform: [0, 1]}", "above 0");
  refused("{normal: [1, -1]}", "standard deviation");
  refused("{choice: []}", "at least one");
  refused("{gauss: [1, 1]}", "unknown distribution");
  refused("{uniform: [1, 2], normal: [1, 1]}", "expected");
  refused("1.5", "whole", true);
}

TEST(Apportionment, EveryPrefixIsWithinOneOfItsShare) {
  const std::vector<std::vector<double>> cases = {{1, 1},       {1, 0, 2},           {0.3, 0.5, 0.2},
                                                  {5, 1, 1, 1}, {7, 3, 2, 0, 11, 1}, {1, 1e-3}};
  for (const std::vector<double>& weights : cases) {
    const Apportionment shares(weights);
    std::vector<int> counts(weights.size(), 0);
    double sum = 0.0;
    for (const double w : weights) sum += w;
    for (int n = 1; n <= 3000; ++n) {
      ++counts[static_cast<std::size_t>(shares.family_of(static_cast<std::uint64_t>(n - 1)))];
      for (std::size_t i = 0; i < weights.size(); ++i) {
        const double share = n * weights[i] / sum;
        ASSERT_LT(std::abs(counts[i] - share), 1.0) << "family " << i << " of " << weights.size() << " in " << n;
        if (weights[i] == 0.0) {
          ASSERT_EQ(counts[i], 0);
        }
      }
    }
  }
}

// Memory does not grow with the index.
TEST(Apportionment, AnyIndexOfWholeWeights) {
  const Apportionment whole({3.0, 0.0, 2.0, 1.0});
  for (std::uint64_t k = 0; k < 6; ++k) EXPECT_EQ(whole.family_of(600'000'000'000 + k), whole.family_of(k));
  const Apportionment odd({1.0, 2.5});
  EXPECT_GE(odd.family_of(1000), 0);
  EXPECT_THROW(odd.family_of(100'000'000'007), GenerationError);
}

TEST(Apportionment, EqualWeightsGiveHalvesExactly) {
  const Apportionment shares({1.0, 1.0});
  int first = 0;
  for (std::uint64_t i = 0; i < 200; ++i) first += shares.family_of(i) == 0;
  EXPECT_EQ(first, 100);
}

TEST(Apportionment, WeightZeroChangesNothing) {
  const Apportionment without({2.0, 1.0}), with({2.0, 0.0, 1.0});
  for (std::uint64_t i = 0; i < 500; ++i) {
    const int family = with.family_of(i);
    ASSERT_EQ(without.family_of(i), family == 2 ? 1 : family);
  }
}

}  // namespace
}  // namespace moma
