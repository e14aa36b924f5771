#pragma once

#include <string>

#include "controller/model/shape.h"
#include "controller/types.h"

namespace moma::cli {

/// "sphere, radius 0.1", "box 0.1 x 0.2 x 0.3", ..., in metres.
std::string shape_text(const Shape& shape);
/// "(0.1, 0.2, 0.3)", four digits behind the point.
std::string vector_text(const Eigen::Ref<const VectorX>& v);

}  // namespace moma::cli
