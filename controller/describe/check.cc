#include "controller/describe/check.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace moma::description {
namespace {

std::string short_text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

}  // namespace

std::string number_violation(double value, const Range& range) {
  if (range.contains(value)) return "";
  std::string wanted;
  const bool low = range.low > -std::numeric_limits<double>::max();
  if (range.high == std::numeric_limits<double>::infinity() && low) {
    wanted = std::string(range.open_low ? "above " : "at least ") + number_text(range.low) + " or infinite";
  } else {
    wanted = accepted_number(range);
    wanted.replace(0, std::string("a number").size(), "a finite number");
  }
  return "must be " + wanted + ", is " + short_text(value);
}

std::string whole_number_violation(long long value, long long low, long long high) {
  if (value >= low && value <= high) return "";
  return "must be " + accepted_whole_number(low, high) + ", is " + std::to_string(value);
}

std::string numbers_violation(std::span<const double> values, int count, const About& about) {
  if (count >= 0 && static_cast<int>(values.size()) != count) {
    return "has " + std::to_string(values.size()) + " values, the robot has " + std::to_string(count) +
           (about.per == Per::kJoint ? " joints" : " velocities");
  }
  for (const double value : values) {
    std::string message = number_violation(value, about.range);
    if (!message.empty()) return message;
  }
  return "";
}

}  // namespace moma::description
