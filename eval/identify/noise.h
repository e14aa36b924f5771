#pragma once

#include <vector>

namespace moma::identify {

/// Standard deviation of white noise on values that follow a model but for what changes slowly: 1.4826 times the median
/// absolute difference of consecutive values, over sqrt(2) (Rousseeuw & Croux, JASA 88(424), 1993, of differences):
/// steps and what the model misses now and then do not count. 0 of fewer than 3 values.
double noise_of(const std::vector<double>& off);

/// The same for values that rest or move evenly, by their second differences, whose variance is 6 times that of the
/// noise.
double noise_of_even_motion(const std::vector<double>& values);

/// 1.4826 times the median of |values|: the standard deviation of normal values about 0. Reorders them.
double robust_deviation(std::vector<double>& values);

double median(std::vector<double> values);

}  // namespace moma::identify
