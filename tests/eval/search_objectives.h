#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "eval/search/evaluation.h"
#include "eval/search/objective.h"
#include "eval/search/random.h"
#include "eval/search/search.h"

namespace moma::tune {

/// All members but `importance`, which may hold NaN and follows from the others.
inline bool operator==(const SearchResult& a, const SearchResult& b) {
  return a.found == b.found && a.finalists == b.finalists && a.runs == b.runs && a.history == b.history &&
         a.sensitivity == b.sensitivity && a.trials == b.trials && a.trials_saved == b.trials_saved &&
         a.evaluations_cut == b.evaluations_cut && a.penalty == b.penalty && a.notes == b.notes;
}

}  // namespace moma::tune

namespace moma::tune::testing {

/// Independent draws per (candidate, world): noise that a candidate cannot be told apart from by luck alone.
inline double noise(const Candidate& candidate, std::uint64_t world, std::uint64_t part) {
  std::uint64_t mixed = world * 0x9e3779b97f4a7c15ULL + part;
  for (const double value : candidate) {
    std::uint64_t word = 0;
    static_assert(sizeof word == sizeof value);
    std::memcpy(&word, &value, sizeof word);
    mixed = (mixed ^ word) * 0xff51afd7ed558ccdULL;
    mixed ^= mixed >> 32;
  }
  return uniform(mixed, SearchStream::kStarts, part);
}

inline double normal(double u1, double u2) { return std::sqrt(-2.0 * std::log(1.0 - u1)) * std::cos(2.0 * M_PI * u2); }

/// The exception of a stopped objective.
struct Interrupted {};

/// Any function of (candidate, world), counting its calls, able to stop after some.
class TestObjective : public Objective {
 public:
  using Function = std::function<std::vector<double>(const Candidate&, std::uint64_t)>;
  explicit TestObjective(Function function, std::size_t width = 1) : function_(std::move(function)), width_(width) {}

  std::size_t width() const override { return width_; }
  std::vector<double> measure(const Candidate& candidate, std::span<const std::uint64_t> worlds) override {
    std::vector<double> values;
    for (const std::uint64_t world : worlds) {
      if (stop_after && measured >= *stop_after) throw Interrupted();
      ++measured;
      for (const double value : function_(candidate, world)) values.push_back(value);
    }
    return values;
  }

  std::uint64_t measured = 0;
  std::optional<std::uint64_t> stop_after;

 private:
  Function function_;
  std::size_t width_;
};

class MemoryLog : public EvaluationLog {
 public:
  std::optional<Evaluation> find(std::uint64_t index) override {
    const auto found = kept.find(index);
    return found == kept.end() ? std::nullopt : std::optional(found->second);
  }
  void append(const Evaluation& evaluation) override { kept[evaluation.index] = evaluation; }
  std::map<std::uint64_t, Evaluation> kept;
};

/// Six gains, three of them log, one without effect. The optimum is at these values; `regret` is the true cost above
/// the optimum's: a bowl with ripples, narrow in some gains, flat in others.
inline std::vector<Variable> bowl_variables() {
  return {{"a", 0.1, 10.0, Scale::kLog, 5.0},    {"b", 0.0, 1.0, Scale::kLinear, 0.9},
          {"c", 0.001, 1.0, Scale::kLog, 0.5},   {"d", -2.0, 2.0, Scale::kLinear, -1.5},
          {"e", 0.01, 100.0, Scale::kLog, 50.0}, {"f", 0.0, 5.0, Scale::kLinear, 1.0}};
}
inline constexpr std::array<double, 6> kBowlOptimum{0.35, 0.3, 0.6, 0.7, 0.25, 0.5};  // in the unit cube
inline constexpr std::array<double, 6> kBowlWeight{40, 60, 20, 30, 10, 0};

inline double bowl_regret(std::span<const double> candidate) {
  const std::vector<double> unit = to_unit(bowl_variables(), candidate);
  double sum = 0.0;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const double d = unit[i] - kBowlOptimum[i];
    sum += kBowlWeight[i] * (d * d + 0.004 * (1.0 - std::cos(25.0 * d)));
  }
  return sum;
}

/// Cost like a trial's: 60 for a failure, else a time; the chance of failure rises with the regret.
inline std::vector<double> bowl_trial(const Candidate& candidate, std::uint64_t world) {
  const double regret = bowl_regret(candidate);
  const double chance = 1.0 - 0.95 * std::exp(-0.06 * regret);
  const double difficulty = noise({}, world, 1);
  // Half of what decides is the world's, half is luck that no other candidate shares.
  const double luck = noise(candidate, world, 2);
  const bool fails = (world % 2 == 0 ? difficulty : luck) < chance;
  if (fails) return {60.0};
  return {8.0 + 0.2 * regret + 2.0 * normal(noise({}, world, 3), noise({}, world, 4)) +
          0.5 * normal(noise(candidate, world, 5), noise(candidate, world, 6))};
}

}  // namespace moma::tune::testing
