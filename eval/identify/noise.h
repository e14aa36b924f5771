#pragma once

#include <vector>

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

double median(std::vector<double> values);

}  // namespace moma::identify
