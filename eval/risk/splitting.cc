#include "eval/risk/splitting.h"

#include <Random123/philox.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <set>
#include <stdexcept>

namespace moma::risk {
namespace {

constexpr double kTargetAcceptance = 0.3;
constexpr double kAdaptation = 1.0;
constexpr double kLeastScale = 1e-3;

using Words = r123::Philox4x64::ctr_type;

/// Random words of a particle in a round; rounds are counted over levels and moves.
Words words(std::uint64_t seed, std::size_t place, std::uint64_t round) {
  return r123::Philox4x64()({{place, round, 0, 0}}, {{seed, 0x7269736bULL}});
}

double unit(std::uint64_t word) { return static_cast<double>(word >> 11) * 0x1p-53; }

std::size_t below(std::uint64_t word, std::size_t count) {
  return std::min(static_cast<std::size_t>(unit(word) * static_cast<double>(count)), count - 1);
}

struct Run {
  std::size_t first = 0;  ///< its first place
  double level = -kEvent;
  bool done = false;
  std::vector<double> scales;
  std::vector<Acceptance> since;    ///< acceptance of the latest move
  std::vector<std::size_t> copies;  ///< places of the copies
  std::vector<std::size_t> ancestor;
};

class Splitter {
 public:
  Splitter(const SplittingOptions& options, Particles& particles, std::size_t first)
      : options_(options), particles_(particles), first_(first * options.particles) {}

  Splitting run() {
    const std::size_t n = options_.particles, drawn = options_.draws * n;
    result_.particles = n;
    result_.replicates.resize(options_.replicates);
    result_.kinds.resize(particles_.kinds());
    runs_.resize(options_.replicates);
    scores_ = result_.first = particles_.draw(first_ * options_.draws, drawn * runs_.size());
    result_.evaluations = scores_.size();
    ++round_;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      runs_[r].first = r * n;
      runs_[r].scales.assign(particles_.kinds(), 1.0);
      std::vector<double> sorted = sorted_scores(r * drawn, drawn);
      keep_highest(runs_[r], r * drawn, drawn);
      select(runs_[r], result_.replicates[r], std::move(sorted));
    }
    scores_.resize(n * runs_.size());
    while (true) {
      std::vector<double> levels;
      for (const Run& run : runs_)
        if (!run.done) levels.push_back(run.level);
      if (levels.empty()) break;
      particles_.reached(levels);
      for (int move = 0; move < options_.moves; ++move) move_copies();
      ++round_;
      for (std::size_t r = 0; r < runs_.size(); ++r)
        if (!runs_[r].done) select(runs_[r], result_.replicates[r], sorted_scores(runs_[r].first, n));
    }
    result_.last = scores_;
    return std::move(result_);
  }

 private:
  std::vector<double> sorted_scores(std::size_t from, std::size_t count) const {
    const auto begin = scores_.begin() + static_cast<std::ptrdiff_t>(from);
    std::vector<double> sorted(begin, begin + static_cast<std::ptrdiff_t>(count));
    std::ranges::sort(sorted);
    return sorted;
  }

  /// Moves the highest of the first draws to the places of the run's particles. All later levels lie at their lowest or
  /// above it, so that the other draws would not survive any.
  void keep_highest(Run& run, std::size_t from, std::size_t count) {
    run.ancestor.resize(count);
    std::iota(run.ancestor.begin(), run.ancestor.end(), std::size_t{0});
    std::ranges::stable_sort(run.ancestor, std::greater(), [&](std::size_t i) { return scores_[from + i]; });
    run.ancestor.resize(options_.particles);
    std::ranges::sort(run.ancestor);
    for (std::size_t i = 0; i < run.ancestor.size(); ++i) copy(from + run.ancestor[i], run.first + i);
  }

  void copy(std::size_t from, std::size_t to) {
    particles_.copy(from, to);
    scores_[to] = scores_[from];
  }

  void end(Run& run, Replicate& replicate) {
    run.done = true;
    run.copies.clear();
    replicate.ancestors = std::set<std::size_t>(run.ancestor.begin(), run.ancestor.end()).size();
    const std::vector<double>& scores = replicate.generations.back().scores;
    const auto hits = static_cast<double>(std::ranges::count(scores, kEvent)), all = static_cast<double>(scores.size());
    if (replicate.cut || replicate.died_out || hits == 0.0) return;
    replicate.estimate = replicate.beyond(std::numeric_limits<double>::max());
    replicate.variance += (all - hits) / (hits * all);
  }

