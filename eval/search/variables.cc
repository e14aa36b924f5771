#include "eval/search/variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace moma::tune {
namespace {

double six_digits(double value) {
  char text[64];
  const auto written = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific, 5);
  double rounded = value;
  std::from_chars(text, written.ptr, rounded);
  return rounded;
}

}  // namespace

void check(const Variable& v) {
  const auto fail = [&](const std::string& message) { throw std::invalid_argument(v.key + ": " + message); };
  if (!std::isfinite(v.lower) || !std::isfinite(v.upper)) fail("range must be two finite numbers");
  if (v.lower >= v.upper) {
    fail(fmt::format("range [{}, {}] must have its lower end below its upper end; write [lower, upper]", v.lower,
                     v.upper));
  }
  if (v.scale == Scale::kLog && v.lower <= 0.0) {
    fail(fmt::format("range [{}, {}] with scale log must be above zero; raise the lower end or use scale: linear",
                     v.lower, v.upper));
  }
  if (v.scale == Scale::kInteger && (v.lower != std::floor(v.lower) || v.upper != std::floor(v.upper))) {
    fail(fmt::format("range [{}, {}] with scale integer needs whole numbers", v.lower, v.upper));
  }
  if (!(v.start >= v.lower && v.start <= v.upper)) {
    fail(fmt::format("start {} is outside its range [{}, {}]", v.start, v.lower, v.upper));
  }
}

double from_unit(const Variable& v, double u) noexcept {
  u = std::clamp(u, 0.0, 1.0);
  double value = 0.0;
  switch (v.scale) {
    case Scale::kLinear:
      value = v.lower + u * (v.upper - v.lower);
      break;
    case Scale::kLog:
      value = std::exp(std::log(v.lower) + u * (std::log(v.upper) - std::log(v.lower)));
      break;
    case Scale::kInteger:
      value = std::round(v.lower + u * (v.upper - v.lower));
      break;
  }
  return std::clamp(v.scale == Scale::kInteger ? value : six_digits(value), v.lower, v.upper);
}

double to_unit(const Variable& v, double value) noexcept {
  const double u = v.scale == Scale::kLog
                       ? (std::log(value) - std::log(v.lower)) / (std::log(v.upper) - std::log(v.lower))
                       : (value - v.lower) / (v.upper - v.lower);
  return std::clamp(u, 0.0, 1.0);
}

Candidate from_unit(std::span<const Variable> variables, std::span<const double> unit) {
  Candidate candidate(variables.size());
  for (std::size_t i = 0; i < variables.size(); ++i) candidate[i] = from_unit(variables[i], unit[i]);
  return candidate;
}

std::vector<double> to_unit(std::span<const Variable> variables, std::span<const double> candidate) {
  std::vector<double> unit(variables.size());
  for (std::size_t i = 0; i < variables.size(); ++i) unit[i] = to_unit(variables[i], candidate[i]);
  return unit;
}

Candidate start_of(std::span<const Variable> variables) {
  Candidate candidate;
  for (const Variable& v : variables) candidate.push_back(v.start);
  return candidate;
}

double distance(std::span<const Variable> variables, std::span<const double> a, std::span<const double> b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    largest = std::max(largest, std::abs(to_unit(variables[i], a[i]) - to_unit(variables[i], b[i])));
  }
  return largest;
}

std::string to_text(double value) {
  char text[64];
  const auto written = std::to_chars(text, text + sizeof text, value);
  return {text, written.ptr};
}

}  // namespace moma::tune
