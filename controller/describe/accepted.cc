#include "controller/describe/accepted.h"

#include <charconv>
#include <cmath>
#include <limits>

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

}  // namespace moma
