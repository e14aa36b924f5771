#pragma once

namespace moma {

inline constexpr double kPeriod = 0.02;  ///< control period of the tests [s]

}  // namespace moma
