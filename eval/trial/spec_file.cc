#include "eval/trial/spec_file.h"

#include <fmt/format.h>

#include <cmath>

#include "controller/config/json_node.h"
#include "controller/config/reader.h"

namespace moma {

using config::MapReader;
using config::Node;
using config::number_to_json;
using config::Range;

SimulationConfig read_simulation(const Node& node, const std::string& key) {
  SimulationConfig simulation;
  MapReader in(node, key);
  in.read_enum("mode", simulation.mode,
               {{"kinematic", SimulationMode::kKinematic}, {"dynamic", SimulationMode::kDynamic}});
  in.read("control_period", simulation.control_period, {1e-4, 1.0, false, false});
  in.read("physics_step", simulation.physics_step, {1e-5, 0.02, false, false});
  in.read("time_limit", simulation.time_limit, {0.0, 3600.0, true, false});
  in.read("cross_check", simulation.cross_check, {0.0, 1.0});
  in.finish();
  if (simulation.mode == SimulationMode::kDynamic) {
    const double ratio = simulation.control_period / simulation.physics_step;
    in.check(ratio > 0.5 && std::abs(ratio - std::round(ratio)) < 1e-9 * ratio, "control_period",
             fmt::format("{} s is not a whole multiple of physics_step ({} s)", simulation.control_period,
                         simulation.physics_step));
  }
  in.check(
      simulation.time_limit >= simulation.control_period, "time_limit",
      fmt::format("{} s is shorter than one control period ({} s)", simulation.time_limit, simulation.control_period));
  return simulation;
}

SuccessRule read_success(const Node& node, const std::string& key, const SimulationConfig& simulation) {
  SuccessRule success;
  MapReader in(node, key);
  in.read("position", success.position, {0.0, 10.0, true, false});
  in.read("orientation", success.orientation, {0.0, 3.15, true, false});
  in.read("dwell", success.dwell, {0.0, 3600.0, false, false});
  in.finish();
  in.check(success.dwell < simulation.time_limit, "dwell",
           fmt::format("{} s does not fit into the time limit of {} s: no trial could succeed", success.dwell,
                       simulation.time_limit));
  return success;
}

StuckRule read_stuck(const Node& node, const std::string& key, const SimulationConfig& simulation) {
  StuckRule stuck;
  MapReader in(node, key);
  in.read("time", stuck.time, Range::positive_or_inf());
  in.read("motion", stuck.motion, {0.0, 1.0, true, false});
  in.finish();
  in.check(stuck.time >= 2.0 * simulation.control_period, "time",
           fmt::format("half of {} s is shorter than the control period of {} s; .inf switches the rule off",
                       stuck.time, simulation.control_period));
  return stuck;
}

InfeasibleRule read_infeasible(const Node& node, const std::string& key) {
  InfeasibleRule infeasible;
  MapReader in(node, key);
  in.read("time", infeasible.time, Range::positive_or_inf());
  in.finish();
  return infeasible;
}

nlohmann::ordered_json to_json(const SimulationConfig& simulation) {
  return {{"mode", to_string(simulation.mode)},
          {"control_period", simulation.control_period},
          {"physics_step", simulation.physics_step},
          {"time_limit", simulation.time_limit},
          {"cross_check", simulation.cross_check}};
}

nlohmann::ordered_json to_json(const SuccessRule& success) {
  return {{"position", success.position}, {"orientation", success.orientation}, {"dwell", success.dwell}};
}

nlohmann::ordered_json to_json(const StuckRule& stuck) {
  return {{"time", number_to_json(stuck.time)}, {"motion", stuck.motion}};
}

nlohmann::ordered_json to_json(const InfeasibleRule& infeasible) { return {{"time", number_to_json(infeasible.time)}}; }

}  // namespace moma
