#pragma once

#include <string>
#include <vector>

#include "controller/case/case_file.h"
#include "controller/config/json.h"
#include "controller/qp/problem.h"
#include "eval/trial/trial.h"

namespace moma {

/// Writes the control step k = 0, 1, 2 ... of a trial as a case: simulates the trial up to there and stores the
/// controller's observation and memory, so that `moma solve` repeats the step to the last bit. Throws
/// std::invalid_argument if the trial ends before, or if its controller is a plugin.
ControlCase case_of_step(const TrialSpec& spec, const World& world, long k);

/// The QP's rows about distances in one trial, as its controller posed them: at the state that it predicted, of the
/// objects that it sensed.
struct TrialRows {
  struct Row {
    double t = 0.0;  ///< of the control step [s]
    RowId id;
    int first = 0;        ///< index into `names`: the robot's link
    int second = 0;       ///< index of the other body: an object, the floor, another link
    bool active = false;  ///< at its limit in the solution
  };
  std::vector<std::string> names;
  std::vector<Row> rows;  ///< step by step, each step's in the order of the problem
};

/// Simulates a trial as run_trial() does, and writes down the rows of its controller. None of a controller that poses
/// no QP, or is a plugin.
TrialOutput run_trial(const TrialSpec& spec, const World& world, TrialRows& rows);

/// The trace file of `moma replay --json`: the inputs (robot, controller, world, simulation, rules, all resolved), the
/// outcome, and one sample per control step, with the state before the step's command acts. Infinities are the strings
/// "inf" and "-inf". `trial` is the short form of the key in messages.
Json trace_json(const TrialSpec& spec, const World& world, const TrialOutput& output, const std::string& trial);

}  // namespace moma
