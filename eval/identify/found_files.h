#pragma once

#include <string>

#include "eval/identify/identify.h"
#include "world/sensing/disturbances.h"

namespace moma::identify {

/// Returns the estimates as a suite's section `disturbances`; quantities without an estimate stay off. Delays and noise
/// below a millionth are left out.
Disturbances disturbances_of(const Found& found);

/// YAML files whose heads name their origin and the quantities without an estimate. `source`: name of the log.
std::string disturbances_file(const Found& found, const std::string& source);
/// Returns a controller's `prediction` and `uncertainty`, to combine with its gains, with `include: moma-safe.yaml`.
std::string controller_file(const Found& found, const std::string& source);

/// Summarises the estimates for a person, with units and notes.
std::string summary(const Found& found);

}  // namespace moma::identify
