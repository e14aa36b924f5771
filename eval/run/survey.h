#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "eval/batch/batch.h"
#include "eval/suite/suite.h"

namespace moma::run {

/// Statistics of worlds: starts in contact, and gaps between tool and objects at the goals.
struct WorldLook {
  /// Gap between the tool and the nearest object at a world's goals.
  struct Gap {
    double d = 0.0;     ///< infinite if nothing is nearer than 0.5 m [m]
    std::string where;  ///< "world 3, panda_hand and can"
  };
  std::uint64_t in_touch = 0;  ///< number of worlds that start in contact
  std::string first_touch;     ///< as Gap::where
  std::vector<Gap> goals;      ///< of each world
};

/// Examines a world of the robot at t = 0. At the start all pairs that can collide count: objects, floor and the robot
/// itself. At the goals only pairs that no configuration changes count: shapes that are rigid with the tool against
/// objects at rest. Costs about two configurations' distances, and one more for each goal.
void look_at(const World& world, const std::shared_ptr<const RobotModel>& model, WorldLook& look);

/// Statistics of drawing a suite's worlds by robot and family: tries per world, reasons of rejection, and processor
/// time per world and per trial.
class WorldSurvey {
 public:
  struct Tally {
    MakingLog log;
    double seconds = 0.0;  ///< processor time of drawing worlds
    std::uint64_t failed = 0;
    std::uint64_t trials = 0;
    double trial_seconds = 0.0;  ///< processor time of trials without drawing
  };
  using Place = std::pair<std::string, std::string>;  ///< robot, family

  /// Makes and examines about `count` worlds in all, the first of each robot and `worlds` section among the points of
  /// `trials` trials; `count` worlds of each frozen set. The points must outlive the survey.
  void make_worlds(const std::vector<SuitePoint>& points, std::uint64_t count, std::uint64_t trials);
  /// Computes a job on this thread and adds the trial's time.
  void run(const SuitePoint& point, const BatchJob& job);

  /// Empty if no world is drawn (frozen sets).
  const std::map<Place, Tally>& tallies() const { return tallies_; }
  /// Worlds that cannot be made, one sentence per robot and family.
  const std::vector<std::string>& failures() const { return failures_; }
  /// Returns doubts about the drawn worlds: robots that start in contact, goals nearer to objects than controllers
  /// keep. One sentence each, with counts.
  std::vector<std::string> doubts() const;

 private:
  /// Points with the same robot and worlds.
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

/// Measured duration of a suite's trials.
struct TrialTime {
  double each = 0.0;         ///< wall time of a trial [s]
  std::size_t measured = 0;  ///< number of measured trials
};

/// Measures trials for about `enough` seconds in all: points in turn, worlds spread over the suite's. They count in
/// `survey`.
TrialTime trial_time(const Suite& suite, double enough, WorldSurvey& survey);

/// Counts worlds 0 .. n-1 of a suite (100,000 at most) by family.
std::map<std::string, std::uint64_t> family_counts(const Suite& suite);

}  // namespace moma::run