  /// Ends the replicate if half of its particles are events; otherwise kills up to the next level and replaces the
  /// killed by copies. `scores`: sorted, of all draws of which the particles are the highest.
  void select(Run& run, Replicate& replicate, std::vector<double> scores) {
    const std::size_t n = options_.particles;
    const double level = scores[scores.size() - n + n / 2 - 1];
    const auto all = static_cast<double>(scores.size());
    replicate.generations.push_back({std::move(scores), level});
    if (level == kEvent) return end(run, replicate);
    std::vector<std::size_t> alive;
    run.copies.clear();
    for (std::size_t i = 0; i < n; ++i) (scores_[run.first + i] > level ? alive : run.copies).push_back(run.first + i);
    replicate.tied = std::max(replicate.tied, run.copies.size() - n / 2);
    replicate.died_out = alive.empty();
    replicate.cut = !alive.empty() && replicate.levels == options_.levels;
    if (replicate.died_out || replicate.cut) return end(run, replicate);
    ++replicate.levels;
    run.level = level;
    const auto k = static_cast<double>(alive.size());
    replicate.variance += (all - k) / (k * all);
    for (const std::size_t place : run.copies) {
      const std::size_t parent = alive[below(random(place)[0], alive.size())];
      copy(parent, place);
      run.ancestor[place - run.first] = run.ancestor[parent - run.first];
    }
  }

  void move_copies() {
    ++round_;
    proposals_.clear();
    for (Run& run : runs_) {
      run.since.assign(particles_.kinds(), {});
      for (const std::size_t place : run.copies) {
        const Words drawn = random(place);
        const std::size_t kind = below(drawn[0], particles_.kinds());
        proposals_.push_back({place, kind, run.scales[kind], drawn[1] >> 11});
      }
    }
    const std::vector<double> scores = particles_.propose(proposals_);
    result_.evaluations += scores.size();
    for (std::size_t i = 0; i < proposals_.size(); ++i) {
      const Proposal& proposal = proposals_[i];
      Run& run = runs_[proposal.place / options_.particles];
      const bool accepted = scores[i] > run.level;
      for (Acceptance* count : {&run.since[proposal.kind], &result_.kinds[proposal.kind]}) {
        ++count->proposed;
        count->accepted += accepted ? 1 : 0;
      }
      if (!accepted) continue;
      particles_.accept(i);
      scores_[proposal.place] = scores[i];
    }
    for (Run& run : runs_) adapt(run);
  }

  Words random(std::size_t place) const { return words(options_.seed, first_ + place, round_); }

  static void adapt(Run& run) {
    for (std::size_t kind = 0; kind < run.since.size(); ++kind) {
      const Acceptance& since = run.since[kind];
      if (since.proposed == 0) continue;
      const double rate = static_cast<double>(since.accepted) / static_cast<double>(since.proposed);
      run.scales[kind] =
          std::clamp(run.scales[kind] * std::exp(kAdaptation * (rate - kTargetAcceptance)), kLeastScale, 1.0);
    }
  }

  const SplittingOptions& options_;
  Particles& particles_;
  std::size_t first_;  ///< number of the particle in place 0 after the first draws
  std::vector<Run> runs_;
  std::vector<double> scores_;
  std::vector<Proposal> proposals_;
  std::uint64_t round_ = 0;
  Splitting result_;
};

}  // namespace

double Replicate::beyond(double score) const {
  double p = 1.0;
  for (const Generation& generation : generations) {
    const std::vector<double>& sorted = generation.scores;
    const bool last = &generation == &generations.back() || score < generation.level;
    const auto above = sorted.end() - std::ranges::upper_bound(sorted, last ? score : generation.level);
    p *= static_cast<double>(above) / static_cast<double>(sorted.size());
    if (last) break;
  }
  return p;
}

void Splitting::append(Splitting more) {
  particles = more.particles;
  evaluations += more.evaluations;
  kinds.resize(more.kinds.size());
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    kinds[kind].proposed += more.kinds[kind].proposed;
    kinds[kind].accepted += more.kinds[kind].accepted;
  }
  std::move(more.replicates.begin(), more.replicates.end(), std::back_inserter(replicates));
  first.insert(first.end(), more.first.begin(), more.first.end());
  last.insert(last.end(), more.last.begin(), more.last.end());
}

