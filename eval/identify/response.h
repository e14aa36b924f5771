#pragma once

#include <vector>

#include "eval/identify/motion_log.h"

namespace moma::identify {

/// Returns the standard deviation of white noise on a slowly varying residual: 1.4826 times the median absolute
/// difference of consecutive values, over sqrt(2) (Rousseeuw & Croux, JASA 88(424), 1993, of differences). Steps and
/// occasional misfits of the model do not count. 0 for fewer than 3 values.
double noise_of(const std::vector<double>& off);

/// Returns the same for values at rest or in uniform motion, from second differences, whose variance is 6 times that of
/// the noise.
double noise_of_even_motion(const std::vector<double>& values);

/// Returns 1.4826 times the median of |values|: the standard deviation of normal values about 0. Reorders them.
double robust_deviation(std::vector<double>& values);

/// Axes of one drive: vx and vy of an omnidirectional base, whose ramp bounds the length of their vector; otherwise a
/// single axis.
using Group = std::vector<const Axis*>;

/// A drive's response to its commands, as the log shows it. With the command u_k of row k and the control period T,
///
///   r_k = r_{k-1} + clip(u_k - r_{k-1}, a' T),   v_k = g r_{k-1-n} + noise,
///
/// where the clip acts on the vector's length; a = g a' is the acceleration of the velocity. n is the round trip in
/// periods, from a command to the measurement of its effect.
struct Response {
  double gain = 1.0;          ///< g [1]
  double acceleration = 0.0;  ///< a [m/s^2, rad/s^2]; infinite without a ramp
  double squared = 0.0;       ///< sum of the squared residuals
  std::size_t saturated = 0;  ///< number of rows that the ramp limits
};

/// Returns r of each axis and row, for a' = acceleration. The first value is the measured r_0, in row n + 1. Sets
/// `limited` if the ramp limits a row.
std::vector<std::vector<double>> ramped(const Group& group, int n, double acceleration, double period,
                                        bool* limited = nullptr);

/// Search for the ramp besides g: none, a' among 20 values, or a' to all significant digits.
enum class Ramp { kNone, kCoarse, kFine };

/// Fits g, and a' according to `ramp`, by least squares at a round trip of n periods. a' takes 20 or 60 values from
/// 0.02 to 200, evenly in the logarithm; the latter search refines it by a golden section between the best value's
/// neighbours. Only rows from `from` >= n + 1 count, so that all n are judged by the same rows.
Response fit_response(const Group& group, int n, std::size_t from, Ramp ramp, double period);

}  // namespace moma::identify
