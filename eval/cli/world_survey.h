#pragma once

#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "eval/batch/batch.h"

namespace moma::cli {

/// What `moma check` says about the making of a suite's worlds: by robot and family how many tries a world takes, why
/// tries are rejected, how long it takes and how long beside a trial (processor time, so that other programs do not
/// count).
class WorldSurvey {
 public:
  /// Makes about `count` worlds in all, the first ones of each robot and `worlds` section among the points, of which
  /// there are `trials`.
  void make_worlds(const std::vector<Point>& points, std::uint64_t count, std::uint64_t trials);
  /// Computes a job on this thread and counts the trial's time.
  void run(const Point& point, const BatchJob& job);

  /// Nothing where no world had to be made (frozen sets). Times only where asked for: all else is the same every time.
  void print(std::ostream& out, bool times) const;
  /// Worlds that cannot be made, one sentence per robot and family.
  const std::vector<std::string>& failures() const { return failures_; }

 private:
  struct Tally {
    MakingLog log;
    double seconds = 0.0;  ///< spent on making
    std::uint64_t failed = 0;
    std::uint64_t trials = 0;
    double trial_seconds = 0.0;  ///< without the making of the world
  };
  using Place = std::pair<std::string, std::string>;  ///< robot, family

  void make_worlds(const Point& point, std::uint64_t count);

  std::map<Place, Tally> tallies_;
  std::vector<std::string> failures_;
};

}  // namespace moma::cli
