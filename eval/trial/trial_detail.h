#pragma once

#include <string>
#include <vector>

#include "controller/case/case_file.h"
#include "controller/config/json.h"
#include "controller/map/occupancy_map.h"
#include "controller/qp/problem.h"
#include "eval/trial/trial.h"

namespace moma {

/// Writes the control step k = 0, 1, 2 ... of a trial as a case: simulates the trial up to there and stores the
/// controller's observation and memory, so that `moma solve` repeats the step to the last bit. Throws
/// std::invalid_argument if the trial ends before, or if its controller is a plugin.
ControlCase case_of_step(const TrialSpec& spec, const World& world, long k);

/// Record of what the controller of one trial went by: the QP's rows about distances, at the state that it predicted
/// and of the objects that it sensed, the boxes of its map, and where its sensors looked.
struct TrialDetail {
  struct Row {
    double t = 0.0;  ///< of the control step [s]
    RowId id;
    int first = 0;        ///< index into `names`: the robot's link
    int second = 0;       ///< index of the other body: an object, the floor, another link
    bool active = false;  ///< at its limit in the solution
  };
  std::vector<std::string> names;
  std::vector<Row> rows;  ///< step by step, each step's in the order of the problem

  /// A box of the map (controller/map/seen_map.h) that is the same from one picture of the map to another. Picture k is
  /// of the first step from k / kMapRate on.
  struct Box {
    int from = 0;      ///< first picture
    int to = 0;        ///< the picture after the last
    bool seen = true;  ///< occupied; false: unseen
    CellBox cells;     ///< from the origin of the axes of the measured base pose
  };
  static constexpr double kMapRate = 4.0;  ///< pictures per second
  double cell = 0.0;                       ///< edge of a cell of the map [m]; 0 without a map
  std::vector<Box> boxes;                  ///< by their first picture
  /// Angles of a sensor's head, as measured, in a frame that the map got.
  struct Look {
    int sensor = 0;  ///< index into RobotModel::sensors
    double t = 0.0;  ///< at which the frame was taken [s]
    Gaze gaze;
  };
  std::vector<Look> looks;  ///< of heads that turn
};

/// Simulates a trial as run_trial() does, and writes down what its controller went by. There are no rows of a
/// controller that poses no QP, and nothing of a plugin.
TrialOutput run_trial(const TrialSpec& spec, const World& world, TrialDetail& detail);

/// The trace file of `moma replay --json`: the inputs (robot, controller, world, simulation, rules, all resolved), the
/// outcome, and one sample per control step, with the state before the step's command acts. Infinities are the strings
/// "inf" and "-inf". `trial` is the short form of the key in messages.
Json trace_json(const TrialSpec& spec, const World& world, const TrialOutput& output, const std::string& trial);

}  // namespace moma
