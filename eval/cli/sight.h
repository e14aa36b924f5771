#pragma once

#include <optional>

#include "reports/render/evidence.h"

namespace moma::cli {

/// By the rule that the simulation found the objects by (world/sensing/detection.h). Throws what its parts throw on
/// worlds and disturbances that cannot be read.
std::optional<double> known_before_contact(const reports::SightQuestion& question);

}  // namespace moma::cli
