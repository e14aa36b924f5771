#pragma once

#include <nlohmann/json.hpp>

namespace moma {

/// JSON whose keys keep their order: that of the files, of stored texts and of the keys that are made of them.
using Json = nlohmann::ordered_json;

}  // namespace moma
