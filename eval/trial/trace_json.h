#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "eval/trial/trial.h"

namespace moma {

/// The trace file of `moma replay --json`: what was simulated (robot, controller, world, simulation, rules, all
/// resolved), the outcome, and one sample per control step, the state before the step's command acts. Infinities
/// are the strings "inf" and "-inf". `trial` is the key's name as shown to users.
nlohmann::ordered_json trace_json(const TrialSpec& spec, const World& world, const TrialOutput& output,
                                  const std::string& trial);

}  // namespace moma
