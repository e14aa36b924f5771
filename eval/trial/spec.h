#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "controller/config/robot_file.h"
#include "controller/params.h"
#include "plugin/host/plugin.h"
#include "world/plant/plant.h"
#include "world/sensing/disturbances.h"

namespace moma {

struct SuccessRule {
  double position = 0.02;     ///< [m]
  double orientation = 0.05;  ///< [rad]
  double dwell = 0.2;         ///< [s]
};

struct StuckRule {
  double time = 2.0;       ///< [s]
  double motion = 0.0005;  ///< [m or rad]
};

struct InfeasibleRule {
  double time = 0.5;  ///< [s]
};

/// All that decides a trial besides its world: robot, controller, simulation, the rules by which it ends, disturbances.
/// A suite makes one for each of its points; a program of one's own can fill it by hand. trial_key() digests
/// what is resolved here.
struct TrialSpec {
  std::shared_ptr<const config::LoadedRobot> robot;
  std::string robot_digest;  ///< XXH3-128 of robot->resolved, 32 hex digits; shared by all specs of a robot
  ControllerParams controller_params;
  std::shared_ptr<const Plugin> plugin;  ///< with `method: plugin`: stands in for controller_params
  /// All of its parameters. Of a plugin: the digest of its library and the parameters handed over, not the path, so
  /// that trials are known again wherever the library lies.
  nlohmann::ordered_json controller_resolved;
  SimulationConfig simulation;
  SuccessRule success;
  StuckRule stuck;
  InfeasibleRule infeasible;
  Disturbances disturbances;  ///< all off by default
};

/// Whether the controller is one of moma's QPs.
inline bool has_qp(const TrialSpec& spec) noexcept {
  return spec.plugin == nullptr && spec.controller_params.method == Method::kQp;
}

}  // namespace moma
