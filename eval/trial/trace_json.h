#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "eval/trial/trial.h"

namespace moma {

/// The trace file of `moma replay --json`: the inputs (robot, controller, world, simulation, rules, all resolved), the
/// outcome, and one sample per control step, with the state before the step's command acts. Infinities are the strings
/// "inf" and "-inf". `trial` is the short form of the key in messages.
nlohmann::ordered_json trace_json(const TrialSpec& spec, const World& world, const TrialOutput& output,
                                  const std::string& trial);

}  // namespace moma
