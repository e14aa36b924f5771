#include "eval/identify/noise.h"

#include <algorithm>
#include <cmath>

namespace moma::identify {
namespace {

constexpr double kNormal = 1.4826;  // 1/Phi^-1(3/4)

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double robust_deviation(std::vector<double>& values) {
  for (double& value : values) value = std::abs(value);
  return kNormal * median(values);
}

double noise_of(const std::vector<double>& off) {
  if (off.size() < 3) return 0.0;
  std::vector<double> differences;
  for (std::size_t k = 1; k < off.size(); ++k) differences.push_back(off[k] - off[k - 1]);
  return robust_deviation(differences) / std::sqrt(2.0);
}

double noise_of_even_motion(const std::vector<double>& values) {
  if (values.size() < 4) return 0.0;
  std::vector<double> bends;
  for (std::size_t k = 2; k < values.size(); ++k) bends.push_back(values[k] - 2.0 * values[k - 1] + values[k - 2]);
  return robust_deviation(bends) / std::sqrt(6.0);
}

}  // namespace moma::identify
