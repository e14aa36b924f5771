#include "eval/trial/spec_file.h"

#include <fmt/format.h>

#include "controller/config/read_described.h"
#include "controller/config/write_described.h"
#include "world/sensing/disturbances_file.h"

namespace moma {

using config::MapReader;
using config::Node;

SimulationConfig read_simulation(const Node& node, const std::string& key) {
  SimulationConfig simulation;
  MapReader in(node, key);
  config::read_members(in, simulation);
  in.finish();
  in.check(simulation.mode == SimulationMode::kKinematic || simulation.joint_limits == AtJointLimit::kEnd,
           "joint_limits",
           fmt::format("{} is of kinematic mode; with physics a joint meets its own stops",
                       to_string(simulation.joint_limits)));
  in.check(
      simulation.time_limit >= simulation.control_period, "time_limit",
      fmt::format("{} s is shorter than one control period ({} s)", simulation.time_limit, simulation.control_period));
  return simulation;
}

SuccessRule read_success(const Node& node, const std::string& key, const SimulationConfig& simulation) {
  SuccessRule success;
  MapReader in(node, key);
  config::read_members(in, success);
  in.finish();
  in.check(success.dwell < simulation.time_limit, "dwell",
           fmt::format("{} s does not fit into the time limit of {} s: no trial could succeed", success.dwell,
                       simulation.time_limit));
  return success;
}

StuckRule read_stuck(const Node& node, const std::string& key, const SimulationConfig& simulation) {
  StuckRule stuck;
  MapReader in(node, key);
  config::read_members(in, stuck);
  in.finish();
  const auto check = [&](double time, const char* at) {
    in.check(time >= 2.0 * simulation.control_period, at,
             fmt::format("half of {} s is shorter than the control period of {} s; .inf switches the rule off", time,
                         simulation.control_period));
  };
  check(stuck.ends.time, "time");
  check(stuck.disturbed.time, "disturbed.time");
  return stuck;
}

InfeasibleRule read_infeasible(const Node& node, const std::string& key) {
  InfeasibleRule infeasible;
  config::read_described(node, key, infeasible);
  return infeasible;
}

Json sections_json(const TrialSpec& spec) {
  Json json = {{"simulation", config::write_described(spec.simulation)},
               {"success", config::write_described(spec.success)},
               {"stuck", config::write_described(spec.stuck)},
               {"infeasible", config::write_described(spec.infeasible)}};
  if (any(spec.disturbances)) json["disturbances"] = to_json(spec.disturbances);
  return json;
}

}  // namespace moma
