#include "controller/describe/accepted.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>
#include <string>

namespace moma {

std::string number_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

std::string accepted_number(const Range& range) {
  const bool low = range.low > -std::numeric_limits<double>::max();
  const bool high = range.high < std::numeric_limits<double>::max();
  std::string text = "a number";
  if (low && high) {
    text += " from " + number_text(range.low) + " to " + number_text(range.high);
    if (range.open_low) text += ", above " + number_text(range.low);
    if (range.open_high) text += ", below " + number_text(range.high);
  } else if (low) {
    text += (range.open_low ? " above " : " of at least ") + number_text(range.low);
  } else if (high) {
    text += (range.open_high ? " below " : " of at most ") + number_text(range.high);
  }
  if (range.high == std::numeric_limits<double>::infinity()) text += ", or .inf";
  return text;
}

std::string accepted_whole_number(long long low, long long high) {
  return "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
}

std::string accepted_numbers(int count, const About& about) {
  std::string list = "a list of " + (count >= 0 ? std::to_string(count) + " numbers" : std::string("numbers"));
  if (count < 0 && about.per != Per::kNothing)
    list += about.per == Per::kJoint ? ", one per joint" : ", one per velocity";
  return about.one_for_all ? accepted_number(about.range) + " or " + list : list;
}

namespace description {

std::string short_text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

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

std::string list_text(std::span<const double> values, bool one_for_all) {
  if (values.empty()) return "";
  if (one_for_all && std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; }))
    return number_text(values[0]);
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + number_text(value);
  return text + "]";
}

}  // namespace description
}  // namespace moma
