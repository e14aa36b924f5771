#include "controller/describe/keys.h"

#include <algorithm>

namespace moma::description {

std::string list_text(std::span<const double> values, bool one_for_all) {
  if (values.empty()) return "";
  if (one_for_all && std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; }))
    return number_text(values[0]);
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + number_text(value);
  return text + "]";
}

}  // namespace moma::description
