#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/identify/motion_log.h"

namespace moma::identify {

/// Axes that one drive follows together: of an omnidirectional base vx and vy, whose ramp bounds their vector's length;
/// else one alone.
using Group = std::vector<const Axis*>;

/// What a drive makes of its commands, as a log shows it. With the command u_k of row k, T the control period,
///
///   r_k = r_{k-1} + clip(u_k - r_{k-1}, a' T),   v_k = g r_{k-1-n} + noise,
///
/// the vector's length being clipped; a = g a' is the acceleration at which the velocity grows. n is the round trip in
/// periods, from a command until the velocity that it leads to is measured.
struct Response {
  double gain = 1.0;          ///< g [1]
  double acceleration = 0.0;  ///< a [m/s^2, rad/s^2]; infinite without a ramp
  double squared = 0.0;       ///< sum of the squared differences of what is measured from that
  std::size_t saturated = 0;  ///< rows in which the ramp holds back
};

/// r of each axis and row, for a' = acceleration. It begins at what is measured of r_0, in row n + 1.
std::vector<std::vector<double>> ramped(const Group& group, int n, double acceleration, double period);

/// What is looked for besides g: nothing, a' among 20 values, or a' to the last digit that matters.
enum class Ramp { kNone, kCoarse, kFine };

/// Least squares of g, and of a' as `ramp` says: over 20 or 60 values from 0.02 to 200, evenly in their logarithm, the
/// latter with a golden section between the best one's neighbours; at the round trip of n periods. Rows from `from` on
/// count, so that every n is judged by the same ones; from >= n + 1.
Response fit_response(const Group& group, int n, std::size_t from, Ramp ramp, double period);

}  // namespace moma::identify
