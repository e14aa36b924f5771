#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "controller/config/paths.h"
#include "eval/trial/row.h"

namespace moma::run {

/// Returns a sentence for each wheel that extends beyond the base's collision shapes, as seen from above, by more than
/// 5 mm: the wheel would run over objects beside the base without a counted collision. Wheels are reduced to their
/// middle planes. Empty for a base without wheels.
std::vector<std::string> wheel_warnings(const RobotModel& model);

/// Finds links whose visuals extend beyond the collision shapes of the link and of all links rigid with it, by more
/// than 2 cm at `ready`. Returns one sentence about the worst, from the outermost points of each visual in the robot
/// file's URDF. Empty if the arm has no shapes at all, or if a visual mesh cannot be read. Reads all meshes, which
/// takes some tenths of a second.
std::vector<std::string> visual_warnings(const fs::path& robot_file, const RobotModel& model);

/// Joints whose drive is too weak for the arm's own weight, at `ready` or somewhere in their range: a sentence for
/// each. With physics such an arm sags or falls, whatever its controller.
std::vector<std::string> holding_warnings(const std::shared_ptr<const RobotModel>& model);

/// Finds contradictions between a run's rows and its physics, and between rows and the robot description of the
/// controllers, for warnings without a request.
class RowWarnings {
 public:
  /// `identifies`: the controller uses identified latencies, so that deviating latencies need no warning.
  void look(const TrialRow& row, bool identifies = false);
  /// Returns a sentence for each kind of contradiction, with the SQL that lists its trials.
  std::vector<std::string> sentences() const;

 private:
  int contradicted_ = 0, messages_ = 0, errors_ = 0, diverged_ = 0;  // numbers of trials
  int latencies_ = 0;
  double deepest_ = 0.0;      // [m]
  double latency_off_ = 0.0;  // the largest, with its sign [s]
};

/// Finds points of a suite that cannot work: all of their trials end by one and the same error.
class SameError {
 public:
  /// Number of a point's first trials that establishes the error.
  static constexpr int kEnough = 20;

  /// Rows in the order of the jobs, so that the answer is the same for any number of threads.
  void look(std::size_t point, const TrialRow& row);
  struct Found {
    std::size_t point = 0;
    int trials = 0;
    std::string reason;
  };
  /// The point with most such trials; nothing where there is none.
  const Found* found() const;
  /// A point has had enough.
  bool enough() const { return found() != nullptr && found()->trials >= kEnough; }

 private:
  std::map<std::size_t, Found> failing_;  // without another outcome or reason so far
  std::set<std::size_t> working_;
};

}  // namespace moma::run
