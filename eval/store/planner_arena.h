#pragma once

#include <cstddef>
#include <filesystem>

#include "files/output_file.h"

namespace moma::store {

struct PlannerArenaSummary {
  std::size_t experiments = 0;
  std::size_t planners = 0;
  std::size_t runs = 0;
  std::size_t progress = 0;  ///< rows of time series
};

/// Writes a store's trials as a benchmark database of OMPL, which Planner Arena shows: tables experiments,
/// plannerConfigs, enums, runs and progress as ompl.kavrakilab.org/benchmark.html describes them. An experiment is a
/// family of a suite (with one robot and mode), a planner configuration a point, a run a trial. Properties that OMPL
/// names have its names (time, solved, status, solution_length, ...); the others are the columns of v_trials. `time`
/// is the time spent computing the trial, `time_to_goal_s` the simulated one. `progress` holds the errors of trials
/// whose samples are stored, at most `progress_per_run` rows each.
/// `out` appears whole or not at all; OMPL writes such files too, so that one that is there gives way to kAny alone.
/// Throws StoreError, files::OutputError.
PlannerArenaSummary export_planner_arena(const std::filesystem::path& db, const std::filesystem::path& out,
                                         files::Replace replace = files::Replace::kOwn, int progress_per_run = 100);

}  // namespace moma::store
