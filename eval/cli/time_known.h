#pragma once

#include <optional>

#include "reports/render/evidence.h"

namespace moma::cli {

/// What reports ask about collisions, answered by the simulation's own rules: see run::known_before_contact().
std::optional<double> time_known(const reports::HitObject& question);

}  // namespace moma::cli
