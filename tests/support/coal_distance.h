#pragma once

#include "controller/model/shape.h"

namespace moma::test {

/// Signed distance of two placed shapes by coal's own entry point with a tolerance of 1e-9, none of moma's code for
/// shapes, pairs or filters in between. Sphere, box, cylinder, capsule; throws std::invalid_argument for others.
double coal_distance(const Shape& first, const Isometry& X_W1, const Shape& second, const Isometry& X_W2);

}  // namespace moma::test
