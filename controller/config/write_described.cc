#include "controller/config/write_described.h"

#include <algorithm>
#include <span>

namespace moma::config::description {

nlohmann::ordered_json list_to_json(std::span<const double> values, bool one_for_all) {
  if (one_for_all && !values.empty() &&
      std::all_of(values.begin(), values.end(), [&](double v) { return v == values[0]; }))
    return number_to_json(values[0]);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const double value : values) list.push_back(number_to_json(value));
  return list;
}

}  // namespace moma::config::description
