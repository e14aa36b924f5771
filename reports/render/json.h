#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace moma::reports {

/// JSON whose keys keep their order.
using Json = nlohmann::ordered_json;

/// The JSON text, which is valid UTF-8 whatever bytes `json` holds.
inline std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace moma::reports
