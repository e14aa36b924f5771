#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "eval/stats/intervals.h"

// Probabilities of rare events by adaptive multilevel splitting: particles drawn from their law are sorted by a score;
// the lower half is killed, copies of the others take its place and move within what lies above the level, and so on
// until the event is common among them. It knows no robot, no trial and no store.
namespace moma::risk {

/// The score of the event. Every other outcome scores less; the more, the nearer it came.
inline constexpr double kEvent = std::numeric_limits<double>::infinity();

struct SplittingOptions {
  std::size_t particles = 250;  ///< N of a replicate; at least 2
  std::size_t replicates = 10;  ///< R, independent of each other; at least 2 for an interval
  int moves = 5;                ///< T of each copy
  int levels = 40;              ///< most; a replicate that needs more counts as 0 and is reported as cut
  std::uint64_t seed = 1;       ///< of choices and moves
};

/// A move that is tried. Its kernel has to keep the particles' law and be reversible for it, for any kind and scale.
struct Proposal {
  std::size_t place = 0;  ///< of the particle: replicate * N + particle
  std::size_t kind = 0;
  double scale = 1.0;    ///< in (0, 1], adapted to an acceptance of 0.3
  std::uint64_t id = 0;  ///< below 2^53; what the move is made of
};

/// Where particles are kept, moved and scored.
class Particles {
 public:
  virtual ~Particles() = default;
  /// Kinds of moves; at least 1.
  virtual std::size_t kinds() const = 0;
  /// Draws `count` particles, into places 0 .. count - 1, and scores them.
  virtual std::vector<double> draw(std::size_t count) = 0;
  /// Scores what each proposal would make of its particle.
  virtual std::vector<double> propose(std::span<const Proposal> proposals) = 0;
  /// Takes proposal `i` of the latest propose().
  virtual void accept(std::size_t i) = 0;
  virtual void copy(std::size_t from, std::size_t to) = 0;
  /// Told of the level that each replicate on its way has come to.
  virtual void reached(std::span<const double> /*levels*/) {}
};

struct Replicate {
  double estimate = 0.0;  ///< unbiased
  double variance = 0.0;  ///< least relative variance that a run of these levels can have: sum (N - K) / (K N)
  int levels = 0;
  std::size_t hits = 0;       ///< particles at the end that are events
  std::size_t ancestors = 0;  ///< first draws from which the particles at the end descend
  std::size_t tied = 0;       ///< most particles that died at a level because they equalled the middle one
  bool died_out = false;      ///< nothing lay above a level
  bool cut = false;           ///< by SplittingOptions::levels
};

struct Acceptance {
  std::size_t proposed = 0;
  std::size_t accepted = 0;
};

struct Splitting {
  std::size_t particles = 0;  ///< of a replicate
  std::vector<Replicate> replicates;
  std::vector<Acceptance> kinds;    ///< over all levels
  std::vector<double> first, last;  ///< scores of the first draws and of the last generation, by place
  std::size_t evaluations = 0;      ///< scores asked for
};

/// Runs all replicates at once, so that a round of moves is one call of propose(). Each level kills every particle that
/// scores no more than the N/2-th lowest, so that with K survivors
///   p = prod(K / N) * hits / N
/// is unbiased whatever ties there are. A pure function of options and particles.
/// Sources: Cerou & Guyader, Stoch. Anal. Appl. 25, 2007; Brehier et al., Ann. Appl. Probab. 26, 2016.
Splitting split(const SplittingOptions& options, Particles& particles);

/// Scores that the ideal algorithm takes for an event of probability p, for the price: R N (1 + log2(1 / p) T / 2).
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
  double ideal = 0.0;        ///< what it would be if moves forgot where they came from
  /// spread / ideal: 1.1 to 1.5 where all is well, 1 where p = 0.
  double excess() const { return ideal > 0.0 && p > 0.0 ? spread / ideal : 1.0; }
};

inline constexpr double kDoubtfulExcess = 2.0;  ///< beyond it the interval is in doubt
inline constexpr double kRefusedExcess = 3.0;   ///< beyond it there is none to be believed

/// Joins strata of equally many replicates, which are paired. The interval is log-normal about the mean,
///   p exp(-+ t_{R-1} sqrt(log(1 + s^2 / (R p^2)))),
/// where every replicate is 0 that of the first draws, none of which is an event (Clopper & Pearson, Biometrika 26,
/// 1934; of several strata its bound for the worst shares). [0, 1] of a single replicate.
Estimate estimate(std::span<const Stratum> strata);

}  // namespace moma::risk
