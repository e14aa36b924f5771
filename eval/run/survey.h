#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "eval/batch/batch.h"
#include "eval/run/world_look.h"

namespace moma::run {

/// How a suite's worlds are made: by robot and family how many tries a world takes, why tries are rejected, how long it
/// takes and how long beside a trial (processor time, so that other programs do not count).
class WorldSurvey {
 public:
  struct Tally {
    MakingLog log;
    double seconds = 0.0;  ///< spent on making
    std::uint64_t failed = 0;
    std::uint64_t trials = 0;
    double trial_seconds = 0.0;  ///< without the making of the world
  };
  using Place = std::pair<std::string, std::string>;  ///< robot, family

  /// Makes about `count` worlds in all, the first ones of each robot and `worlds` section among the points, of which
  /// there are `trials`, and looks at them; of each frozen set `count`. The points have to last as long as the survey.
  void make_worlds(const std::vector<SuitePoint>& points, std::uint64_t count, std::uint64_t trials);
  /// Computes a job on this thread and counts the trial's time.
  void run(const SuitePoint& point, const BatchJob& job);

  /// Empty where no world had to be made (frozen sets).
  const std::map<Place, Tally>& tallies() const { return tallies_; }
  /// Worlds that cannot be made, one sentence per robot and family.
  const std::vector<std::string>& failures() const { return failures_; }
  /// What is doubtful of the worlds that were made: robots that start in touch, goals nearer to objects than
  /// controllers keep. One sentence each, with counts.
  std::vector<std::string> doubts() const;

 private:
  /// Points that share robot and worlds.
  struct Group {
    std::vector<const SuitePoint*> points;
    WorldLook look;
  };

  void make_worlds(Group& group, std::uint64_t count);
  void look_at_frozen(Group& group, std::uint64_t count);

  std::map<Place, Tally> tallies_;
  std::vector<std::string> failures_;
  std::vector<Group> groups_;
};

/// How long trials of a suite take.
struct TrialTime {
  double each = 0.0;         ///< [s], by the wall clock
  std::size_t measured = 0;  ///< trials
};

/// From trials of about `enough` seconds in all: points in turn, worlds spread over the suite's. They count in
/// `survey`.
TrialTime trial_time(const Suite& suite, double enough, WorldSurvey& survey);

/// Worlds 0 .. n-1 of a suite (100,000 at most) by family.
std::map<std::string, std::uint64_t> family_counts(const Suite& suite);

}  // namespace moma::run
