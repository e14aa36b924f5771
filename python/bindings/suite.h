#pragma once

#include <cstdint>

#include "eval/suite/suite.h"
#include "python/bindings/bindings.h"

namespace moma::python {

/// Throws std::invalid_argument where the suite has no point of that number.
const SuitePoint& point_of(const Suite& suite, std::size_t i);

/// World `index` of a point. Throws GenerationError.
World make_world(const SuitePoint& point, std::uint64_t index);

}  // namespace moma::python
