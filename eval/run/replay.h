#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "controller/case/case_file.h"
#include "eval/store/reader.h"
#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"
#include "eval/trial/trial.h"
#include "eval/trial/trial_detail.h"

namespace moma::run {

/// "trial 3f9a12e80b7c6d54", for messages.
inline std::string trial_name(const store::StoredTrial& trial) { return "trial " + trial.key.substr(0, 16); }

/// Suites rebuilt from a store, each once: reading a robot takes much longer than finding a trial.
class StoredSuites {
 public:
  explicit StoredSuites(Plugins plugins = Plugins::kRefused) : plugins_(plugins) {}
  /// Returns the point. Throws StoreError if this program simulates differently. `of`: whose it is, for messages.
  const SuitePoint& point_of(const store::StoredPoint& point, const std::string& of);
  const SuitePoint& point_of(const store::StoredTrial& trial) { return point_of(trial, trial_name(trial)); }
  const Suite& suite_of(const store::StoredPoint& point, const std::string& of);

 private:
  Plugins plugins_;
  std::map<std::string, Suite> suites_;  ///< by resolved text
};

/// Throws StoreError{kNotFound} if the trial's world could not be made, so that there is nothing to simulate.
World world_of(const store::StoredTrial& trial);

/// Returns the stored suite of this name, with another number of worlds unless `trials` is empty (checked like a
/// file's). Throws StoreError, config::ConfigError.
Suite stored_suite(const fs::path& store, const std::string& name, const std::string& trials = "",
                   Plugins plugins = Plugins::kRefused);

/// A stored trial, simulated again from the store alone.
struct Replay {
  store::StoredTrial trial;
  World world;
  const SuitePoint* point = nullptr;  ///< owned by the given StoredSuites
  TrialOutput output;
};

/// `name`: of the trial, or any unique beginning of it. Throws StoreError where there is no such trial or it cannot be
/// simulated again. `detail`, where it is asked for: what its controller went by.
Replay replay(const fs::path& store, const std::string& name, StoredSuites& suites, TrialDetail* detail = nullptr);

/// Differences between a replay and the stored row.
struct ReplayDifferences {
  std::vector<std::string> lines;  ///< one per differing metric, "stored != replayed"; empty: equal bit for bit
  std::string stored_machine;      ///< stored machine class if it differs from this machine's; else ""
  std::string this_machine;
};
ReplayDifferences differences(const TrialRow& stored, const std::string& machine_class, const TrialRow& replayed);

/// Control step `step` of a stored trial as a case, from the store alone. `trial`: its name or a unique beginning.
/// Throws RunError where the trial ends before or its controller is a plugin, and what StoredSuites does.
ControlCase stored_case(StoredSuites& suites, const fs::path& store, const std::string& trial, long step);

/// A collision of a stored trial, with the robot's motion before it.
struct CollisionCase {
  std::string world;            ///< JSON, as stored
  std::string disturbances;     ///< JSON, as stored
  std::string object;           ///< name of the touched object
  double control_period = 0.0;  ///< [s]
  double contact_time = 0.0;    ///< [s]
  std::vector<double> t;        ///< times of the samples [s]
  std::vector<double> base;     ///< x, y, heading of each sample, one after the other [m, m, rad]
};

/// Returns the time [s] between the detection of the object, by the simulation's own rule (world/sensing/detection.h),
/// and the collision. Empty if the object is not one of the world's, or if no detection was needed. Throws if worlds or
/// disturbances cannot be read.
std::optional<double> known_before_contact(const CollisionCase& collision);

}  // namespace moma::run
