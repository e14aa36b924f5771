#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "eval/stats/intervals.h"

// Probabilities of rare events by adaptive multilevel splitting. Particles drawn from their distribution are sorted by
// a score. The lower half is killed, copies of the others replace it and move above the level, until the event is
// common among the particles. The first particles are the highest of D times as many draws. The extra draws cost no
// more than the levels that they replace, and leave more distinct ancestors. This part knows no robot, trial or store.
namespace moma::risk {

/// Score of the event. All other scores are lower; they increase with nearness.
inline constexpr double kEvent = std::numeric_limits<double>::infinity();

struct SplittingOptions {
  std::size_t particles = 250;  ///< N, particles per replicate; at least 2
  std::size_t draws = 8;        ///< D, first draws for each particle, of which the highest are kept; at least 1
  std::size_t replicates = 10;  ///< R, independent replicates; at least 2 for an interval
  int moves = 5;                ///< T, moves of each copy
  int levels = 40;              ///< largest number; a replicate that needs more counts as 0 and is reported as cut
  std::uint64_t seed = 1;       ///< seed of choices and moves
};

/// A proposed move. Its kernel must preserve the particles' distribution and be reversible for it, for any kind and
/// scale.
struct Proposal {
  std::size_t place = 0;  ///< place of the particle
  std::size_t kind = 0;
  double scale = 1.0;    ///< step size in (0, 1], adapted to an acceptance of 0.3
  std::uint64_t id = 0;  ///< below 2^53; determines the move
};

class Particles {
 public:
  virtual ~Particles() = default;
  /// Number of kinds of moves; at least 1.
  virtual std::size_t kinds() const = 0;
  /// Draws the particles `first` .. `first` + `count` - 1 into places 0 .. count - 1, and returns their scores.
  /// Called once, for all first draws; the particles keep the first N R places.
  virtual std::vector<double> draw(std::size_t first, std::size_t count) = 0;
  /// Returns the score of each proposal's moved particle.
  virtual std::vector<double> propose(std::span<const Proposal> proposals) = 0;
  virtual void accept(std::size_t i) = 0;
  virtual void copy(std::size_t from, std::size_t to) = 0;
  /// Reports the level of each replicate in progress.
  virtual void reached(std::span<const double> /*levels*/) {}
};

/// The scores among which a level is set.
struct Generation {
  std::vector<double> scores;  ///< sorted; of the first one D N, of others N
  double level = 0.0;          ///< it kills this score and those below
};

struct Replicate {
  double estimate = 0.0;  ///< unbiased
  double variance = 0.0;  ///< least relative variance for these levels: sum (M - K) / (K M)
  int levels = 0;
  std::size_t ancestors = 0;  ///< number of first draws that the final particles descend from
  std::size_t tied = 0;       ///< most particles that died at a level because they equalled it
  bool died_out = false;      ///< no particle lay above a level
  bool cut = false;           ///< exceeded SplittingOptions::levels
  std::vector<Generation> generations;

  /// Unbiased estimate of the probability that a score exceeds `score`.
  double beyond(double score) const;
};

struct Acceptance {
  std::size_t proposed = 0;
  std::size_t accepted = 0;
};

struct Splitting {
  std::size_t particles = 0;  ///< N, particles per replicate
  std::vector<Replicate> replicates;
  std::vector<Acceptance> kinds;    ///< over all levels
  std::vector<double> first, last;  ///< scores of the first draws and of the last generation, by place
  std::size_t evaluations = 0;      ///< number of computed scores

  /// Adds further replicates of as many particles.
  void append(Splitting more);
};

/// Runs the replicates `first` .. `first` + R - 1 at once, so that a round of moves is one call of propose(). Each
/// level kills every particle whose score is at most the N/2-th lowest. With K survivors of a generation of M, which is
/// D N for the first draws and N later,
///   p = prod(K / M) * hits / M
/// is unbiased for any ties. A replicate is a pure function of options, particles and its number. Sources: Cerou &
/// Guyader, Stoch. Anal. Appl. 25, 2007; Brehier et al., Ann. Appl. Probab. 26, 2016.
Splitting split(const SplittingOptions& options, Particles& particles, std::size_t first = 0);

/// Number of scores of the ideal algorithm for an event of probability p: R N (D + log2(1 / (D p)) T / 2).
double expected_evaluations(const SplittingOptions& options, double p);

/// A part of the population that was split by itself, and its share of the whole.
struct Stratum {
  double weight = 1.0;
  const Splitting* run = nullptr;
};

struct Estimate {
  double p = 0.0;
  stats::Interval interval;  ///< 95 %
  double spread = 0.0;       ///< relative standard deviation over replicates
  double ideal = 0.0;        ///< its value for moves without memory
  /// Spread / ideal: normally 1.1 to 1.5; 1 if p = 0.
  double excess() const { return ideal > 0.0 && p > 0.0 ? spread / ideal : 1.0; }
  /// The interval's high end divided by its low end; infinite if p = 0.
  double factor() const { return interval.high / interval.low; }
};

inline constexpr double kDoubtfulExcess = 2.0;  ///< above it the interval is doubtful
inline constexpr double kRefusedExcess = 3.0;   ///< above it there is no interval

/// Joins strata of equally many replicates, which are paired. The interval is log-normal about the mean,
///   p exp(-+ t_{R-1} sqrt(log(1 + s^2 / (R p^2)))).
/// If every replicate is 0, it is that of the first draws, none of which is an event (Clopper & Pearson, Biometrika 26,
/// 1934; for several strata its bound for the worst shares). [0, 1] for a single replicate.
Estimate estimate(std::span<const Stratum> strata);

/// The probability that a score exceeds a value.
struct Exceedance {
  double score = 0.0;
  double p = 0.0;
  stats::Interval interval;  ///< 95 %, as of estimate()
  double crude = 0.0;        ///< share of the first draws
};

/// The way to the event: exceedances of at most `most` of the levels, by increasing score.
std::vector<Exceedance> exceedances(std::span<const Stratum> strata, std::size_t most = 40);

}  // namespace moma::risk