Splitting split(const SplittingOptions& options, Particles& particles, std::size_t first) {
  if (options.particles < 2 || options.draws < 1 || options.replicates < 1 || options.moves < 1 || options.levels < 0)
    throw std::invalid_argument("split: needs 2 particles, a draw, a replicate and a move at least");
  return Splitter(options, particles, first).run();
}

double expected_evaluations(const SplittingOptions& options, double p) {
  const auto draws = static_cast<double>(options.draws);
  const double levels = std::max(0.0, std::floor(-std::log2(draws * p)));
  return static_cast<double>(options.particles * options.replicates) * (draws + 0.5 * levels * options.moves);
}

namespace {

/// Mean of the replicates' estimates, their spread, and its log-normal interval; [0, 1] for a single replicate.
Estimate mean_of(const std::vector<double>& replicates) {
  const auto m = static_cast<double>(replicates.size());
  Estimate out;
  out.interval = {0.0, 1.0};
  for (const double p : replicates) out.p += p / m;
  if (out.p <= 0.0 || replicates.size() < 2) return out;
  double squares = 0.0;
  for (const double p : replicates) squares += (p - out.p) * (p - out.p);
  out.spread = std::sqrt(squares / (m - 1.0)) / out.p;
  const double t = boost::math::quantile(boost::math::students_t(m - 1.0), 0.975);
  const double factor = std::exp(t * std::sqrt(std::log1p(out.spread * out.spread / m)));
  out.interval = {out.p / factor, std::min(1.0, out.p * factor)};
  return out;
}

}  // namespace

Estimate estimate(std::span<const Stratum> strata) {
  if (strata.empty()) throw std::invalid_argument("estimate: no strata");
  const std::size_t count = strata.front().run->replicates.size();
  const auto m = static_cast<double>(count);
  std::vector<double> joined(count, 0.0);
  double ideal = 0.0, heaviest = 0.0;
  for (const Stratum& stratum : strata) {
    if (stratum.run->replicates.size() != count) throw std::invalid_argument("estimate: replicates differ");
    double mean = 0.0, variance = 0.0, found = 0.0;
    for (std::size_t r = 0; r < count; ++r) {
      const Replicate& replicate = stratum.run->replicates[r];
      joined[r] += stratum.weight * replicate.estimate;
      mean += stratum.weight * replicate.estimate / m;
      if (replicate.estimate <= 0.0) continue;
      variance += replicate.variance;
      found += 1.0;
    }
    if (found > 0.0) ideal += mean * mean * variance / found;
    heaviest = std::max(heaviest, stratum.weight);
  }
  Estimate out = mean_of(joined);
  if (out.p > 0.0) {
    out.ideal = std::sqrt(ideal) / out.p;
  } else {
    const auto n = static_cast<double>(strata.front().run->first.size());
    const double most = std::log(2.0 / 0.05) / n;  // -log of the probability that n draws may have missed
    out.interval = {0.0, std::min(1.0, strata.size() == 1 ? -std::expm1(-most) : heaviest * most)};
  }
  return out;
}

std::vector<Exceedance> exceedances(std::span<const Stratum> strata, std::size_t most) {
  std::set<double> levels;
  for (const Stratum& stratum : strata)
    for (const Replicate& replicate : stratum.run->replicates)
      for (const Generation& generation : replicate.generations)
        if (std::isfinite(generation.level)) levels.insert(generation.level);
  const std::vector<double> all(levels.begin(), levels.end());
  std::vector<Exceedance> out;
  for (std::size_t k = 0, count = std::min(most, all.size()); k < count; ++k) {
    const double score = all[count < 2 ? 0 : k * (all.size() - 1) / (count - 1)];
    double crude = 0.0;
    std::vector<double> joined(strata.front().run->replicates.size(), 0.0);
    for (const auto& [weight, run] : strata) {
      for (std::size_t r = 0; r < joined.size(); ++r) joined[r] += weight * run->replicates[r].beyond(score);
      const auto above = std::ranges::count_if(run->first, [&](double s) { return s > score; });
      crude += weight * static_cast<double>(above) / static_cast<double>(run->first.size());
    }
    const Estimate mean = mean_of(joined);
    out.push_back({score, mean.p, mean.interval, crude});
  }
  return out;
}

}  // namespace moma::risk
