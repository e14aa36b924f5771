#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace moma::config {

/// JSON that came from outside: from a store, a file, another process, an option. Copying, walking and writing a JSON
/// value recurse, so what is nested too deeply is refused before it becomes one. `source` names it in messages.
/// Throws ConfigError: no JSON, nested more than kMaxNesting levels, more than kMaxTextBytes.
nlohmann::ordered_json parse_json(std::string_view text, const std::string& source);

}  // namespace moma::config
