#pragma once

#include <string>
#include <string_view>

#include "controller/config/json.h"
#include "controller/config/node.h"

namespace moma::config {

/// A Node tree from JSON, so that resolved input goes through the same strict readers as files. Numbers keep
/// their bits; strings count as quoted except ".inf" and "-.inf". Every mark names `source`, without a line.
Node node_from_json(const Json& json, const std::string& source);

/// The plain value of a Node: numbers, true, false and null where unquoted text spells them, else text.
/// Infinities become the strings ".inf" and "-.inf", which JSON cannot hold as numbers.
Json node_to_json(const Node& node);

/// A number as JSON, infinities as ".inf" and "-.inf": the readers take both.
Json number_to_json(double value);

/// A number as answers for programs have it: infinities as "inf" and "-inf", NaN as null.
Json number_or_word(double value);

/// `json`, made an empty object if it was null: for values that get keys one by one. The library would make one of a
/// null by itself, but names it an object before it has the memory, and crashes when that fails (3.11).
Json& as_object(Json& json);

/// JSON that came from outside: from a store, a file, another process, an option. Copying, walking and writing a JSON
/// value recurse, so what is nested too deeply is refused before it becomes one. `source` names it in messages.
/// Throws ConfigError: no JSON, nested more than kMaxNesting levels, more than kMaxTextBytes.
Json parse_json(std::string_view text, const std::string& source);

}  // namespace moma::config
