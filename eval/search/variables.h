#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/search/words.h"

namespace moma::tune {

/// Values of all variables in their own units, in the order of the variables. Always rounded (see Variable).
using Candidate = std::vector<double>;

/// One key that is searched. The search itself happens in the unit cube: u = 0 is `lower`, u = 1 is `upper`, evenly
/// in the value, in its logarithm, or in whole numbers.
struct Variable {
  std::string key;  ///< as in --set: controller.k_epsilon
  double lower = 0.0;
  double upper = 1.0;
  Scale scale = Scale::kLinear;
  double start = 0.5;  ///< within [lower, upper]
};

/// Throws std::invalid_argument, naming the key and what would be accepted: bounds not finite, lower not below
/// upper, a log scale that meets zero, a start outside, integer bounds that are not whole.
void check(const Variable& variable);

/// Value at u in [0, 1], rounded to six significant digits (whole numbers for kInteger) and kept inside the bounds.
/// Rounding makes a candidate the same bits in memory, in the store and in a YAML file.
double from_unit(const Variable& variable, double u) noexcept;
double to_unit(const Variable& variable, double value) noexcept;

Candidate from_unit(std::span<const Variable> variables, std::span<const double> unit);
std::vector<double> to_unit(std::span<const Variable> variables, std::span<const double> candidate);
Candidate start_of(std::span<const Variable> variables);

/// Largest difference of two candidates over the variables, in the unit cube.
double distance(std::span<const Variable> variables, std::span<const double> a, std::span<const double> b);

/// Shortest text that reads back as the same bits.
std::string to_text(double value);

}  // namespace moma::tune
