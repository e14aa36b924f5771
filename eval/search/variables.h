#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/describe/enumeration.h"

namespace moma::tune {

// Enumerations of a search in the store's columns, whose checks are generated from these words.

enum class SearchStatus { kRunning, kFinished, kStopped };
constexpr auto words(Of<SearchStatus>) { return std::to_array<std::string_view>({"running", "finished", "stopped"}); }

/// Mapping of a variable to the unit interval.
enum class Scale { kLinear, kLog, kInteger };
constexpr auto words(Of<Scale>) { return std::to_array<std::string_view>({"linear", "log", "integer"}); }

enum class Phase { kStart, kGlobal, kLocal, kConfirm, kNeighbour, kSensitivity };
constexpr auto words(Of<Phase>) {
  return std::to_array<std::string_view>({"start", "global", "local", "confirm", "neighbour", "sensitivity"});
}

/// Verdict on the found gains against others.
enum class Verdict { kBetter, kNoDifference, kWorse };
constexpr auto words(Of<Verdict>) {
  return std::to_array<std::string_view>({"better", "no difference shown", "worse"});
}

/// Values of all variables in their own units and order. Always rounded (see Variable).
using Candidate = std::vector<double>;

/// One searched key. The search works in the unit cube: u = 0 is `lower`, u = 1 is `upper`, evenly in the value, in its
/// logarithm, or in whole numbers.
struct Variable {
  std::string key;  ///< key as in --set: controller.k_epsilon
  double lower = 0.0;
  double upper = 1.0;
  Scale scale = Scale::kLinear;
  double start = 0.5;  ///< within [lower, upper]
};

/// Throws std::invalid_argument with the key and the accepted values: bounds that are not finite, lower not below
/// upper, a log scale that includes zero, a start outside, integer bounds that are not whole.
void check(const Variable& variable);

/// Returns the value at u in [0, 1], rounded to six significant digits (whole numbers for kInteger) and clamped to the
/// bounds. Rounding gives a candidate the same bits in memory, in the store and in a YAML file.
double from_unit(const Variable& variable, double u) noexcept;
double to_unit(const Variable& variable, double value) noexcept;

Candidate from_unit(std::span<const Variable> variables, std::span<const double> unit);
std::vector<double> to_unit(std::span<const Variable> variables, std::span<const double> candidate);
Candidate start_of(std::span<const Variable> variables);

/// Largest difference between two candidates over the variables, in the unit cube.
double distance(std::span<const Variable> variables, std::span<const double> a, std::span<const double> b);

/// Returns the shortest text that reads back as the same bits.
std::string to_text(double value);

}  // namespace moma::tune
