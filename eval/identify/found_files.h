#pragma once

#include <string>

#include "eval/identify/identify.h"
#include "world/sensing/disturbances.h"

namespace moma::identify {

/// What was found as the section `disturbances` of a suite; what cannot be found stays off. Delays and noise below a
/// millionth are left out.
Disturbances disturbances_of(const Found& found);

/// Files in YAML that say in their head where they come from and what could not be found. `source`: of the log.
std::string disturbances_file(const Found& found, const std::string& source);
/// A controller's `prediction` and `uncertainty`, to be put beside its gains, with `include: moma-safe.yaml`.
std::string controller_file(const Found& found, const std::string& source);

/// For a person: each thing that was found with its unit, and the notes.
std::string summary(const Found& found);

}  // namespace moma::identify
