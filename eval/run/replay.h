#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "controller/case/case_file.h"
#include "eval/store/reader.h"
#include "eval/suite/stored.h"
#include "eval/trial/rows_of_trial.h"

namespace moma::run {

/// Suites rebuilt from a store, each once: reading a robot takes much longer than finding a trial.
class StoredSuites {
 public:
  explicit StoredSuites(Plugins plugins = Plugins::kRefused) : plugins_(plugins) {}
  /// Returns the point of `trial`. Throws StoreError if this program simulates differently.
  const SuitePoint& point_of(const store::StoredTrial& trial);
  const Suite& suite_of(const store::StoredTrial& trial);

 private:
  Plugins plugins_;
  std::map<std::string, Suite> suites_;  ///< by resolved text
};

/// Throws StoreError{kNotFound} if the trial's world could not be made, so that there is nothing to simulate.
World world_of(const store::StoredTrial& trial);

/// Returns the stored suite of this name, with another number of worlds unless `trials` is empty (checked like a
/// file's). Throws StoreError, config::ConfigError.
Suite stored_suite(const std::filesystem::path& store, const std::string& name, const std::string& trials = "",
                   Plugins plugins = Plugins::kRefused);

/// A stored trial, simulated again from the store alone.
struct Replay {
  store::StoredTrial trial;
  World world;
  const SuitePoint* point = nullptr;  ///< owned by the given StoredSuites
  TrialOutput output;
};

/// `name`: of the trial, or any unique beginning of it. Throws StoreError where there is no such trial or it cannot be
/// simulated again. `rows`, where they are asked for: of the QP (rows_of_trial.h).
Replay replay(const std::filesystem::path& store, const std::string& name, StoredSuites& suites,
              TrialRows* rows = nullptr);

/// Differences between a replay and the stored row.
struct ReplayDifferences {
  std::vector<std::string> lines;  ///< one per differing metric, "stored != replayed"; empty: equal bit for bit
  std::string stored_machine;      ///< stored machine class if it differs from this machine's; else ""
  std::string this_machine;
};
ReplayDifferences differences(const TrialRow& stored, const std::string& machine_class, const TrialRow& replayed);

/// Control step `step` of a stored trial as a case, from the store alone. `trial`: its name or a unique beginning.
/// Throws RunError where the trial ends before or its controller is a plugin, and what StoredSuites does.
ControlCase stored_case(StoredSuites& suites, const std::filesystem::path& store, const std::string& trial, long step);

}  // namespace moma::run
