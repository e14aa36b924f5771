#pragma once

#include <nlohmann/json.hpp>

namespace moma::reports {

/// JSON whose keys keep their order.
using Json = nlohmann::ordered_json;

}  // namespace moma::reports
