#pragma once

#include <memory>
#include <string>

#include "controller/config/robot_file.h"
#include "controller/describe/describe.h"
#include "controller/params.h"
#include "plugin/host/plugin.h"
#include "world/plant/plant.h"
#include "world/sensing/disturbances.h"

namespace moma {

/// Both errors stay within tolerance at every sample for the dwell time (rules.h).
struct SuccessRule {
  double position = 0.02;     ///< [m]
  double orientation = 0.05;  ///< [rad]
  double dwell = 0.2;         ///< [s]
  double l1 = kInfinity;      ///< [m + rad]
};

constexpr void describe(auto& v, Of<SuccessRule>) {
  using T = SuccessRule;
  v.member("position", &T::position, in_range({0.0, 10.0, true, false}, "m", "tolerance of success"));
  v.member("orientation", &T::orientation, in_range({0.0, 3.15, true, false}, "rad", "tolerance of success"));
  v.member("dwell", &T::dwell, in_range({0.0, 3600.0}, "s", "time within both tolerances"));
  v.member("l1", &T::l1,
           unless_default(in_range(
               Range::positive_or_inf(), "m + rad",
               "additional tolerance of |x| + |y| + |z| + |roll| + |pitch| + |yaw| of the goal as seen from E")));
}

struct StillRule {
  double time = 2.0;       ///< [s]
  double motion = 0.0005;  ///< [m or rad]
  bool operator==(const StillRule&) const = default;
};

constexpr void describe(auto& v, Of<StillRule>) {
  using T = StillRule;
  v.member("time", &T::time,
           in_range(Range::positive_or_inf(), "s",
                    "a trial is stuck if both halves of this time are still (disturbed: where disturbances are on); "
                    ".inf: never"));
  v.member("motion", &T::motion,
           in_range({0.0, 1.0, true, false}, "m or rad",
                    "motion of each coordinate (disturbed: of its mean) below which a half is still"));
}

/// The rule of being stuck: ends of halves are compared, or means over halves where disturbances are on.
struct StuckRule {
  StillRule ends;
  StillRule disturbed{4.0, 0.005};
};

constexpr void describe(auto& v, Of<StuckRule>) {
  v.inlined(&StuckRule::ends);
  v.member("disturbed", &StuckRule::disturbed,
           unless_default({.text = "the same where disturbances are on, between means over halves"}));
}

struct InfeasibleRule {
  double time = 0.5;  ///< [s]
};

constexpr void describe(auto& v, Of<InfeasibleRule>) {
  v.member("time", &InfeasibleRule::time,
           in_range(Range::positive_or_inf(), "s", "time of uninterrupted braking after which a trial is infeasible"));
}

/// Everything that determines a trial besides its world: robot, controller, simulation, rules, disturbances. A suite
/// makes one per point; your own program can fill one by hand. trial_key() digests the resolved members.
struct TrialSpec {
  std::shared_ptr<const config::LoadedRobot> robot;
  std::string robot_digest;  ///< XXH3-128 of robot->resolved, 32 hex digits; shared by all specs of a robot
  ControllerParams controller_params;
  std::shared_ptr<const Plugin> plugin;  ///< with `method: plugin`: replaces controller_params
  /// All parameters. For a plugin the digest of its library and the parameters passed to it, not the path: trials are
  /// recognised wherever the library is.
  Json controller_resolved;
  SimulationConfig simulation;
  SuccessRule success;
  StuckRule stuck;
  InfeasibleRule infeasible;
  Disturbances disturbances;  ///< all off by default
};

/// True if the controller is one of moma's QPs.
inline bool has_qp(const TrialSpec& spec) noexcept {
  return spec.plugin == nullptr && spec.controller_params.method == Method::kQp;
}

}  // namespace moma
